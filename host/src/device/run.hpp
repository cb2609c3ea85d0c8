// run.hpp - what every stage of a job runs with.
#pragma once

#include <cstdint>

#include "device/device_context.hpp"
#include "facezip/progress.hpp"
#include "io/stage_clock.hpp"

namespace facezip::device {

struct Run {
  DeviceContext& context;
  Progress& progress;
  io::StageClock& clock;
  std::uint64_t memory_bytes = 0;  ///< that the process may keep resident, host and device together
};

}  // namespace facezip::device
