#include "learn/texture_regression.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "facezip/geometry/skin_strain.hpp"
#include "io/counts.hpp"
#include "raster/nearest_marked.hpp"

namespace facezip::learn {
namespace {

/// Where the hats stand: finer where wrinkles begin. The one at 0 is left out, so that nothing happens there.
constexpr std::array<float, 11> kKnots = {-0.4f, -0.25f, -0.15f, -0.08f, -0.03f, 0.0f,
                                          0.03f, 0.08f,  0.15f,  0.25f,  0.4f};
constexpr int kNeutralKnot = 5;
/// Rings that strain is averaged over: a scan's noise is no strain.
constexpr int kStrainRounds = 3;
/// Standard deviations of the blurs whose differences are details, in texels of a layout of 256 a side; the last is
/// the local colour.
constexpr std::array<float, 4> kBlurs = {1.0f, 2.0f, 4.0f, 8.0f};
constexpr int kScales = 3;
/// Features of one channel: its colour, and each detail as it is and over its usual size.
constexpr int kOfChannel = 1 + 2 * kScales;
/// Usual sizes below this (1/255) are noise.
constexpr float kLeastDetail = 0.5f;
/// Of the squared length of each feature.
constexpr double kRidge = 1e-3;
/// Levels below this (1/255) are no skin's.
constexpr float kLeastLevel = 16.0f;
constexpr float kLevel = 128.0f;  // that textures are brought to

struct HatPair {
  int first = 0;       ///< interval [knot first, knot first + 1]
  float share = 0.0f;  ///< of the second
};

HatPair hatsAt(float strain) {
  const float u = std::clamp(strain, kKnots.front(), kKnots.back());
  int first = 0;
  while (first + 2 < static_cast<int>(kKnots.size()) && u > kKnots[static_cast<std::size_t>(first) + 1]) ++first;
  const float low = kKnots[static_cast<std::size_t>(first)], high = kKnots[static_cast<std::size_t>(first) + 1];
  return {first, (u - low) / (high - low)};
}

/// Row of a knot among the hats; -1 for the one at 0.
int hatOf(int knot) { return knot == kNeutralKnot ? -1 : knot < kNeutralKnot ? knot : knot - 1; }

std::vector<float> gaussian(float deviation) {
  const int reach = std::max(1, static_cast<int>(std::ceil(2.5f * deviation)));
  std::vector<float> weights;
  float sum = 0.0f;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5f * static_cast<float>(i * i) / (deviation * deviation)));
    sum += weights.back();
  }
  for (float& weight : weights) weight /= sum;
  return weights;
}

/// One channel of a square layout; edges repeat.
using Plane = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Plane blurred(const Plane& plane, float deviation) {
  const std::vector<float> weights = gaussian(deviation);
  const int reach = static_cast<int>(weights.size()) / 2;
  const auto along = [&](const Plane& from) {  // down the rows, for whole rows at once
    Plane to = Plane::Zero(from.rows(), from.cols());
    for (Eigen::Index y = 0; y < from.rows(); ++y) {
      for (int i = -reach; i <= reach; ++i) {
        const Eigen::Index at = std::clamp<Eigen::Index>(y + i, 0, from.rows() - 1);
        to.row(y) += weights[static_cast<std::size_t>(i + reach)] * from.row(at);
      }
    }
    return to;
  };
  return along(along(plane).transpose()).transpose();
}

Plane channelOf(const image::FloatImage& image, int channel) {
  Plane plane(image.height, image.width);
  const auto step = static_cast<std::size_t>(image.channels);
  for (Eigen::Index i = 0; i < plane.size(); ++i) {
    plane.data()[i] = image.samples[static_cast<std::size_t>(i) * step + static_cast<std::size_t>(channel)];
  }
  return plane;
}

/// Writes the features of one channel into columns from `column` on.
void addChannel(const Plane& plane, const std::vector<int>& texels, Eigen::Index column, Eigen::MatrixXf& features) {
  const float unit = static_cast<float>(plane.rows()) / 256.0f;
  std::array<Plane, kBlurs.size()> blurs;
  for (std::size_t i = 0; i < kBlurs.size(); ++i) blurs[i] = blurred(plane, kBlurs[i] * unit);
  const auto count = static_cast<Eigen::Index>(texels.size());
  const auto pick = [&](const Plane& from) {
    Eigen::VectorXf values(count);
    for (Eigen::Index t = 0; t < count; ++t) values[t] = from.data()[texels[static_cast<std::size_t>(t)]];
    return values;
  };
  features.col(column) = pick(blurs.back()).array() / kLevel - 1.0f;
  for (int scale = 0; scale < kScales; ++scale) {
    const auto s = static_cast<std::size_t>(scale);
    const Eigen::VectorXf detail = pick(blurs[s]) - pick(blurs[s + 1]);
    const float usual = std::sqrt(detail.squaredNorm() / std::max<float>(1.0f, static_cast<float>(count)));
    features.col(column + 1 + scale) = detail / 16.0f;
    features.col(column + 1 + kScales + scale) = detail / (usual + kLeastDetail);
  }
}

}  // namespace

Eigen::Index featureCount(int channels) { return 1 + static_cast<Eigen::Index>(channels) * kOfChannel; }
Eigen::Index hatCount() { return static_cast<Eigen::Index>(kKnots.size()) - 1; }

TexelStrain::TexelStrain(const geometry::TriangleMesh& neutral, const std::vector<int>& region, int side)
    : side_(side), neutral_(neutral.positions), triangles_(neutral.triangles) {
  const raster::UvRaster raster(neutral, region, side, side, 0);
  const std::vector<raster::TexelSample> samples = raster.coveredRows(0, side);
  std::vector<std::uint8_t> covered(samples.size());
  std::vector<int> index(samples.size(), -1);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].kind != raster::TexelSample::Kind::kCovered) continue;
    covered[i] = 1;
    index[i] = static_cast<int>(texels_.size());
    texels_.push_back(static_cast<int>(i));
    samples_.push_back(samples[i]);
  }
  const std::vector<int> nearest = raster::nearestMarked(covered, side, side);
  source_.assign(samples.size(), -1);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool shown_elsewhere = samples[i].kind == raster::TexelSample::Kind::kOutside;
    if (!shown_elsewhere && nearest[i] >= 0) source_[i] = index[static_cast<std::size_t>(nearest[i])];
  }
}

Eigen::VectorXf TexelStrain::of(const Eigen::MatrixX3d& displacement) const {
  const geometry::SkinStrain skin(neutral_, triangles_);
  const Eigen::VectorXd rest = skin.ringLengths(neutral_), posed = skin.ringLengths(neutral_ + displacement);
  Eigen::VectorXd ratio(rest.size());
  for (Eigen::Index v = 0; v < rest.size(); ++v) {
    ratio[v] = rest[v] > 0.0 && posed[v] > 0.0 ? std::log(posed[v] / rest[v]) : 0.0;
  }
  const Eigen::VectorXf strain = skin.smoothed(ratio, kStrainRounds).cast<float>();
  Eigen::VectorXf values(static_cast<Eigen::Index>(samples_.size()));
  for (std::size_t t = 0; t < samples_.size(); ++t) {
    const auto corners = triangles_.row(samples_[t].triangle);
    const float b0 = samples_[t].b0, b1 = samples_[t].b1;
    values[static_cast<Eigen::Index>(t)] =
        b0 * strain[corners[0]] + b1 * strain[corners[1]] + (1.0f - b0 - b1) * strain[corners[2]];
  }
  return values;
}

image::FloatImage TexelStrain::imageOf(const Eigen::MatrixXf& values) const {
  image::FloatImage image(side_, side_, static_cast<int>(values.cols()));
  for (std::size_t i = 0; i < source_.size(); ++i) {
    if (source_[i] < 0) continue;
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
      image.samples[i * static_cast<std::size_t>(values.cols()) + static_cast<std::size_t>(c)] = values(source_[i], c);
    }
  }
  return image;
}

Eigen::RowVectorXf levelsOf(const image::FloatImage& texture, const std::vector<int>& texels) {
  Eigen::RowVectorXd sums = Eigen::RowVectorXd::Zero(texture.channels);
  for (const int texel : texels) {
    for (int c = 0; c < texture.channels; ++c) {
      sums[c] +=
          texture.samples[static_cast<std::size_t>(texel) * toSize(texture.channels) + static_cast<std::size_t>(c)];
    }
  }
  return (sums / std::max<double>(1.0, static_cast<double>(texels.size()))).cast<float>().cwiseMax(kLeastLevel);
}

Eigen::MatrixXf textureFeatures(const std::vector<image::FloatImage>& textures, const std::vector<int>& texels) {
  int channels = 0;
  for (const image::FloatImage& texture : textures) channels += texture.channels;
  Eigen::MatrixXf features(static_cast<Eigen::Index>(texels.size()), featureCount(channels));
  features.col(0).setOnes();
  Eigen::Index column = 1;
  for (const image::FloatImage& texture : textures) {
    const Eigen::RowVectorXf levels = levelsOf(texture, texels);
    for (int c = 0; c < texture.channels; ++c) {
      addChannel(kLevel / levels[c] * channelOf(texture, c), texels, column, features);
      column += kOfChannel;
    }
  }
  return features;
}

Eigen::MatrixXf predictTexture(const TextureRegression& regression, const Eigen::VectorXf& strain,
                               const Eigen::MatrixXf& features) {
  const Eigen::Index count = features.cols();
  assert(regression.factors.rows() == hatCount() * count);
  Eigen::MatrixXf changes = Eigen::MatrixXf::Zero(strain.size(), regression.factors.cols());
  for (Eigen::Index t = 0; t < strain.size(); ++t) {
    const HatPair hats = hatsAt(strain[t]);
    for (const auto& [knot, weight] :
         {std::pair{hats.first, 1.0f - hats.share}, std::pair{hats.first + 1, hats.share}}) {
      if (hatOf(knot) < 0 || weight == 0.0f) continue;
      changes.row(t) += weight * (features.row(t) * regression.factors.middleRows(hatOf(knot) * count, count));
    }
  }
  return changes;
}

TextureSums::TextureSums(Eigen::Index features, Eigen::Index channels)
    : gram_(Eigen::MatrixXd::Zero(hatCount() * features, hatCount() * features)),
      right_(Eigen::MatrixXd::Zero(hatCount() * features, channels)),
      squares_(Eigen::VectorXd::Zero(channels)) {}

void TextureSums::add(const Eigen::VectorXf& strain, const Eigen::MatrixXf& features, const Eigen::MatrixXf& changes) {
  // Texels between the same two knots share their hats: one product of matrices for all of them.
  std::vector<std::vector<Eigen::Index>> between(kKnots.size() - 1);
  std::vector<float> shares(static_cast<std::size_t>(strain.size()));
  for (Eigen::Index t = 0; t < strain.size(); ++t) {
    const HatPair hats = hatsAt(strain[t]);
    shares[static_cast<std::size_t>(t)] = hats.share;
    between[static_cast<std::size_t>(hats.first)].push_back(t);
  }
  squares_ += changes.cast<double>().colwise().squaredNorm().transpose();
  texels_ += static_cast<double>(changes.rows());
  const Eigen::Index count = features.cols();
  for (std::size_t interval = 0; interval < between.size(); ++interval) {
    const std::vector<Eigen::Index>& texels = between[interval];
    if (texels.empty()) continue;
    Eigen::VectorXf share(std::ssize(texels));
    for (std::size_t i = 0; i < texels.size(); ++i) {
      share[static_cast<Eigen::Index>(i)] = shares[static_cast<std::size_t>(texels[i])];
    }
    const Eigen::MatrixXf rows = features(texels, Eigen::all);
    const Eigen::MatrixXf y = changes(texels, Eigen::all);
    const std::array<int, 2> hats = {hatOf(static_cast<int>(interval)), hatOf(static_cast<int>(interval) + 1)};
    const std::array<Eigen::MatrixXf, 2> x = {(1.0f - share.array()).matrix().asDiagonal() * rows,
                                              share.asDiagonal() * rows};
    for (std::size_t a = 0; a < 2; ++a) {
      if (hats[a] < 0) continue;
      right_.middleRows(hats[a] * count, count) += (x[a].transpose() * y).cast<double>();
      for (std::size_t b = 0; b < 2; ++b) {
        if (hats[b] < 0) continue;
        gram_.block(hats[a] * count, hats[b] * count, count, count) += (x[a].transpose() * x[b]).cast<double>();
      }
    }
  }
}

void TextureSums::add(const TextureSums& other) {
  gram_ += other.gram_;
  right_ += other.right_;
  squares_ += other.squares_;
  texels_ += other.texels_;
}

Eigen::MatrixXf TextureSums::solve(const std::vector<Eigen::Index>& used, Eigen::Index begin,
                                   Eigen::Index count) const {
  const Eigen::Index all = gram_.rows() / hatCount();
  std::vector<Eigen::Index> rows;
  for (Eigen::Index hat = 0; hat < hatCount(); ++hat) {
    for (const Eigen::Index feature : used) rows.push_back(hat * all + feature);
  }
  Eigen::MatrixXd system = gram_(rows, rows);
  const double most = std::max(system.diagonal().maxCoeff(), 1e-12);
  system.diagonal() = (1.0 + kRidge) * system.diagonal().array() + 1e-9 * most;
  return system.ldlt().solve(right_(rows, Eigen::seqN(begin, count))).cast<float>();
}

std::pair<double, double> TextureSums::errorOf(const Eigen::MatrixXf& factors, Eigen::Index begin,
                                               Eigen::Index count) const {
  const Eigen::MatrixXd b = factors.cast<double>();
  const double nothing = squares_.segment(begin, count).sum();
  const double left =
      nothing - 2.0 * b.cwiseProduct(right_.middleCols(begin, count)).sum() + b.cwiseProduct(gram_ * b).sum();
  const double values = std::max(texels_ * static_cast<double>(count), 1.0);
  return {std::sqrt(std::max(left, 0.0) / values), std::sqrt(nothing / values)};
}

}  // namespace facezip::learn
