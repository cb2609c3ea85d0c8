#include "register/detail_maps.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "facezip/geometry/mesh_edges.hpp"
#include "io/counts.hpp"
#include "register/hole_filling.hpp"
#include "register/texture_baking.hpp"

namespace facezip::registration {
namespace {

constexpr int kBandRows = 128;

/// Directions of rising u, for each UV, so that they meet at the edges of triangles; and which way v goes from there.
struct Frames {
  Eigen::MatrixX3d tangents;     ///< #UV by 3
  std::vector<double> mirrored;  ///< #T: 1, or -1 where the layout shows the triangle from behind
};

Frames framesOf(const geometry::TriangleMesh& mesh, const Eigen::MatrixX3d& positions) {
  Frames frames{Eigen::MatrixX3d::Zero(mesh.uvs.rows(), 3), {}};
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const Eigen::RowVector3d p = positions.row(mesh.triangles(t, 0));
    const Eigen::RowVector3d a = positions.row(mesh.triangles(t, 1)) - p, b = positions.row(mesh.triangles(t, 2)) - p;
    const Eigen::RowVector2d q = mesh.uvs.row(mesh.uv_triangles(t, 0));
    const Eigen::RowVector2d s = mesh.uvs.row(mesh.uv_triangles(t, 1)) - q,
                             r = mesh.uvs.row(mesh.uv_triangles(t, 2)) - q;
    const double turn = s.x() * r.y() - s.y() * r.x();
    frames.mirrored.push_back(turn < 0.0 ? -1.0 : 1.0);
    if (turn == 0.0) continue;
    // d position / d u, times twice the triangle's area in the layout: large triangles count more.
    const Eigen::RowVector3d along_u = std::copysign(1.0, turn) * (r.y() * a - s.y() * b);
    for (int k = 0; k < 3; ++k) frames.tangents.row(mesh.uv_triangles(t, k)) += along_u;
  }
  return frames;
}

template <typename Rows>
Eigen::Vector3d between(const Rows& rows, const Eigen::RowVector3i& corners, const Eigen::RowVector3d& weights) {
  return (weights * rows(corners, Eigen::all)).transpose();
}

Eigen::RowVector3d weightsOf(float b0, float b1) { return {double{b0}, double{b1}, 1.0 - double{b0} - double{b1}}; }

}  // namespace

DetailMaps bakeDetail(const raster::UvRaster& raster, const geometry::TriangleMesh& mesh,
                      const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& scan_triangles,
                      const geometry::ScanSurface& scan, Progress& progress) {
  const Eigen::MatrixX3d normals = geometry::vertexNormals(positions, mesh.triangles);
  const Eigen::MatrixX3d& scan_positions = scan.judged().positions;
  const Eigen::MatrixX3d scan_normals = geometry::vertexNormals(scan_positions, scan_triangles);
  const Frames frames = framesOf(mesh, positions);
  const std::size_t texels = toSize(raster.width(), raster.height());
  DetailMaps maps{raster.width(), std::vector<float>(3 * texels), std::vector<float>(texels)};
  std::vector<std::uint8_t> known(texels, 0);
  for (int begin = 0; begin < raster.height(); begin += kBandRows) {
    progress.checkCancelled();
    const int end = std::min(begin + kBandRows, raster.height());
    const std::vector<raster::TexelSample> samples = raster.rows(begin, end);
    const std::vector<SeenTexel> seen = seenTexels(raster, mesh.triangles, positions, scan, begin, end);
    const std::size_t first = toSize(begin, raster.width());
    tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t i) {
      if (seen[i].triangle < 0) return;
      const int t = samples[i].triangle;
      const Eigen::RowVector3d weights = weightsOf(samples[i].b0, samples[i].b1);
      const Eigen::RowVector3d scan_weights = weightsOf(seen[i].b0, seen[i].b1);
      const Eigen::RowVector3i corners = mesh.triangles.row(t), scan_corners = scan_triangles.row(seen[i].triangle);
      const Eigen::Vector3d z = between(normals, corners, weights).normalized();
      Eigen::Vector3d x = between(frames.tangents, mesh.uv_triangles.row(t), weights);
      x = (x - x.dot(z) * z).normalized();
      const Eigen::Vector3d y = frames.mirrored[toSize(t)] * z.cross(x);
      const Eigen::Vector3d n = between(scan_normals, scan_corners, scan_weights).normalized();
      const Eigen::Vector3d away =
          between(scan_positions, scan_corners, scan_weights) - between(positions, corners, weights);
      if (!x.allFinite() || !n.allFinite()) return;
      float* normal = &maps.normals[3 * (first + i)];
      normal[0] = static_cast<float>(n.dot(x));
      normal[1] = static_cast<float>(n.dot(y));
      normal[2] = static_cast<float>(n.dot(z));
      maps.heights[first + i] = static_cast<float>(away.dot(z));
      known[first + i] = 1;
    });
  }
  fillHoles(maps.normals, 3, maps.side, maps.side, known);
  fillHoles(maps.heights, 1, maps.side, maps.side, known);
  for (std::size_t i = 0; i < texels; ++i) {
    Eigen::Map<Eigen::Vector3f> normal(&maps.normals[3 * i]);
    normal = normal.norm() > 0.1f ? normal.normalized().eval() : Eigen::Vector3f(0.0f, 0.0f, 1.0f);
  }
  return maps;
}

}  // namespace facezip::registration
