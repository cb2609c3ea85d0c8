// learn.hpp - one neutral scan in, a whole moving face out: a model learned from a library of captured people, and
// faces generated with it (Li et al. 2020, "Dynamic Facial Asset and Rig Generation from a Single Scan").
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/compress.hpp"
#include "facezip/device.hpp"
#include "facezip/named_value.hpp"
#include "facezip/progress.hpp"
#include "facezip/protected_paths.hpp"
#include "facezip/rig.hpp"

namespace facezip {

/// How a model predicts.
enum class LearningMethod {
  kLinear,  ///< closed form: regressions from the neutral's principal components, its textures and the skin's strain
};

template <>
const std::vector<NamedValue<LearningMethod>>& namesOf();

struct TrainOptions {
  LearningMethod method = LearningMethod::kLinear;
  int resolution = 256;           ///< side of the textures that are learned from, 16 to 1024; larger ones are averaged
  int rounds = 2;                 ///< of performed weights and regression by turns, 1 to 100
  std::vector<std::string> maps;  ///< to learn; empty: those that every subject has
};

/// How well the textures of a map are predicted, of the subjects that were learned from, in per cent of the mean of the
/// map's neutral. The noise of the scans is in both.
struct LearnedTexture {
  std::string map;
  double error = 0.0;    ///< root mean square of the difference of an expression's texture to the neutral's
  double nothing = 0.0;  ///< the same of predicting no change
};

struct TrainReport {
  std::size_t subjects = 0;
  std::vector<std::string> expressions;  ///< N
  std::vector<std::string> shapes;       ///< M
  int skin_vertices = 0;
  int components = 0;        ///< of the neutrals, that shapes are regressed from
  double softness = 0.0;     ///< a component of variance v counts v / (v + softness times the largest)
  double shared = 0.0;       ///< share of a shape's own form that the neutral tells
  double noise = 0.0;        ///< of an expression, as a share of its displacement
  double left_out_mm = 0.0;  ///< expressions of subjects left out, predicted from the others ...
  double template_mm = 0.0;  ///< ... and by the template: root mean square over vertices that move
  std::vector<LearnedTexture> textures;
  std::uint64_t model_bytes = 0;
  std::vector<std::pair<std::string, double>> seconds;
};

/// Learns from a library and writes `model`, whole or not at all (docs/model_format.md). The same library and options
/// give the same bytes.
/// library             a directory of captures, or one with a folder `subjects` of them: at least two people, all with
///                     the same expressions and in one topology and layout
/// template_directory  as rigCapture() takes it, of the library's topology
/// facs                which shapes each expression was asked to be, from 0 to 1: JSON or CSV as RigOptions::guess
/// Throws InputError, OutputError, SolverError, Cancelled.
TrainReport trainModel(const std::filesystem::path& library, const std::filesystem::path& template_directory,
                       const std::filesystem::path& facs, const std::filesystem::path& model,
                       const TrainOptions& options, Progress& progress);

/// What trainModel() reads.
ProtectedPaths trainInputs(const std::filesystem::path& library, const std::filesystem::path& template_directory,
                           const std::filesystem::path& facs);

struct GenerateOptions {
  CompressOptions compress;
  std::string eyes;  ///< as RigOptions::eyes
};

struct GenerateReport {
  RigReport rig;  ///< of the shapes and the package; no expressions
  /// How far the neutral's components lie from the subjects that were learned from: root mean square, 1 is usual.
  double strangeness = 0.0;
  std::vector<std::string> maps;        ///< whose textures were generated
  std::vector<std::string> left_alone;  ///< maps of the neutral that the model knows nothing of: they do not change
};

/// Makes a package of a neutral alone: the model's shapes on the subject, personalised, each with its own textures. It
/// is a rig's package (rigCapture()), which appears whole or not at all.
/// neutral  a capture in the model's topology and layout; its expressions, if it has any, are not looked at
/// model    a file that trainModel() wrote
/// Throws InputError: another topology or layout than the model's, a file that is no model or a damaged one, an option;
/// and as compressCapture() does.
GenerateReport generateFace(const Capture& neutral, const std::filesystem::path& model,
                            const std::filesystem::path& package, const GenerateOptions& options, const Device& device,
                            Progress& progress);

/// What generateFace() reads.
ProtectedPaths generateInputs(const Capture& neutral, const std::filesystem::path& model,
                              const GenerateOptions& options);

}  // namespace facezip
