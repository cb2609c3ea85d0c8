// evaluate.hpp - how far a package is from the capture it was made of, beside baselines of the same kind.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "facezip/block_format.hpp"
#include "facezip/capture.hpp"
#include "facezip/device.hpp"
#include "facezip/method.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// What a package is measured beside, other than packages by other methods.
enum class Baseline {
  kPca4,           ///< PCA with 4 components, the neutral as mean
  kPca8,           ///< with 8
  kLimit,          ///< the best C components of every block of weight_scale x weight_scale texels
  kWeightsPerMap,  ///< the package's own method with weights of their own for every map: what it costs to share them
};
template <>
const std::vector<NamedValue<Baseline>>& namesOf();

/// Small images of every expression and of its errors.
struct PictureOptions {
  std::string map = "";       ///< of this map; "": the first of the package
  bool all_maps = false;      ///< of every map, where none is named
  bool paper_and_pca = true;  ///< also by the paper's method and PCA(4), where these are measured
  int side = 256;             ///< pixels along the longer side; fewer where memory would not do
};

/// What to measure beside the package. A method of compression costs one compression more, with the package's own
/// settings, in the directory for temporary files; the method that the package was made with costs nothing.
/// kWeightsPerMap costs one where the maps of the package share weights.
struct EvaluateOptions {
  std::set<Method> methods = {Method::kNoPermutation, Method::kPaper};
  std::set<Baseline> baselines = {Baseline::kPca4, Baseline::kPca8, Baseline::kLimit};
  /// Block formats in which every captured texture is coded for itself: what a studio does without facezip.
  std::set<BlockFormat> every_texture = {};
  /// Also every method at C = 1, 2, 3, 4: up to 16 compressions more, one after the other.
  bool ablation = false;
  /// Numbers of masks to compress with, by the package's method and by the paper's: two compressions each.
  std::vector<int> mask_sweep = {};
  /// Of a rig's package: the capture's expressions are single shapes of the rig, by name, not what it was fitted to.
  bool shapes = false;
  int blends = 16;                                        ///< R, random weight vectors to blend; 0: none
  std::optional<PictureOptions> pictures = std::nullopt;  ///< collected where given: Evaluation::pictures
  std::uint64_t memory_bytes = 2ull << 30;
};

/// Root mean square errors of one method on one map, over the covered texels and all channels, in 1/255 of full scale.
struct MapErrors {
  double pooled = 0.0;                 ///< over all expressions
  std::vector<double> per_expression;  ///< N; empty for "limit", which is known of all together
};

/// Errors of texels, in 1/255 of full scale. The error of a texel is the root mean square over its channels.
struct TexelErrors {
  double rmse = 0.0;
  double psnr = 0.0;  ///< 20 log10(255 / rmse) dB; infinite when rmse is 0
  double p99 = 0.0;   ///< 99 of 100 texels have no larger error; rounded up to 1/64
  double max = 0.0;
  std::array<std::uint64_t, 3> beyond = {};  ///< texels that are off by kNoticed levels or more
  static constexpr std::array<int, 3> kNoticed = {8, 16, 32};
};

/// Angles between captured and decoded normals, degrees in [0, 180].
struct NormalAngles {
  double mean = 0.0;
  double p99 = 0.0;  ///< rounded up to 1/64
  double max = 0.0;
};

/// Of all expressions together and of each.
template <typename Value>
struct PooledAndEach {
  Value pooled;
  std::vector<Value> per_expression;  ///< N
};

/// Blends of several expressions at once: Eq. 8 against I_0 + sum_n beta_n Delta_n of the captured textures.
struct BlendErrors {
  double rmse = 0.0;  ///< over all weight vectors
  /// The largest rmse(beta) / sum_n |beta_n| rmse_n. Decoding is linear, so the triangle inequality keeps it below 1.
  double largest_share_of_bound = 0.0;
};

/// Small images of one map of every expression, for a picture.
struct ErrorPictures {
  std::string map;
  int width = 0;  ///< pixels, at most PictureOptions::side
  int height = 0;
  std::vector<std::string> methods;  ///< "package", then of "paper" and "pca4" what was asked for
  double scale = 0.0;                ///< the largest p99 of the methods, in 1/255: where an error scale should end
  /// [N][1 + methods] images as captured and as decoded: height x width x 3 values in [0, 1], row 0 = v 1
  std::vector<std::vector<std::vector<float>>> images;
  /// [N][methods] errors in 1/255, root mean square over the texels of a pixel: height x width; negative: none covered
  std::vector<std::vector<std::vector<float>>> errors;
};

/// The search for the permutation, as the paper's method with the package's settings ran it.
struct PermutationSearch {
  double cost = 0.0;                             ///< that was taken (Eq. 3), (1/255)^2
  std::optional<double> bound;                   ///< no permutation costs less
  std::vector<std::vector<double>> convergence;  ///< cost after each sweep, per restart
};

/// What compressing with another number of masks gives.
struct MaskSweepPoint {
  int masks = 0;
  std::map<std::string, std::vector<double>> rmse;  ///< by method, one for each map, pooled over expressions
};

/// Keys "by method": "package" (as decoded from disk), the names of methods and baselines (a package's own method is an
/// entry too, equal to "package", as is "weights-per-map" where its maps do not share weights);
/// "every-bc7" and the like: every texture in blocks of that format. Of a rig's package also
/// "rig": each expression as the rig's shapes blend it with the weights that it was found to have.
struct Evaluation {
  struct Map {
    std::string name;
    double rms_difference = 0.0;            ///< of the expressions to the neutral, pooled: the error of storing nothing
    std::map<std::string, MapErrors> rmse;  ///< by method
    std::map<std::string, PooledAndEach<TexelErrors>> detail;   ///< by method that is decoded: package and packages
    std::map<std::string, PooledAndEach<NormalAngles>> angles;  ///< of normal maps, by method that is decoded
    std::map<std::string, BlendErrors> blends;                  ///< by method that is decoded
    /// RMSE by method ("pca" for PCA) and C; 8 for "pca" only. Empty without EvaluateOptions::ablation.
    std::map<std::string, std::map<int, double>> ablation;
  };
  std::string method;   ///< of the package, by name
  int differences = 0;  ///< C of the package
  std::vector<std::string> expressions;
  std::uint64_t covered_texels = 0;  ///< of the first map
  std::vector<Map> maps;
  /// Run-time memory by method, decoded textures and weights as the paper's Table 1 counts them: "package", "pca4",
  /// "pca8", "raw" (every texture), "neutral", and "package_disk" for the files.
  std::map<std::string, std::uint64_t> bytes;
  /// The same by method and C, as in Map::ablation. "limit" counts what a package of that C takes.
  std::map<std::string, std::map<int, std::uint64_t>> ablation_bytes;
  /// R weight vectors that were blended, N values each, in the package's order.
  std::vector<std::vector<float>> blend_weights;
  std::vector<ErrorPictures> pictures;                  ///< one for each map that was asked for
  std::optional<PermutationSearch> search;              ///< where a baseline that permutes was compressed
  std::vector<MaskSweepPoint> mask_sweep;               ///< as asked for
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each stage
};

/// Evaluates `package`, decoded from disk by the run time's own code, against `capture`. Errors are of the decoded
/// values before they are rounded to the type of the neutral, as a shader has them; textures stream in bands of rows.
/// Throws InputError if the package is not of this capture (maps, sizes, expressions) or has no map of the pictures'
/// name.
Evaluation evaluatePackage(const Capture& capture, const Package& package, const EvaluateOptions& options,
                           const Device& device, Progress& progress);

/// What tables call the keys of an evaluation, in the order that they show them.
const std::vector<std::pair<std::string, std::string>>& evaluationTitles();

/// The title of a key; the key itself where there is none.
std::string evaluationTitle(const std::string& key);

}  // namespace facezip
