#include "register/texture_baking.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "facezip/error.hpp"
#include "facezip/geometry/mesh_edges.hpp"
#include "image/averaged_image.hpp"
#include "io/counts.hpp"
#include "register/resample.hpp"

namespace facezip::registration {
namespace {

constexpr double kLeastCosine = 0.3;
constexpr double kReach = 3.0;           // millimetres between mesh and scan
constexpr double kHalfConfidence = 1.0;  // distance at which confidence is half
constexpr int kBandRows = 128;

std::uint8_t confidenceOf(double cosine, double distance) {
  const double share = distance / kHalfConfidence;
  return static_cast<std::uint8_t>(std::lround(std::clamp(255.0 * cosine / (1.0 + share * share), 1.0, 255.0)));
}

/// Area of the wanted triangles in their texture plane, of 1, for each square millimetre of skin; 0 without any.
template <typename Wanted>
double planeOfSkin(const geometry::TriangleMesh& mesh, const Eigen::MatrixX3d& positions, Wanted&& wanted) {
  double plane = 0.0, skin = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    if (!wanted(t)) continue;
    const Eigen::RowVector2d a = mesh.uvs.row(mesh.uv_triangles(t, 0));
    const Eigen::RowVector2d b = mesh.uvs.row(mesh.uv_triangles(t, 1)) - a,
                             c = mesh.uvs.row(mesh.uv_triangles(t, 2)) - a;
    plane += 0.5 * std::abs(b.x() * c.y() - b.y() * c.x());
    skin += geometry::triangleArea(positions, mesh.triangles, t);
  }
  return skin > 0.0 ? plane / skin : 0.0;
}

double planeOfLayout(const geometry::TriangleMesh& mesh, const Eigen::MatrixX3d& positions) {
  return planeOfSkin(mesh, positions, [](Eigen::Index) { return true; });
}

/// Texels of a material's texture on a square millimetre of skin.
double texelsOfSkin(const Scan& scan, const geometry::ScanSurface& surface, std::size_t material,
                    const image::ImageShape& shape) {
  return 1.0 * shape.width * shape.height * planeOfSkin(scan.mesh, surface.judged().positions, [&](Eigen::Index t) {
           return scan.materials[toSize(t)] == static_cast<int>(material);
         });
}

/// Coloured vertices on a square millimetre of skin.
double verticesOfSkin(const Scan& scan, const geometry::ScanSurface& surface) {
  double skin = 0.0;
  for (Eigen::Index t = 0; t < scan.mesh.triangles.rows(); ++t) {
    skin += geometry::triangleArea(surface.judged().positions, scan.mesh.triangles, t);
  }
  return skin > 0.0 ? static_cast<double>(scan.mesh.positions.rows()) / skin : 0.0;
}

/// Coordinates beyond 0 to 1 repeat the texture.
double wrapped(double coordinate) {
  return coordinate < 0.0 || coordinate > 1.0 ? coordinate - std::floor(coordinate) : coordinate;
}

}  // namespace

std::vector<SeenTexel> seenTexels(const raster::UvRaster& raster, const Eigen::MatrixX3i& triangles,
                                  const Eigen::MatrixX3d& positions, const geometry::ScanSurface& scan, int begin,
                                  int end) {
  const std::vector<raster::TexelSample> samples = raster.rows(begin, end);
  const Eigen::MatrixX3d normals = geometry::vertexNormals(positions, triangles);
  std::vector<SeenTexel> seen(samples.size());
  const auto width = toSize(raster.width());
  tbb::parallel_for(begin, end, [&](int row) {
    int hint = -1;  // the texel before shows a point nearby
    for (std::size_t i = toSize(row - begin) * width; i < toSize(row - begin + 1) * width; ++i) {
      const raster::TexelSample& sample = samples[i];
      if (sample.triangle < 0) continue;
      const double weights[3] = {double{sample.b0}, double{sample.b1}, 1.0 - double{sample.b0} - double{sample.b1}};
      Eigen::Vector3d point = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        point += weights[k] * positions.row(triangles(sample.triangle, k)).transpose();
        normal += weights[k] * normals.row(triangles(sample.triangle, k)).transpose();
      }
      normal.normalize();
      const geometry::SurfacePoint found = scan.surface().closestFacing(point, normal, kLeastCosine, kReach, hint);
      if (!found.found()) continue;
      hint = found.triangle;
      if (scan.surface().onBorder(found)) continue;
      const double cosine = scan.surface().normals().row(found.triangle).dot(normal);
      seen[i] = {found.triangle, static_cast<float>(found.barycentric[0]), static_cast<float>(found.barycentric[1]),
                 confidenceOf(cosine, found.distance)};
    }
  });
  return seen;
}

ScanTextures::ScanTextures(const geometry::TriangleMesh& mesh, const Eigen::MatrixX3d& positions, int side,
                           const Scan& scan, const geometry::ScanSurface& surface, device::DeviceContext& context)
    : scan_(scan) {
  const double layout = 1.0 * side * side * planeOfLayout(mesh, positions);
  for (std::size_t m = 0; m < scan.textures.size(); ++m) {
    if (scan.textures[m].empty()) continue;
    const image::ImageShape shape = image::ImageReader(scan.textures[m]).shape();
    const double texels = texelsOfSkin(scan, surface, m, shape);
    const int factor = layout > 0.0 ? std::clamp(static_cast<int>(std::sqrt(texels / layout)), 1, 64) : 1;
    const image::Image texture = image::readAveraged(scan.textures[m], factor);
    sources_.push_back({static_cast<int>(m), static_cast<double>(shape.width) / factor,
                        static_cast<double>(shape.height) / factor, TextureSampler(context, texture)});
    const image::ImageShape& first = sources_.front().sampler.shape();
    if (texture.shape.channels == first.channels && texture.shape.type == first.type) continue;
    throw InputError({scan.textures[m].string(), "",
                      fmt::format("{} channels of {} as the scan's other textures", first.channels,
                                  image::sampleTypeName(first.type)),
                      fmt::format("{} of {}", texture.shape.channels, image::sampleTypeName(texture.shape.type)), ""});
  }
}

/// Places in the texture of a material; NaN for texels of others.
std::vector<float> ScanTextures::placesOf(std::span<const SeenTexel> seen, const Source& source) const {
  std::vector<float> places(2 * seen.size(), std::numeric_limits<float>::quiet_NaN());
  tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t i) {
    const SeenTexel& texel = seen[i];
    if (texel.triangle < 0 || scan_.materials[toSize(texel.triangle)] != source.material) return;
    const double weights[3] = {double{texel.b0}, double{texel.b1}, 1.0 - double{texel.b0} - double{texel.b1}};
    Eigen::RowVector2d uv = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k) uv += weights[k] * scan_.mesh.uvs.row(scan_.mesh.uv_triangles(texel.triangle, k));
    places[2 * i] = static_cast<float>(wrapped(uv.x()) * source.columns - 0.5);
    places[2 * i + 1] = static_cast<float>((1.0 - wrapped(uv.y())) * source.rows - 0.5);
  });
  return places;
}

void ScanTextures::sampleColours(std::span<const SeenTexel> seen, std::span<float> samples) const {
  tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t i) {
    const SeenTexel& texel = seen[i];
    if (texel.triangle < 0) return;
    const Eigen::RowVector3f weights(texel.b0, texel.b1, 1.0f - texel.b0 - texel.b1);
    const Eigen::RowVector3i corners = scan_.colour_triangles.row(texel.triangle);
    const Eigen::RowVector3f colour = weights * scan_.colours(corners, Eigen::all);
    std::copy_n(colour.data(), 3, samples.begin() + static_cast<std::ptrdiff_t>(3 * i));
  });
}

void ScanTextures::sample(std::span<const SeenTexel> seen, std::span<float> samples) {
  if (scan_.isPainted()) return sampleColours(seen, samples);
  for (Source& source : sources_) source.sampler.sample(placesOf(seen, source), samples);
  const float scale = image::unit255(type()) / 255.0f;
  const auto stride = toSize(channels());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].triangle < 0) continue;
    for (std::size_t c = 0; c < stride; ++c) samples[i * stride + c] *= scale;
  }
}

double layoutSideOf(const geometry::TriangleMesh& mesh, const Eigen::MatrixX3d& positions, const Scan& scan,
                    const geometry::ScanSurface& surface) {
  double texels = 0.0;
  for (std::size_t m = 0; m < scan.textures.size(); ++m) {
    if (scan.textures[m].empty()) continue;
    texels = std::max(texels, texelsOfSkin(scan, surface, m, image::ImageReader(scan.textures[m]).shape()));
  }
  if (scan.isPainted()) texels = verticesOfSkin(scan, surface);
  const double plane = planeOfLayout(mesh, positions);
  return plane > 0.0 ? std::sqrt(texels / plane) : 0.0;
}

BakedTexture bakeTexture(const raster::UvRaster& raster, const geometry::TriangleMesh& mesh,
                         const Eigen::MatrixX3d& positions, const geometry::ScanSurface& surface,
                         ScanTextures& textures, Progress& progress) {
  BakedTexture baked;
  baked.side = raster.width();
  baked.channels = textures.channels();
  baked.type = textures.type();
  const std::size_t texels = toSize(raster.width(), raster.height());
  baked.samples.assign(texels * toSize(baked.channels), 0.0f);
  baked.confidence.assign(texels, 0);
  for (int begin = 0; begin < raster.height(); begin += kBandRows) {
    progress.checkCancelled();
    const int end = std::min(begin + kBandRows, raster.height());
    const std::vector<SeenTexel> seen = seenTexels(raster, mesh.triangles, positions, surface, begin, end);
    const std::size_t first = toSize(begin, raster.width());
    textures.sample(
        seen, std::span(baked.samples).subspan(first * toSize(baked.channels), seen.size() * toSize(baked.channels)));
    for (std::size_t i = 0; i < seen.size(); ++i) baked.confidence[first + i] = seen[i].confidence;
  }
  return baked;
}

}  // namespace facezip::registration
