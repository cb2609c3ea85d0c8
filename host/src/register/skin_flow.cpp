#include "register/skin_flow.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "facezip/geometry/mesh_edges.hpp"
#include "flow/flow_sampling.hpp"
#include "io/counts.hpp"
#include "register/flow_points.hpp"

namespace facezip::registration {
namespace {

constexpr int kLeastSide = 256;
constexpr int kMostSide = 1024;  // about what a fingertip's pores need on a head; finer flow takes longer, not farther
constexpr double kOversize = 1.25;  // beside the scan's own texels, so that resampling keeps them
constexpr double kStill = 0.5;      // texels

std::vector<int> seenOf(const geometry::BentSurface& surface) {
  std::vector<int> triangles;
  for (std::size_t t = 0; t < surface.seen.size(); ++t) {
    if (surface.seen[t]) triangles.push_back(static_cast<int>(t));
  }
  return triangles;
}

int flowSide(double texture_side) {
  const int side = static_cast<int>(std::min(kOversize * texture_side, double{kMostSide}));
  return std::clamp(roundUp(side, 64), kLeastSide, kMostSide);
}

TexelPlaces placesOf(const std::vector<SeenTexel>& seen, const PlacedScan& placed) {
  TexelPlaces places = TexelPlaces::Constant(static_cast<Eigen::Index>(seen.size()), 3, std::nan(""));
  const Eigen::MatrixX3d& positions = placed.surface.judged().positions;
  tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t i) {
    if (seen[i].triangle < 0) return;
    const Eigen::RowVector3d weights(double{seen[i].b0}, double{seen[i].b1},
                                     1.0 - double{seen[i].b0} - double{seen[i].b1});
    places.row(static_cast<Eigen::Index>(i)) =
        weights * positions(placed.scan.mesh.triangles.row(seen[i].triangle), Eigen::all);
  });
  return places;
}

/// Of the texels that both pictures know, those with more trust than not.
FlowLength lengthOf(const flow::TextureFlow& flow, const SkinPicture& from, const SkinPicture& to) {
  std::vector<double> lengths;
  std::size_t known = 0;
  for (int y = 0; y < flow.height; ++y) {
    for (int x = 0; x < flow.width; ++x) {
      const std::size_t at = toSize(y) * toSize(flow.width) + toSize(x);
      if (from.known[at] == 0 || to.known[at] == 0) continue;
      ++known;
      if (flow::trustOf(flow, x, y) < 0.5) continue;
      const float* vector = &flow.forward[flow::texelAt(flow, x, y)];
      lengths.push_back(double{std::hypot(vector[0], vector[1])});
    }
  }
  FlowLength length;
  if (lengths.empty()) return length;
  for (const double l : lengths) length.mean += l / static_cast<double>(lengths.size());
  const auto rank = lengths.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(lengths.size() - 1));
  std::nth_element(lengths.begin(), rank, lengths.end());
  length.percentile_95 = *rank;
  length.trusted = static_cast<double>(lengths.size()) / static_cast<double>(known);
  return length;
}

/// Millimetres that a texel is wide on the skin, on the whole.
double texelOf(const std::vector<raster::TexelSample>& texels, const geometry::BentSurface& surface) {
  double area = 0.0;
  for (std::size_t t = 0; t < surface.seen.size(); ++t) {
    if (!surface.seen[t]) continue;
    area += geometry::triangleArea(surface.reference, surface.matched.triangles, static_cast<Eigen::Index>(t));
  }
  const auto covered = std::count_if(texels.begin(), texels.end(), [](const auto& s) { return s.triangle >= 0; });
  return std::sqrt(area / static_cast<double>(std::max<std::ptrdiff_t>(1, covered)));
}

}  // namespace

SkinFlow::SkinFlow(const geometry::BentSurface& surface, const geometry::TriangleMesh& layout,
                   const PlacedScan& neutral, const Eigen::MatrixX3d& mesh, device::DeviceContext& context,
                   Progress& progress)
    : layout_(layout),
      context_(context),
      progress_(progress),
      raster_([&] {
        const int side = flowSide(layoutSideOf(layout, mesh, neutral.scan, neutral.surface));
        return raster::UvRaster(layout, seenOf(surface), side, side, 0);
      }()),
      texels_(raster_.rows(0, raster_.height())),
      registration_(surface) {
  ScanTextures textures(layout, mesh, side(), neutral.scan, neutral.surface, context);
  neutral_ = pictureOf(mesh, neutral, textures);
}

SkinPicture SkinFlow::pictureOf(const Eigen::MatrixX3d& mesh, const PlacedScan& placed, ScanTextures& textures) const {
  progress_.checkCancelled();
  SkinPicture picture;
  picture.seen = seenTexels(raster_, layout_.triangles, mesh, placed.surface, 0, side());
  const auto channels = toSize(textures.channels());
  std::vector<float> samples(picture.seen.size() * channels, 0.0f);
  textures.sample(picture.seen, samples);
  picture.grey.resize(picture.seen.size());
  picture.known.resize(picture.seen.size());
  for (std::size_t i = 0; i < picture.seen.size(); ++i) {
    picture.grey[i] = flow::greyOf(&samples[i * channels], textures.channels());
    picture.known[i] = picture.seen[i].triangle >= 0 ? 1 : 0;
  }
  return picture;
}

flow::GreyPicture SkinFlow::greyOf(const SkinPicture& picture) const {
  return {side(), side(), picture.grey, picture.known};
}

FlowRounds SkinFlow::draw(const Eigen::MatrixX3d& posed, const Eigen::MatrixX3d& mesh, const PlacedScan& placed) const {
  ScanTextures textures(layout_, mesh, side(), placed.scan, placed.surface, context_);
  const double texel = texelOf(texels_, registration_.surface());
  FlowRounds result;
  result.mesh = mesh;
  while (true) {
    const SkinPicture picture = pictureOf(result.mesh, placed, textures);
    const flow::TextureFlow flow = flow::flowBetween(greyOf(neutral_), greyOf(picture));
    result.after = lengthOf(flow, neutral_, picture);
    if (result.rounds == 0) result.before = result.after;
    if (result.rounds == kMostRounds || result.after.percentile_95 < kStill) return result;
    const std::vector<geometry::SkinPoint> points =
        flowPoints(flow, texels_, neutral_.known, placesOf(picture.seen, placed),
                   static_cast<int>(layout_.triangles.rows()), texel);
    result.mesh = registration_.draw(posed, result.mesh, points, placed.surface, placed.landmarks);
    ++result.rounds;
  }
}

}  // namespace facezip::registration
