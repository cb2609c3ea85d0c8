// attempt.hpp - a package of a given form, from Gram matrices to files. A target may take several.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "compress/gram_stage.hpp"
#include "compress/memory_plan.hpp"
#include "compress/package_form.hpp"
#include "compress/search_stage.hpp"
#include "device/run.hpp"
#include "face/face_model.hpp"
#include "raster/texel_masks.hpp"

namespace facezip::compress {

/// What every attempt starts from: the capture as it is open, and what pass 1 found.
struct CompressionJob {
  const Capture& capture;
  const CompressOptions& options;
  MapSet& maps;  ///< whose textures are read again
  const FaceModel& model;
  const raster::TexelMasks& masks;
  const GramStage& grams;
  const MemoryPlan& memory;
  const device::Run& run;
};

struct Attempt {
  PackageForm form;
  PermutationRecord permutation;  ///< of the last set of weights
  /// Squared error after each sweep of the refinement, of the last set of weights; empty where nothing was refined.
  std::vector<double> sweep_errors;
  /// Of every map, where its difference textures were fitted: squared error over the covered texels as written, before
  /// frames are rounded, in (1/255)^2.
  std::vector<std::optional<double>> errors;
  int band_rows = 0;
};

/// Writes a package of this form into `directory`, which is empty.
/// Throws InputError, DeviceError, OutputError, Cancelled.
Attempt makePackage(const CompressionJob& job, const PackageForm& form, const std::filesystem::path& directory);

/// Whether --memory holds the bands and windows of this form.
bool fitsMemory(const CompressionJob& job, const PackageForm& form);

}  // namespace facezip::compress
