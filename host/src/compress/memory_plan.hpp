// memory_plan.hpp - how many rows passes and windows may have, so that a job stays within --memory.
#pragma once

#include <cstdint>
#include <span>

#include "bands/map_set.hpp"
#include "compress/package_form.hpp"
#include "device/run.hpp"
#include "search/gram_matrices.hpp"

namespace facezip::compress {

/// What the plan of a job depends on. References outlive it.
class MemoryPlan {
 public:
  /// weight_sets  of the package
  MemoryPlan(const MapSet& maps, const GramSlots& slots, int weight_sets, const device::Run& run)
      : maps_(maps), slots_(slots), weight_sets_(static_cast<std::uint64_t>(weight_sets)), run_(run) {}

  /// Rows of a band that all maps can have. Throws InputError where --memory is too little for the smallest band,
  /// DeviceError where the device is.
  int bandRows(const PackageForm& form) const;

  /// The same of the windows of the refinement, in rows of cells.
  /// group  maps that share weights, on the form's grid
  int windowRows(const PackageForm& form, std::span<const GridMap> group) const;

 private:
  std::uint64_t residentBytes(const PackageForm& form) const;

  const MapSet& maps_;
  const GramSlots& slots_;
  std::uint64_t weight_sets_;
  const device::Run& run_;
};

}  // namespace facezip::compress
