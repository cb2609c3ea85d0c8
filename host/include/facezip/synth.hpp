// synth.hpp - the built-in capture: a procedural head whose textures follow its deformation.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "facezip/progress.hpp"

namespace facezip {

/// What synthesizeCapture() makes. The same options give the same bytes, on any number of threads.
struct SynthOptions {
  int resolution = 1024;  ///< side of every texture in texels, 64..16384
  int expressions = 20;   ///< N, 1..100; the first n expressions are the same for every N >= n
  /// Which maps to paint, each at most once:
  ///   "albedo"        8-bit RGB, sRGB
  ///   "normal"        8-bit RGB, linear: n/2 + 1/2 in the tangent frame of each mesh, +x along u, +y along v (up)
  ///   "specular"      8-bit grey, linear intensity
  ///   "roughness"     8-bit grey, linear
  ///   "displacement"  16-bit grey, linear: 1/2 + height / (4 mm), fine detail only
  std::vector<std::string> maps = {"albedo", "normal"};
  /// Chooses skin, proportions, crease pattern and how strongly each expression is performed.
  std::uint64_t seed = 1;
  /// Also write OUTPUT/template: another head (neutral.obj) performing every single action (NAME.obj), what `rig`
  /// takes, and OUTPUT/weights.json: how strongly each expression performs them. Expression 21 and those after it are
  /// the subject's own single actions, under the same names.
  bool rig_template = false;
};

/// Writes a capture directory: neutral.obj, expressions/NAME.obj, MAP/neutral.png, MAP/NAME.png and capture.json.
/// One chart of 20,000 triangles in metres (y up, z out of the face, x to the subject's left) with an open outline and
/// holes for eyes and mouth. Wrinkles, blood flow and occlusion come from each mesh's deformation; every expression is
/// "scanned" with about 0.4 texel of smooth misalignment, up to 1 % of gain drift and white noise of 0.8/255.
/// A pattern is a function of the skin in metres: another resolution of the same seed shows the same face.
/// Textures are written in bands of rows; memory grows with the width of the image, not with its area.
/// output    appears whole or not at all; an earlier capture there is replaced, anything else is not
/// progress  told of each band; cancel() stops between bands and leaves nothing
/// Throws InputError for bad options, OutputError if `output` cannot be written, Cancelled.
void synthesizeCapture(const std::filesystem::path& output, const SynthOptions& options, Progress& progress);

}  // namespace facezip
