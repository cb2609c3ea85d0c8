// run.hpp - what every stage of a job runs with.
#pragma once

#include <cstdint>

#include "compress/stage_clock.hpp"
#include "device/device_context.hpp"
#include "facezip/progress.hpp"

namespace facezip::compress {

struct Run {
  device::DeviceContext& context;
  Progress& progress;
  StageClock& clock;
  std::uint64_t memory_bytes = 0;  ///< that the process may keep resident, host and device together
};

}  // namespace facezip::compress
