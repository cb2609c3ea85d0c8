// registration_picture.cpp - triangles to pixels by a depth buffer: some hundred thousand pixels, seen once.
#include "register/registration_picture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "facezip/geometry/mesh_edges.hpp"
#include "io/counts.hpp"

namespace facezip::registration {
namespace {

constexpr double kMargin = 0.04;    // of the picture, around the region
constexpr double kEdgeWidth = 0.8;  // pixels
constexpr double kEdgeDarkness = 0.6;
constexpr int kPixels = kPictureSide * kPictureSide;

/// The surface behind a pixel.
struct Hit {
  int triangle = -1;
  Eigen::RowVector3d weights = Eigen::RowVector3d::Zero();
  Eigen::RowVector3d edges = Eigen::RowVector3d::Zero();  ///< pixels to the side opposite each corner
};

using Corners = Eigen::Matrix<double, 3, 2>;

double crossOf(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Draws a triangle where it is nearer than what is there. corners  in pixels, y down
void draw(int triangle, const Corners& corners, const Eigen::RowVector3d& depths, std::vector<Hit>& hits,
          std::vector<double>& nearest) {
  const Eigen::RowVector2d a = corners.row(0), b = corners.row(1), c = corners.row(2);
  const double area = crossOf(b - a, c - a);
  if (area == 0.0) return;
  const auto pixel = [](double at) { return static_cast<int>(std::clamp(at, -1.0, double{kPictureSide})); };
  const int left = std::max(0, pixel(std::ceil(corners.col(0).minCoeff() - 0.5))),
            right = std::min(kPictureSide - 1, pixel(std::floor(corners.col(0).maxCoeff() - 0.5))),
            top = std::max(0, pixel(std::ceil(corners.col(1).minCoeff() - 0.5))),
            bottom = std::min(kPictureSide - 1, pixel(std::floor(corners.col(1).maxCoeff() - 0.5)));
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const Eigen::RowVector2d p(x + 0.5, y + 0.5);
      const Eigen::RowVector3d weights(crossOf(c - b, p - b) / area, crossOf(a - c, p - c) / area,
                                       crossOf(b - a, p - a) / area);
      const double depth = weights.dot(depths);
      const std::size_t at = toSize(y) * kPictureSide + toSize(x);
      if (weights.minCoeff() < 0.0 || depth <= nearest[at]) continue;
      nearest[at] = depth;
      const double size = std::abs(area);
      hits[at] = {
          triangle,
          weights,
          {weights[0] * size / (c - b).norm(), weights[1] * size / (a - c).norm(), weights[2] * size / (b - a).norm()}};
    }
  }
}

std::vector<Hit> hitsOf(const FrontView& view, const Eigen::MatrixX3i& triangles, const Eigen::MatrixX3d& positions) {
  std::vector<Hit> hits(kPixels);
  std::vector<double> nearest(kPixels, -std::numeric_limits<double>::infinity());
  Eigen::MatrixX2d places = (positions * view.axes.transpose()).rowwise() - view.corner;
  places.col(1) = kPictureSide - places.col(1).array();
  const Eigen::VectorXd depths = positions * view.towards.transpose();
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3i corners = triangles.row(t);
    draw(static_cast<int>(t), places(corners, Eigen::all), depths(corners).transpose(), hits, nearest);
  }
  return hits;
}

/// How dark an edge makes a pixel. Inside a face of the file that is a fan of triangles there are no edges.
double edgeOf(const geometry::TriangleMesh& layout, const Hit& hit) {
  const auto t = toSize(hit.triangle);
  const std::vector<int>& faces = layout.polygons;
  const bool behind = !faces.empty() && t > 0 && faces[t - 1] == faces[t],
             before = !faces.empty() && t + 1 < faces.size() && faces[t + 1] == faces[t];
  double nearest = hit.edges[0];
  if (!before) nearest = std::min(nearest, hit.edges[1]);
  if (!behind) nearest = std::min(nearest, hit.edges[2]);
  return kEdgeDarkness * std::clamp(1.0 - nearest / kEdgeWidth, 0.0, 1.0);
}

/// Black, purple, red, orange, pale yellow.
Eigen::RowVector3d falseColour(double share) {
  static const std::array<Eigen::RowVector3d, 5> kRamp = {
      Eigen::RowVector3d(0.0, 0.0, 0.02), Eigen::RowVector3d(0.34, 0.06, 0.43), Eigen::RowVector3d(0.74, 0.21, 0.33),
      Eigen::RowVector3d(0.97, 0.56, 0.04), Eigen::RowVector3d(0.99, 1.0, 0.64)};
  const double at = std::clamp(share, 0.0, 1.0) * (kRamp.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kRamp.size() - 2);
  const double f = at - static_cast<double>(i);
  return (1.0 - f) * kRamp[i] + f * kRamp[i + 1];
}

Eigen::RowVector3d textureAt(const geometry::TriangleMesh& layout, const BakedTexture& texture, const Hit& hit) {
  const Eigen::RowVector2d uv = hit.weights * layout.uvs(layout.uv_triangles.row(hit.triangle), Eigen::all);
  const auto texel = [&](double at) { return std::clamp(static_cast<int>(at * texture.side), 0, texture.side - 1); };
  const std::size_t first =
      (toSize(texel(1.0 - uv.y())) * toSize(texture.side) + toSize(texel(uv.x()))) * toSize(texture.channels);
  Eigen::RowVector3d colour;
  for (int c = 0; c < 3; ++c) colour[c] = double{texture.samples[first + toSize(texture.channels < 3 ? 0 : c)]};
  return colour;
}

}  // namespace

FrontView frontOf(const geometry::TriangleMesh& layout, const Eigen::MatrixX3d& positions,
                  const std::vector<int>& region) {
  FrontView view;
  view.towards = Eigen::RowVector3d::Zero();
  for (const int t : region) {
    const Eigen::RowVector3d a = positions.row(layout.triangles(t, 0));
    const Eigen::RowVector3d b = positions.row(layout.triangles(t, 1)), c = positions.row(layout.triangles(t, 2));
    view.towards += (b - a).cross(c - a);
  }
  view.towards.y() = 0.0;
  view.towards =
      view.towards.norm() > 0.0 ? Eigen::RowVector3d(view.towards.normalized()) : Eigen::RowVector3d(0, 0, 1);
  view.axes << Eigen::RowVector3d::UnitY().cross(view.towards), Eigen::RowVector3d::UnitY();
  Eigen::RowVector2d least = Eigen::RowVector2d::Constant(std::numeric_limits<double>::infinity()), most = -least;
  for (const int t : region) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector2d place = positions.row(layout.triangles(t, k)) * view.axes.transpose();
      least = least.cwiseMin(place);
      most = most.cwiseMax(place);
    }
  }
  const double scale = (1.0 - 2.0 * kMargin) * kPictureSide / std::max(1e-9, (most - least).maxCoeff());
  view.axes *= scale;
  view.corner = 0.5 * scale * (least + most) - Eigen::RowVector2d::Constant(0.5 * kPictureSide);
  return view;
}

image::Image pictureOf(const FrontView& view, const geometry::TriangleMesh& layout, const Eigen::MatrixX3d& positions,
                       const std::vector<float>& distances, const BakedTexture& texture) {
  constexpr double kBackground = 0.2, kUnknown = 0.45;
  const std::vector<Hit> hits = hitsOf(view, layout.triangles, positions);
  const Eigen::MatrixX3d normals = geometry::vertexNormals(positions, layout.triangles);
  image::Image picture{{3 * kPictureSide, kPictureSide, 3, image::SampleType::kUint8}, {}};
  picture.samples.resize(toSize(9) * kPixels);
  const auto put = [&](std::size_t pixel, int column, const Eigen::RowVector3d& colour) {
    const std::size_t x = pixel % kPictureSide + toSize(column) * kPictureSide, y = pixel / kPictureSide;
    for (int c = 0; c < 3; ++c) {
      picture.samples[3 * (y * 3 * kPictureSide + x) + toSize(c)] =
          static_cast<std::byte>(std::lround(255.0 * std::clamp(colour[c], 0.0, 1.0)));
    }
  };
  for (std::size_t i = 0; i < hits.size(); ++i) {
    std::array<Eigen::RowVector3d, 3> colours;
    colours.fill(Eigen::RowVector3d::Constant(kBackground));
    const Hit& hit = hits[i];
    if (hit.triangle >= 0) {
      const Eigen::RowVector3i corners = layout.triangles.row(hit.triangle);
      const Eigen::RowVector3d normal = hit.weights * normals(corners, Eigen::all);
      const double light = 0.25 + 0.7 * std::abs(normal.dot(view.towards)) / std::max(1e-9, normal.norm());
      double distance = 0.0;
      for (int k = 0; k < 3; ++k) distance += hit.weights[k] * double{distances[toSize(corners[k])]};
      colours[0].setConstant(light * (1.0 - edgeOf(layout, hit)));
      colours[1] = std::isnan(distance) ? Eigen::RowVector3d(Eigen::RowVector3d::Constant(kUnknown * light))
                                        : falseColour(distance / kBrightest);
      colours[2] = textureAt(layout, texture, hit);
    }
    for (int column = 0; column < 3; ++column) put(i, column, colours[toSize(column)]);
  }
  return picture;
}

}  // namespace facezip::registration
