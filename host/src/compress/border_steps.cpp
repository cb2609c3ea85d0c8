#include "compress/border_steps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "bands/band_differences.hpp"

namespace facezip::compress {
namespace {

constexpr int kWidth = 3;          // texels of the border that are looked at
constexpr int kStretch = 32;       // stretches are what squares of this side hold of it
constexpr int kFewestTexels = 24;  // of a stretch: fewer would show noise

}  // namespace

BorderSteps::BorderSteps(const MapSet& maps, const geometry::TriangleMesh& mesh, std::span<const int> region) {
  for (const OpenMap& map : maps.maps) {
    const image::ImageShape& shape = map.samples->shape();
    Border border;
    border.width = shape.width;
    std::map<std::pair<int, int>, int> stretches;
    const raster::UvRaster raster(mesh, region, shape.width, shape.height, 0, kWidth);
    constexpr int kRowsAtOnce = 64;
    for (int begin = 0; begin < shape.height; begin += kRowsAtOnce) {
      const auto samples = raster.rows(begin, std::min(begin + kRowsAtOnce, shape.height));
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (samples[i].kind != raster::TexelSample::Kind::kFeather) continue;
        const auto at = static_cast<std::uint32_t>(toSize(begin, shape.width) + i);
        const int x = static_cast<int>(at) % shape.width, y = static_cast<int>(at) / shape.width;
        const int next = static_cast<int>(stretches.size());
        const int stretch = stretches.emplace(std::pair{y / kStretch, x / kStretch}, next).first->second;
        border.texels.push_back(at);
        border.stretch.push_back(stretch);
        border.counts.resize(stretches.size(), 0);
        ++border.counts[static_cast<std::size_t>(stretch)];
      }
    }
    border.sums = Eigen::MatrixXd::Zero(std::ssize(border.counts), toSize(map.samples->expressions(), shape.channels));
    borders_.push_back(std::move(border));
  }
}

void BorderSteps::addBand(std::size_t m, const MapBand& band) {
  Border& border = borders_[m];
  const auto offset = static_cast<std::uint32_t>(toSize(band.begin, border.width));
  const auto end = static_cast<std::uint32_t>(toSize(band.end, border.width));
  std::vector<std::uint32_t> texels;
  const std::size_t first = border.next;
  for (; border.next < border.texels.size() && border.texels[border.next] < end; ++border.next) {
    texels.push_back(border.texels[border.next] - offset);
  }
  if (texels.empty()) return;
  const Eigen::MatrixXf differences = gatherDifferences(band.samples, band.shape, texels);
  const int channels = band.shape.channels;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    auto sums = border.sums.row(border.stretch[first + i]);
    for (Eigen::Index n = 0; n < differences.cols(); ++n) {
      for (int c = 0; c < channels; ++c) {
        sums[n * channels + c] += static_cast<double>(differences(static_cast<Eigen::Index>(i) * channels + c, n));
      }
    }
  }
}

double BorderSteps::largest() const {
  double largest = 0.0;
  for (const Border& border : borders_) {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(border.sums.cols());
    double texels = 0.0;
    for (std::size_t s = 0; s < border.counts.size(); ++s) {
      if (border.counts[s] < kFewestTexels) continue;
      const Eigen::VectorXd mean = border.sums.row(static_cast<Eigen::Index>(s)).transpose() / border.counts[s];
      squares += border.counts[s] * mean.cwiseAbs2();
      texels += border.counts[s];
    }
    if (texels > 0.0) largest = std::max(largest, std::sqrt(squares.maxCoeff() / texels));
  }
  return largest;
}

}  // namespace facezip::compress
