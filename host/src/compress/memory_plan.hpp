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
  /// gram_sets  sets of Gram matrices that are kept: one, or one for every map
  MemoryPlan(const MapSet& maps, const GramSlots& slots, std::size_t gram_sets, const device::Run& run)
      : maps_(maps), slots_(slots), gram_sets_(gram_sets), run_(run) {}

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
  std::uint64_t gram_sets_;
  const device::Run& run_;
};

}  // namespace facezip::compress
