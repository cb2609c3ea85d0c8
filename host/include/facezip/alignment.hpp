// alignment.hpp - a registered capture whose textures still slide, in; one whose textures lie on each other, out.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/device.hpp"
#include "facezip/progress.hpp"
#include "facezip/protected_paths.hpp"

namespace facezip {

struct AlignmentOptions {
  std::string map;           ///< whose textures are compared; empty: albedo, else the first
  std::string region;        ///< as CompressOptions::region: empty, "whole" or a file
  bool keep_meshes = false;  ///< for meshes that are right where the textures are not: they stay as they are
};

/// What was found of an expression. Flow is against the neutral's texture, in texels of AlignmentReport::flow_width.
struct AlignedExpression {
  std::string name;
  bool moved = false;  ///< false: its files are the capture's own
  int rounds = 0;
  double before_mean = 0.0, before_p95 = 0.0;
  double after_mean = 0.0, after_p95 = 0.0;
  double trusted = 0.0;  ///< share of the region's texels whose flow is believed; the others follow those around them
  double largest = 0.0;  ///< texels that a texel moved
};

struct AlignmentReport {
  std::string map;
  int flow_width = 0;  ///< of the pictures that flow is taken of
  std::vector<AlignedExpression> expressions;
  std::vector<std::pair<std::string, double>> seconds;
};

/// What alignCapture() reads: what is written may be none of it.
ProtectedPaths inputsOf(const Capture& capture, const AlignmentOptions& options);

/// Aligns the textures of every expression with the neutral's by optical flow in the layout, resamples all maps by the
/// same flow on the device, once, and moves the meshes so that every vertex keeps its texel. Expressions that flow by
/// less than half a texel, or that would not come nearer to the neutral, stay as they are. The capture appears whole
/// or not at all; an earlier one that this made is replaced.
/// capture  opened with all maps that the new one is to have
/// Throws InputError (a file, an option), DeviceError, OutputError, Cancelled, Error.
AlignmentReport alignCapture(const Capture& capture, const std::filesystem::path& output,
                             const AlignmentOptions& options, const Device& device, Progress& progress);

}  // namespace facezip
