// error_pictures.hpp - small images of captured and decoded textures and of their errors, collected band by band.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bands/tile_band.hpp"
#include "evaluate/error_distribution.hpp"
#include "facezip/evaluate.hpp"

namespace facezip::evaluate {

/// Averages over the texels of each pixel: box filter, in the map's own encoding.
class PictureCollector {
 public:
  /// decoded  for each decoder of the measurement, the column of the picture that it fills, -1 for none
  /// methods  of the columns; "pca4" last, where wanted
  /// side     pixels along the longer side, at most
  PictureCollector(std::string map, const image::ImageShape& shape, int expressions, std::vector<int> decoded,
                   std::vector<std::string> methods, int side);

  /// Bytes that the images of such a map take.
  std::uint64_t bytes() const;

  /// image   0 the neutral, n + 1 expression n
  /// begin   first row of the band; values  of its rows, in units of 1/255
  void addCaptured(int image, int begin, const compress::BandShape& shape, std::span<const float> values);
  void addDecoded(std::size_t decoder, int expression, int begin, const compress::BandShape& shape,
                  std::span<const float> values, std::span<const std::uint32_t> texels, std::span<const float> errors);

  bool wantsPca() const { return !methods_.empty() && methods_.back() == "pca4"; }
  /// PCA's errors in a band, once its components are known. samples  as a MapBand has them
  void addPca(int begin, std::span<const std::byte> samples, const compress::BandShape& shape,
              std::span<const std::uint32_t> texels, const Eigen::MatrixXd& projector);

  /// largest_p99  of the decoded methods of the picture; projector  of PCA, if wanted
  ErrorPictures finish(double largest_p99, const Eigen::MatrixXd& projector) const;

 private:
  /// Sums of one small image: colours (R, G, B) or squared errors, and how many texels they are of.
  struct Sums {
    std::vector<float> values;
    std::vector<float> counts;
  };
  std::size_t pixels() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
  int pixelColumn(int x) const { return static_cast<int>(static_cast<long>(x) * width_ / map_shape_.width); }
  int pixelRow(int y) const { return static_cast<int>(static_cast<long>(y) * height_ / map_shape_.height); }
  std::size_t column(int expression, int method) const;
  void addColours(Sums& sums, int begin, const compress::BandShape& shape, std::span<const float> values) const;
  void addErrors(Sums& sums, int begin, std::span<const std::uint32_t> texels, std::span<const float> errors) const;
  std::vector<float> colours(const Sums& sums) const;
  std::vector<float> pcaColours(int expression, const Eigen::MatrixXd& projector) const;

  std::string map_;
  image::ImageShape map_shape_;
  int expressions_;
  std::vector<int> decoded_;
  std::vector<std::string> methods_;
  int width_ = 0;
  int height_ = 0;
  std::vector<Sums> captured_;  ///< N + 1
  std::vector<Sums> images_;    ///< N x methods
  std::vector<Sums> errors_;    ///< N x methods
  ErrorDistribution pca_errors_;
};

}  // namespace facezip::evaluate
