// rig.hpp - a capture and a template in, an animatable face out: personalised blendshapes with their textures
// (FaceZip, section 3.2; Li, Weise and Pauly 2010), and weights for it from tracked meshes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/compress.hpp"
#include "facezip/device.hpp"
#include "facezip/geometry/example_rig.hpp"
#include "facezip/named_value.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// How the weight maps of the rig's shapes follow from those of the captured expressions: W*_m = sum_n P_mn W_n, or
/// from the shapes alone.
enum class TextureSolve {
  kLocal,          ///< per weight cell, a change of the skin belongs to shapes that strain it there
  kDamped,         ///< P = B^T (B B^T + lambda I)^-1, everywhere alike
  kPseudoInverse,  ///< P = B^+ (FaceZip, Eq. 11), everywhere alike; amplifies noise
  /// A shape's own strain says how much it shows of the compress and of the stretch maps (Li et al. 2020, Eq. 10 to
  /// 14), normalised over the shapes. For Method::kCompressStretch, and for that alone.
  kStrain,
};

template <>
const std::vector<NamedValue<TextureSolve>>& namesOf();

struct RigOptions {
  geometry::ExampleRigOptions fit;
  std::filesystem::path guess;  ///< weights that the expressions are thought to have (.csv or .json); empty: none
  /// None: textureSolveOf().
  std::optional<TextureSolve> texture_solve;
  /// lambda of kLocal and kDamped, > 0; none: 0.3 for kDamped, and for kLocal what predicts each captured expression
  /// best from the others.
  std::optional<double> texture_damping;
  /// Irises of a template's eyes: one of irisNames(), or the nearest of them to #rrggbb; empty: the template's texture,
  /// or brown where it has none.
  std::string eyes;
  CompressOptions compress;
};

/// Eyes that facezip paints, from dark to light.
std::vector<std::string> irisNames();

/// What is asked for, or else what belongs to the method: kPseudoInverse to the paper's (FaceZip, section 3.2), kStrain
/// to compress and stretch maps, kLocal to the others. Throws InputError where only one of method and solve is of
/// compress and stretch maps.
TextureSolve textureSolveOf(const RigOptions& options);

/// Distances of a posed mesh from the captured one, in millimetres.
struct RigResidual {
  double mean = 0.0;
  double percentile_99 = 0.0;
  double largest = 0.0;
};

/// The rigid motion of the head that was taken out of an expression.
struct RigHeadMotion {
  double degrees = 0.0;      ///< how far it turned
  double millimetres = 0.0;  ///< how far that and its shift took the neutral's vertices, on average
};

struct RigReport {
  std::vector<std::string> expressions;  ///< N, as the capture names them; none of a neutral alone
  /// N: as the package names them: `NAME_captured` where a shape has the name already.
  std::vector<std::string> package_expressions;
  std::vector<std::string> shapes;              ///< M
  std::vector<std::vector<double>> weights;     ///< N x M, in [0, 1]
  std::vector<RigResidual> residuals;           ///< N: re-posed by the rig
  std::vector<RigResidual> template_residuals;  ///< N: by the template's shapes on the subject, weights fitted freely
  std::vector<RigHeadMotion> head_motions;      ///< N; empty unless they were taken out
  std::vector<double> convergence;  ///< rms over all expressions in mm, at the start and after each iteration
  std::string transfer;             ///< "deformation gradients" or "displacements"
  double shape_prior = 0.0;         ///< closeness of the shapes to the template's (geometry::ExampleRig)
  double left_out_share = 0.0;  ///< error of expressions' gradients predicted from the others, of the template's error
  std::vector<std::string> unseen;  ///< shapes that no expression uses: the template's, on the subject
  std::vector<std::string> still;   ///< shapes that move nothing
  int vertices = 0;                 ///< of the rig, parts beyond the skin included
  int skin_vertices = 0;
  int parts = 0;  ///< pieces beyond the skin, placed for themselves
  int degenerate_triangles = 0;
  std::string texture_solve;      ///< by name
  double texture_damping = 0.0;   ///< lambda
  double strain_share = 0.0;      ///< of the strain beside the names of shapes, kLocal
  double left_out_rmse = 0.0;     ///< kLocal: each captured expression predicted from the others, sampled cells, 1/255
  double left_out_nothing = 0.0;  ///< the same cells' rms difference to the neutral: what predicting nothing errs by
  int texture_rank = 0;           ///< of B, at a relative tolerance of 1e-6
  std::vector<std::pair<std::string, double>> seconds;
  CompressReport compress;
};

/// Compresses `capture` as compressCapture() does, fits a rig of the template's shapes to its expressions, and writes
/// both as one package: package.json and textures that blend by the captured names and by the shapes', shapes/NAME.obj,
/// rig.json, rig.gltf (docs/rig.md). Of a neutral alone (NeutralAlone) it is the template's shapes on the subject, with
/// the template's textures where it has any. The package appears whole or not at all.
/// template_directory  neutral.obj (or generic_neutral.obj) and one OBJ for each shape, of the capture's topology; its
///                     mesh may go on with vertices and triangles of parts beyond the captured skin
/// Throws InputError (the capture, the template, the guess, an option), DeviceError, OutputError, SolverError,
/// Cancelled.
RigReport rigCapture(const Capture& capture, const std::filesystem::path& template_directory,
                     const std::filesystem::path& package, const RigOptions& options, const Device& device,
                     Progress& progress);

/// What rigCapture() reads.
ProtectedPaths inputsOf(const Capture& capture, const std::filesystem::path& template_directory,
                        const RigOptions& options);

/// A rig as a package holds it.
struct Rig {
  std::filesystem::path directory;
  std::vector<std::string> shapes;               ///< M
  std::vector<std::string> expressions;          ///< N, as the capture names them
  std::vector<std::string> package_expressions;  ///< N, as the package does
  std::vector<std::vector<double>> weights;      ///< N x M
  int skin_vertices = 0;
  double millimetres_per_unit = 1.0;
};

/// True if the package is a rig's.
bool isRig(const Package& package);
/// Reads rig.json. Throws InputError naming the field that is wrong.
Rig openRig(const Package& package);
Rig openRig(const std::filesystem::path& package);

struct SolveWeightsOptions {
  double smoothing = 0.0;    ///< pull between the weights of neighbouring frames, of the mean squared length of a shape
  bool head_motion = false;  ///< find the rigid motion of the head in each frame and take it out
};

struct SolvedClip {
  std::vector<std::string> shapes;           ///< M
  std::vector<std::vector<double>> weights;  ///< frames x M, in [0, 1]
  std::vector<RigResidual> residuals;        ///< of each frame
  bool numbered = true;                      ///< a column "frame" counts frames; not where the package has that name
  double seconds = 0.0;                      ///< of the solve, reading meshes included
};

/// Weights that pose the rig of `package` like each of `meshes`: bounded least squares over the vertices of the skin.
/// meshes  OBJ files of the capture's topology, a frame each, in order
/// Throws InputError: no rig, a mesh of another topology, an option out of range.
SolvedClip solveWeights(const std::filesystem::path& package, const std::vector<std::filesystem::path>& meshes,
                        const SolveWeightsOptions& options, Progress& progress);

/// Writes a clip as `blend --animation` reads it: a header of names, a row of weights for each frame, numbered or not.
/// progress  may be null
void writeClip(const std::filesystem::path& file, const SolvedClip& clip, Progress* progress = nullptr);

}  // namespace facezip
