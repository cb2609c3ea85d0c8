// registration.hpp - raw scans and a template in, a capture out: every expression in one topology and one layout.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "facezip/device.hpp"
#include "facezip/named_value.hpp"
#include "facezip/progress.hpp"
#include "facezip/protected_paths.hpp"

namespace facezip {

/// The steps of a registration, in order.
enum class RegistrationStep {
  kLandmarks,  ///< the template's motion and modes or shapes by landmarks alone
  kModel,      ///< by closest points
  kBending,    ///< non-rigid ICP
  kFlow,       ///< expressions: textures drawn onto the neutral's by optical flow
};
template <>
const std::vector<NamedValue<RegistrationStep>>& namesOf();

struct RegistrationOptions {
  int resolution = 2048;            ///< side of the capture's textures, 64 to 16384
  std::string unit;                 ///< of the scans; empty: guessed from the neutral's size
  std::filesystem::path landmarks;  ///< empty: SCANS/landmarks.json
  /// "albedo", and of the scans' shape, which is finer than the template: "normal" (8-bit RGB in the frame of each
  /// mesh, +x along u, +y along v), "displacement" (16-bit grey, 1/2 + height / 4 mm), as the built-in capture has
  /// them.
  std::vector<std::string> maps = {"albedo"};
  bool keep_colour = false;                              ///< leave what light changed between the scans in the textures
  RegistrationStep last_step = RegistrationStep::kFlow;  ///< earlier ones: to see what each does
};

/// What was found of a scan. Lengths in millimetres.
struct RegisteredScan {
  std::string name;
  int triangles = 0;          ///< of the scan, cleaned
  int spikes = 0;             ///< vertices that stood out of it and were put back
  double roughness = 0.0;     ///< of its surface: the noise that no mesh follows
  int landmarks = 0;          ///< that were used
  double landmark_rms = 0.0;  ///< from the registered mesh
  /// Distances of the scan's points from the mesh: as the model poses it, then as registered.
  double model_mean = 0.0, model_p99 = 0.0;
  double mean = 0.0, p99 = 0.0;
  double matched = 0.0;   ///< share of the scan's surface within reach of the mesh
  double coverage = 0.0;  ///< share of the region's texels that the scan shows
  int flow_rounds = 0;    ///< of optical flow against the neutral's texture
  /// Flow against the neutral's texture before and after these, in texels of RegistrationReport::flow_side: mean, and
  /// what 95 % of the texels do not pass. 0 for the neutral.
  double flow_before_mean = 0.0, flow_before_p95 = 0.0;
  double flow_mean = 0.0, flow_p95 = 0.0;
  double flow_trusted = 0.0;  ///< share of texels whose flow comes back to where it began: others are not believed
  /// Of each channel: by how much the scan was brighter than the neutral's on still skin, which was taken out. Empty
  /// for the neutral and with RegistrationOptions::keep_colour.
  std::vector<double> colour_gain;
  double degrees = 0.0;      ///< how far the head had turned against the neutral's scan, and
  double millimetres = 0.0;  ///< how far that and its shift moved it, on average
};

struct RegistrationReport {
  std::vector<RegisteredScan> scans;  ///< the neutral, then the N expressions
  std::string unit;                   ///< of the capture: the scans'
  bool unit_guessed = false;
  double template_scale = 1.0;  ///< size of the subject's head beside the template's, without identity modes
  int vertices = 0;
  int region_triangles = 0;
  int flow_side = 0;  ///< of the pictures that flow is taken of, in texels; 0 without it
  std::vector<std::pair<std::string, double>> seconds;
};

/// What registerScans() reads: what is written may be none of it.
ProtectedPaths inputsOf(const std::filesystem::path& scans, const std::filesystem::path& template_directory,
                        const RegistrationOptions& options);

/// Registers the scans of a directory to a template and writes them as a capture (docs/registration.md):
/// neutral.obj, expressions/NAME.obj, albedo/NAME.png, confidence/NAME.png, face_region.txt, capture.json. The capture
/// appears whole or not at all; an earlier one that this made is replaced.
/// scans               NAME.obj, NAME.ply or NAME.glb with textures or coloured vertices, "neutral" among them, and
/// landmarks.json template_directory  neutral.obj with UVs, landmarks.json; shapes (NAME.obj) and identity modes where
/// it has any Throws InputError (a file, an option, scans that do not fit the template), DeviceError, OutputError,
/// SolverError, Cancelled.
RegistrationReport registerScans(const std::filesystem::path& scans, const std::filesystem::path& template_directory,
                                 const std::filesystem::path& capture, const RegistrationOptions& options,
                                 const Device& device, Progress& progress);

}  // namespace facezip
