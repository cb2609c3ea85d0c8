// evaluate.hpp - how far a package is from the capture it was made of, beside baselines of the same kind.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/device.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

struct EvaluateOptions {
  bool pca4 = true;            ///< PCA with 4 components, the neutral as mean
  bool pca8 = true;            ///< with 8
  bool no_permutation = true;  ///< the package's own settings, clusters not permuted; compresses the capture once more
  std::uint64_t memory_bytes = 2ull << 30;
};

/// Root mean square errors of one method on one map, over the covered texels and all channels, in 1/255 of full scale.
struct MapErrors {
  double pooled = 0.0;                 ///< over all expressions
  std::vector<double> per_expression;  ///< N
};

struct Evaluation {
  struct Map {
    std::string name;
    double rms_difference = 0.0;            ///< of the expressions to the neutral, pooled: the error of storing nothing
    std::map<std::string, MapErrors> rmse;  ///< by method: "package", "pca4", "pca8", "no_permutation"
  };
  std::vector<std::string> expressions;
  std::uint64_t covered_texels = 0;  ///< of the first map
  std::vector<Map> maps;
  /// Run-time memory by method, decoded textures and weights as the paper's Table 1 counts them: "package", "pca4",
  /// "pca8", "raw" (every texture), "neutral", and "package_disk" for the files.
  std::map<std::string, std::uint64_t> bytes;
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each stage
};

/// Evaluates `package`, decoded from disk by the run time's own code, against `capture`.
/// Throws InputError if the package is not of this capture (maps, sizes, expressions).
Evaluation evaluatePackage(const Capture& capture, const Package& package, const EvaluateOptions& options,
                           const Device& device, Progress& progress);

}  // namespace facezip
