#include "synth/texture_painter.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "synth/noise.hpp"

namespace facezip::synth {
namespace {

// Bicubic resampling takes one row before and two after, misalignment moves by up to two more, slopes take another.
constexpr int kMargin = 5;

enum Plane : int { kRed, kGreen, kBlue, kHeight, kSpecularPlane, kRoughnessPlane, kPlaneCount };

// How skin answers to its state.
constexpr float kBloodPerLogArea = -0.90f;  // stretched skin is paler, compressed skin redder
constexpr float kBloodPerFlush = 0.24f;
constexpr float kCreaseShading = 0.50f;                                  // log reflectance of a full valley
constexpr std::array<float, 3> kShadowExponent = {0.42f, 0.60f, 0.66f};  // light in folds is red: it went through skin
constexpr float kShadowFloor = 0.22f;
constexpr float kDisplacementRange = 0.004f;  // metres from black to white

float encodeSrgb(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

/// 255 * sRGB(exp(x)), from a table: three powers and exponentials per texel and expression would dominate the run.
class LogToSrgb255 {
 public:
  LogToSrgb255() {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      table_[i] = 255.0f * encodeSrgb(std::exp(kLow + static_cast<float>(i) / kPerUnit));
    }
  }
  float operator()(float x) const {
    const float position = std::clamp((x - kLow) * kPerUnit, 0.0f, static_cast<float>(table_.size() - 2));
    const auto index = static_cast<std::size_t>(position);
    return mix(table_[index], table_[index + 1], position - static_cast<float>(index));
  }

 private:
  static constexpr float kLow = -9.0f;
  static constexpr float kPerUnit = 128.0f;  // linear interpolation is then right to 0.01/255
  std::array<float, 1154> table_;
};

std::uint8_t quantise8(float value255) { return static_cast<std::uint8_t>(std::clamp(value255 + 0.5f, 0.0f, 255.0f)); }

/// Catmull-Rom weights of the four samples around a position between the middle two.
std::array<float, 4> cubicWeights(float f) {
  return {f * (f * (1.0f - 0.5f * f) - 0.5f), f * f * (1.5f * f - 2.5f) + 1.0f, f * (f * (2.0f - 1.5f * f) + 0.5f),
          f * f * (0.5f * f - 0.5f)};
}

}  // namespace

const std::vector<MapFormat>& mapFormats() {
  static const std::vector<MapFormat> formats = {
      {MapKind::kAlbedo, "albedo", 3, image::SampleType::kUint8, "sRGB"},
      {MapKind::kNormal, "normal", 3, image::SampleType::kUint8, "linear"},
      {MapKind::kSpecular, "specular", 1, image::SampleType::kUint8, "linear"},
      {MapKind::kRoughness, "roughness", 1, image::SampleType::kUint8, "linear"},
      {MapKind::kDisplacement, "displacement", 1, image::SampleType::kUint16, "linear"},
  };
  return formats;
}

/// Rows [begin, end) of the painted surface; `kPlaneCount` floats per texel.
struct TexturePainter::Planes {
  int begin;
  int width;
  std::vector<std::array<float, kPlaneCount>> texels;

  const std::array<float, kPlaneCount>& at(int row, int x) const {
    return texels[static_cast<std::size_t>(row - begin) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

TexturePainter::TexturePainter(const HeadMesh& head, std::uint64_t seed, int resolution)
    : head_(head),
      resolution_(resolution),
      raster_(head.mesh, resolution),
      skin_(seed, Landmarks{}, static_cast<float>(HeadMesh::kUvExtent / resolution)),
      creases_(seed, static_cast<float>(HeadMesh::kUvExtent / resolution)) {}

SkinBand TexturePainter::skinBand(int begin, int end) const {
  SkinBand band{std::max(0, begin - kMargin), std::min(resolution_, end + kMargin), {}};
  const auto width = static_cast<std::size_t>(resolution_);
  band.texels.resize(static_cast<std::size_t>(band.end - band.begin) * width);
  tbb::parallel_for(band.begin, band.end, [&](int row) {
    std::vector<MeshPoint> points(width);
    raster_.rasteriseRow(row, points);
    SkinBand::Texel* texels = band.texels.data() + static_cast<std::size_t>(row - band.begin) * width;
    for (std::size_t x = 0; x < width; ++x) {
      const auto corners = head_.mesh.triangles.row(points[x].triangle);
      const std::array<float, 3> weights = {1.0f - points[x].b1 - points[x].b2, points[x].b1, points[x].b2};
      float s = 0.0f, t = 0.0f;
      for (int k = 0; k < 3; ++k) {
        const SkinPoint& corner = head_.skin[static_cast<std::size_t>(corners(k))];
        s += weights[static_cast<std::size_t>(k)] * static_cast<float>(corner.s);
        t += weights[static_cast<std::size_t>(k)] * static_cast<float>(corner.t);
      }
      texels[x] = {points[x], skin_.sample(s, t), skin_.flushMap(s, t), creases_.pattern(s, t)};
    }
  });
  return band;
}

SkinState TexturePainter::stateAt(const Performance& performance, const MeshPoint& point) const {
  const auto corners = head_.mesh.triangles.row(point.triangle);
  const SkinState& a = performance.states[static_cast<std::size_t>(corners(0))];
  const SkinState& b = performance.states[static_cast<std::size_t>(corners(1))];
  const SkinState& c = performance.states[static_cast<std::size_t>(corners(2))];
  const auto interpolate = [&](float SkinState::*field) {
    return a.*field + point.b1 * (b.*field - a.*field) + point.b2 * (c.*field - a.*field);
  };
  return {interpolate(&SkinState::compression_x), interpolate(&SkinState::compression_y),
          interpolate(&SkinState::log_area),      interpolate(&SkinState::openness),
          interpolate(&SkinState::metres_per_u),  interpolate(&SkinState::metres_per_v)};
}

TexturePainter::Planes TexturePainter::paintSurface(const Performance& performance, const SkinBand& skin) const {
  static const LogToSrgb255 to_srgb255;
  Planes planes{skin.begin, resolution_, std::vector<std::array<float, kPlaneCount>>(skin.texels.size())};
  for (std::size_t i = 0; i < skin.texels.size(); ++i) {
    const SkinBand::Texel& texel = skin.texels[i];
    const SkinState state = stateAt(performance, texel.point);
    const Creases creases = creases_.fold(texel.creases, state.compression_x, state.compression_y);
    const float blood = texel.skin.blood * (kBloodPerLogArea * std::clamp(state.log_area, -0.30f, 0.30f) +
                                            kBloodPerFlush * static_cast<float>(performance.flush) * texel.flush);
    const float log_light = std::log(kShadowFloor + (1.0f - kShadowFloor) * state.openness);
    std::array<float, kPlaneCount>& out = planes.texels[i];
    for (std::size_t c = 0; c < 3; ++c) {
      out[c] = to_srgb255(texel.skin.log_colour[c] - blood * Skin::kHaemoglobin[c] + kShadowExponent[c] * log_light +
                          kCreaseShading * creases.shading);
    }
    out[kHeight] = texel.skin.height + creases.height;
    out[kSpecularPlane] = 255.0f * std::clamp(0.25f + 0.45f * texel.skin.oil + 0.15f * creases.shading, 0.0f, 1.0f) *
                          std::exp(0.5f * log_light);
    out[kRoughnessPlane] = 255.0f * std::clamp(0.72f - 0.40f * texel.skin.oil - 0.10f * creases.shading, 0.0f, 1.0f);
  }
  return planes;
}

TexturePainter::Planes TexturePainter::misaligned(const Performance& performance, const Planes& planes, int begin,
                                                  int end) const {
  const int last_row = planes.begin + static_cast<int>(planes.texels.size()) / resolution_ - 1;
  Planes moved{begin, resolution_, {}};
  moved.texels.resize(static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(resolution_));
  for (int row = begin; row < end; ++row) {
    for (int x = 0; x < resolution_; ++x) {
      const auto [dx, dy] =
          performance.scanner.misalignment((static_cast<float>(x) + 0.5f) / static_cast<float>(resolution_),
                                           (static_cast<float>(row) + 0.5f) / static_cast<float>(resolution_));
      std::array<float, kPlaneCount>& out =
          moved.texels[static_cast<std::size_t>(row - begin) * static_cast<std::size_t>(resolution_) +
                       static_cast<std::size_t>(x)];
      if (dx == 0.0f && dy == 0.0f) {
        out = planes.at(row, x);
        continue;
      }
      const float floor_x = std::floor(dx);
      const float floor_y = std::floor(dy);
      const std::array<float, 4> weights_x = cubicWeights(dx - floor_x);
      const std::array<float, 4> weights_y = cubicWeights(dy - floor_y);
      out = {};
      for (int j = 0; j < 4; ++j) {
        const int from_row = std::clamp(row + static_cast<int>(floor_y) + j - 1, planes.begin, last_row);
        for (int i = 0; i < 4; ++i) {
          const int from_x = std::clamp(x + static_cast<int>(floor_x) + i - 1, 0, resolution_ - 1);
          const float weight = weights_y[static_cast<std::size_t>(j)] * weights_x[static_cast<std::size_t>(i)];
          const std::array<float, kPlaneCount>& from = planes.at(from_row, from_x);
          for (std::size_t c = 0; c < kPlaneCount; ++c) out[c] += weight * from[c];
        }
      }
    }
  }
  return moved;
}

void TexturePainter::encodeAlbedo(const Performance& performance, const Planes& planes, int begin, int end,
                                  std::byte* out) const {
  for (int row = begin; row < end; ++row) {
    for (int x = 0; x < resolution_; ++x) {
      const std::array<float, 3> gain =
          performance.scanner.gain((static_cast<float>(x) + 0.5f) / static_cast<float>(resolution_),
                                   (static_cast<float>(row) + 0.5f) / static_cast<float>(resolution_));
      const std::array<float, kPlaneCount>& texel = planes.at(row, x);
      for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<std::size_t>(c);
        *out++ = std::byte{quantise8(texel[i] * gain[i] + performance.scanner.noise(x, row, c))};
      }
    }
  }
}

void TexturePainter::encodeNormal(const Performance& performance, const SkinBand& skin, const Planes& planes, int begin,
                                  int end, std::byte* out) const {
  const int last_row = planes.begin + static_cast<int>(planes.texels.size()) / resolution_ - 1;
  for (int row = begin; row < end; ++row) {
    for (int x = 0; x < resolution_; ++x) {
      const int left = std::max(0, x - 1), right = std::min(resolution_ - 1, x + 1);
      const int above = std::max(planes.begin, row - 1), below = std::min(last_row, row + 1);
      const SkinBand::Texel& texel =
          skin.texels[static_cast<std::size_t>(row - skin.begin) * static_cast<std::size_t>(resolution_) +
                      static_cast<std::size_t>(x)];
      const SkinState state = stateAt(performance, texel.point);
      const float texels = static_cast<float>(resolution_);
      const float slope_u = (planes.at(row, right)[kHeight] - planes.at(row, left)[kHeight]) * texels /
                            (static_cast<float>(right - left) * state.metres_per_u);
      const float slope_v = (planes.at(above, x)[kHeight] - planes.at(below, x)[kHeight]) * texels /
                            (static_cast<float>(below - above) * state.metres_per_v);
      const float scale = 127.5f / std::sqrt(slope_u * slope_u + slope_v * slope_v + 1.0f);
      *out++ = std::byte{quantise8(127.5f - scale * slope_u)};
      *out++ = std::byte{quantise8(127.5f - scale * slope_v)};
      *out++ = std::byte{quantise8(127.5f + scale)};
    }
  }
}

void TexturePainter::encodeGrey(const Planes& planes, int plane, int begin, int end, std::byte* out) const {
  for (int row = begin; row < end; ++row) {
    for (int x = 0; x < resolution_; ++x)
      *out++ = std::byte{quantise8(planes.at(row, x)[static_cast<std::size_t>(plane)])};
  }
}

void TexturePainter::encodeDisplacement(const Planes& planes, int begin, int end, std::byte* out) const {
  auto* samples = reinterpret_cast<std::uint16_t*>(out);
  for (int row = begin; row < end; ++row) {
    for (int x = 0; x < resolution_; ++x) {
      const float value = 0.5f + planes.at(row, x)[kHeight] / kDisplacementRange;
      *samples++ = static_cast<std::uint16_t>(std::clamp(65535.0f * value + 0.5f, 0.0f, 65535.0f));
    }
  }
}

std::vector<std::vector<std::byte>> TexturePainter::paint(const Performance& performance, const SkinBand& skin,
                                                          int begin, int end,
                                                          const std::vector<MapFormat>& formats) const {
  const Planes surface = paintSurface(performance, skin);
  // One more row on each side, for the slopes.
  const Planes scanned = misaligned(performance, surface, std::max(0, begin - 1), std::min(resolution_, end + 1));
  std::vector<std::vector<std::byte>> bands;
  for (const MapFormat& format : formats) {
    const image::ImageShape shape{resolution_, resolution_, format.channels, format.type};
    std::vector<std::byte>& band = bands.emplace_back(static_cast<std::size_t>(end - begin) * shape.rowBytes());
    switch (format.kind) {
      case MapKind::kAlbedo:
        encodeAlbedo(performance, scanned, begin, end, band.data());
        break;
      case MapKind::kNormal:
        encodeNormal(performance, skin, scanned, begin, end, band.data());
        break;
      case MapKind::kSpecular:
        encodeGrey(scanned, kSpecularPlane, begin, end, band.data());
        break;
      case MapKind::kRoughness:
        encodeGrey(scanned, kRoughnessPlane, begin, end, band.data());
        break;
      case MapKind::kDisplacement:
        encodeDisplacement(scanned, begin, end, band.data());
        break;
    }
  }
  return bands;
}

}  // namespace facezip::synth
