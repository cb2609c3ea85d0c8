#include "evaluate/error_pictures.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "evaluate/pca.hpp"

namespace facezip::evaluate {
namespace {

constexpr int kSmallestSide = 64;
/// The images of all expressions and methods stay in memory until the picture is drawn.
constexpr std::uint64_t kMostBytes = std::uint64_t{224} << 20;
constexpr std::size_t kColours = 3;

std::uint64_t pictureBytes(int width, int height, int expressions, std::size_t methods) {
  const std::uint64_t images = static_cast<std::uint64_t>(expressions + 1) * (1 + methods);
  const std::uint64_t errors = static_cast<std::uint64_t>(expressions) * methods;
  return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) * sizeof(float) *
         (images * (kColours + 1) + errors * 2);
}

}  // namespace

PictureCollector::PictureCollector(std::string map, const image::ImageShape& shape, int expressions,
                                   std::vector<int> decoded, std::vector<std::string> methods, int side)
    : map_(std::move(map)),
      map_shape_(shape),
      expressions_(expressions),
      decoded_(std::move(decoded)),
      methods_(std::move(methods)) {
  const int longest = std::max(shape.width, shape.height);
  for (side = std::min(side, longest);; side /= 2) {
    width_ = std::max(1, static_cast<int>(static_cast<long>(shape.width) * side / longest));
    height_ = std::max(1, static_cast<int>(static_cast<long>(shape.height) * side / longest));
    if (bytes() <= kMostBytes || side <= kSmallestSide) break;
  }
  const Sums empty_image{std::vector<float>(pixels() * kColours), std::vector<float>(pixels())};
  const Sums empty_errors{std::vector<float>(pixels()), std::vector<float>(pixels())};
  const std::size_t columns = static_cast<std::size_t>(expressions_) * methods_.size();
  captured_.assign(static_cast<std::size_t>(expressions_ + 1), empty_image);
  images_.assign(columns, empty_image);
  errors_.assign(columns, empty_errors);
}

std::uint64_t PictureCollector::bytes() const { return pictureBytes(width_, height_, expressions_, methods_.size()); }

std::size_t PictureCollector::column(int expression, int method) const {
  return static_cast<std::size_t>(expression) * methods_.size() + static_cast<std::size_t>(method);
}

void PictureCollector::addColours(Sums& sums, int begin, const compress::BandShape& shape,
                                  std::span<const float> values) const {
  const int first = pixelRow(begin);
  const int last = pixelRow(begin + shape.rows - 1);
  const auto channels = static_cast<std::size_t>(shape.channels);
  // One thread to a row of pixels: no two add to the same, and the order of a sum is that of its texels.
  tbb::parallel_for(first, last + 1, [&](int pixel_row) {
    for (int y = 0; y < shape.rows; ++y) {
      if (pixelRow(begin + y) != pixel_row) continue;
      const float* texel =
          values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(shape.width) * channels;
      for (int x = 0; x < shape.width; ++x, texel += channels) {
        const std::size_t pixel = static_cast<std::size_t>(pixel_row) * static_cast<std::size_t>(width_) +
                                  static_cast<std::size_t>(pixelColumn(x));
        for (std::size_t c = 0; c < kColours; ++c) sums.values[pixel * kColours + c] += texel[channels >= 3 ? c : 0];
        sums.counts[pixel] += 1.0f;
      }
    }
  });
}

void PictureCollector::addErrors(Sums& sums, int begin, std::span<const std::uint32_t> texels,
                                 std::span<const float> errors) const {
  const auto width = static_cast<std::uint32_t>(map_shape_.width);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const std::size_t pixel = static_cast<std::size_t>(pixelRow(begin + static_cast<int>(texels[i] / width))) *
                                  static_cast<std::size_t>(width_) +
                              static_cast<std::size_t>(pixelColumn(static_cast<int>(texels[i] % width)));
    sums.values[pixel] += errors[i] * errors[i];
    sums.counts[pixel] += 1.0f;
  }
}

void PictureCollector::addCaptured(int image, int begin, const compress::BandShape& shape,
                                   std::span<const float> values) {
  addColours(captured_[static_cast<std::size_t>(image)], begin, shape, values);
}

void PictureCollector::addDecoded(std::size_t decoder, int expression, int begin, const compress::BandShape& shape,
                                  std::span<const float> values, std::span<const std::uint32_t> texels,
                                  std::span<const float> errors) {
  if (decoded_[decoder] < 0) return;
  const std::size_t at = column(expression, decoded_[decoder]);
  addColours(images_[at], begin, shape, values);
  addErrors(errors_[at], begin, texels, errors);
}

void PictureCollector::addPca(int begin, std::span<const std::byte> samples, const compress::BandShape& shape,
                              std::span<const std::uint32_t> texels, const Eigen::MatrixXd& projector) {
  constexpr std::size_t kTexels = 16384;  // errors of so many are small beside a band
  const int method = static_cast<int>(methods_.size()) - 1;
  for (std::size_t first = 0; first < texels.size(); first += kTexels) {
    const auto part = texels.subspan(first, std::min(kTexels, texels.size() - first));
    const Eigen::MatrixXf errors = pcaTexelErrors(samples, shape, part, projector);
    pca_errors_.add(std::span(errors.data(), static_cast<std::size_t>(errors.size())));
    tbb::parallel_for(0, expressions_, [&](int n) {
      addErrors(errors_[column(n, method)], begin, part, std::span(errors.col(n).data(), part.size()));
    });
  }
}

std::vector<float> PictureCollector::colours(const Sums& sums) const {
  std::vector<float> image(sums.values.size());
  for (std::size_t i = 0; i < image.size(); ++i) {
    image[i] = std::clamp(sums.values[i] / (255.0f * std::max(1.0f, sums.counts[i / kColours])), 0.0f, 1.0f);
  }
  return image;
}

// Averages and projections are both linear: the average of PCA's texels is PCA's projection of the averages.
std::vector<float> PictureCollector::pcaColours(int expression, const Eigen::MatrixXd& projector) const {
  Sums sums = captured_[0];
  for (int n = 0; n < expressions_; ++n) {
    const auto weight = static_cast<float>(projector(n, expression));
    const Sums& captured = captured_[static_cast<std::size_t>(n + 1)];
    for (std::size_t i = 0; i < sums.values.size(); ++i) {
      sums.values[i] += weight * (captured.values[i] - captured_[0].values[i]);
    }
  }
  return colours(sums);
}

ErrorPictures PictureCollector::finish(double largest_p99, const Eigen::MatrixXd& projector) const {
  ErrorPictures pictures;
  pictures.map = map_;
  pictures.width = width_;
  pictures.height = height_;
  pictures.methods = methods_;
  pictures.scale = std::max(largest_p99, pca_errors_.quantile(0.99));
  for (int n = 0; n < expressions_; ++n) {
    std::vector<std::vector<float>> images = {colours(captured_[static_cast<std::size_t>(n + 1)])};
    std::vector<std::vector<float>> errors;
    for (int m = 0; m < static_cast<int>(methods_.size()); ++m) {
      const bool pca = methods_[static_cast<std::size_t>(m)] == "pca4";
      images.push_back(pca ? pcaColours(n, projector) : colours(images_[column(n, m)]));
      const Sums& sums = errors_[column(n, m)];
      std::vector<float> error(pixels());
      for (std::size_t i = 0; i < error.size(); ++i) {
        error[i] = sums.counts[i] > 0.0f ? std::sqrt(sums.values[i] / sums.counts[i]) : -1.0f;
      }
      errors.push_back(std::move(error));
    }
    pictures.images.push_back(std::move(images));
    pictures.errors.push_back(std::move(errors));
  }
  return pictures;
}

}  // namespace facezip::evaluate
