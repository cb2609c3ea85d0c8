#include "rig/skin_features.hpp"

#include <tbb/parallel_for.h>

#include <cmath>

#include "facezip/geometry/skin_strain.hpp"

namespace facezip::rig {
namespace {

// One-rings that strain is averaged over: a crease is as wide as a few edges, and a change of albedo or occlusion
// reaches a little beyond the skin that strains.
constexpr int kInfluenceRounds = 10;
constexpr int kStrainRounds = 6;
constexpr Eigen::Index kTensors = 12;

}  // namespace

SkinFeatures::SkinFeatures(const geometry::TriangleMesh& mesh, const std::vector<Eigen::MatrixX3d>& examples,
                           const geometry::ExampleRig& rig)
    : triangles_(mesh.triangles),
      examples_(static_cast<Eigen::Index>(examples.size())),
      shapes_(static_cast<Eigen::Index>(rig.shapes.size())),
      vertices_(mesh.positions.rows(), shapes_ + kTensors * (examples_ + shapes_)) {
  const geometry::SkinStrain strain(mesh.positions, mesh.triangles);
  tbb::parallel_for(Eigen::Index{0}, shapes_, [&](Eigen::Index m) {
    const auto index = static_cast<std::size_t>(m);
    vertices_.col(m) =
        strain.smoothed(strain.edgeChange(mesh.positions + rig.transferred[index]), kInfluenceRounds).cast<float>();
    vertices_.middleCols(shapes_ + kTensors * (examples_ + m), kTensors) =
        strain.tensors(mesh.positions + rig.shapes[index], kStrainRounds).cast<float>();
  });
  tbb::parallel_for(Eigen::Index{0}, examples_, [&](Eigen::Index n) {
    vertices_.middleCols(shapes_ + kTensors * n, kTensors) =
        strain.tensors(examples[static_cast<std::size_t>(n)], kStrainRounds).cast<float>();
  });
  const float most = vertices_.leftCols(shapes_).maxCoeff();
  if (most > 0.0f) vertices_.leftCols(shapes_) /= most;
  const auto of_examples = vertices_.middleCols(shapes_, kTensors * examples_);
  const double square = of_examples.cast<double>().squaredNorm() / static_cast<double>(vertices_.rows() * examples_);
  if (square > 0.0) vertices_.rightCols(kTensors * (examples_ + shapes_)) /= static_cast<float>(std::sqrt(square));
}

PointFeatures SkinFeatures::at(const raster::TexelSample& sample) const {
  const auto corner = [&](int c) { return vertices_.row(triangles_(sample.triangle, c)); };
  const Eigen::RowVectorXd row =
      (sample.b0 * corner(0) + sample.b1 * corner(1) + (1.0f - sample.b0 - sample.b1) * corner(2)).cast<double>();
  const auto tensors = [&](Eigen::Index first, Eigen::Index count) {
    return Eigen::MatrixXd(row.segment(first, kTensors * count).reshaped(kTensors, count).transpose());
  };
  return {row.head(shapes_).transpose(), tensors(shapes_, examples_), tensors(shapes_ + kTensors * examples_, shapes_)};
}

}  // namespace facezip::rig
