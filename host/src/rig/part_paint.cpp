#include "rig/part_paint.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>

#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/part_transfer.hpp"
#include "raster/uv_raster.hpp"
#include "rig/part_looks.hpp"

namespace facezip::rig {
namespace {

constexpr int kGutter = 8;
constexpr double kMargin = 0.02;
/// A cornea, or an iris behind one, stands out of the ball by more than this share of its radius.
constexpr double kBulge = 1.03;

using Vertices = std::vector<Eigen::Index>;

/// A part as a mesh of its own, over the template's positions, in the unit square.
geometry::TriangleMesh sheetOf(const PartScene& scene, const geometry::TriangleMesh& mesh, const TemplateParts& parts,
                               int part, std::vector<Eigen::Index>& rows) {
  geometry::TriangleMesh sheet;
  sheet.positions = scene.positions;
  for (std::size_t i = 0; i < parts.of_triangle.size(); ++i) {
    if (parts.of_triangle[i] == part) rows.push_back(scene.skin_triangles + static_cast<Eigen::Index>(i));
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  sheet.triangles.resize(count, 3);
  sheet.uv_triangles.resize(count, 3);
  std::map<int, int> index;  // of the mesh's UVs, in the sheet
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Index row = rows[static_cast<std::size_t>(t)];
    sheet.triangles.row(t) = mesh.triangles.row(row);
    for (int c = 0; c < 3; ++c) {
      sheet.uv_triangles(t, c) = index.emplace(mesh.uv_triangles(row, c), static_cast<int>(index.size())).first->second;
    }
  }
  sheet.uvs.resize(static_cast<Eigen::Index>(index.size()), 2);
  for (const auto& [from, to] : index) sheet.uvs.row(to) = mesh.uvs.row(from);
  const Eigen::RowVector2d low = sheet.uvs.colwise().minCoeff(), high = sheet.uvs.colwise().maxCoeff();
  if (!((high - low).minCoeff() > 0.0)) return {};  // no layout: nothing can be painted
  sheet.uvs.rowwise() -= low;
  // A margin, since textures of parts repeat: roots of lashes would show beyond their tips.
  sheet.uvs.array().rowwise() *= (1.0 - 2.0 * kMargin) / (high - low).array();
  sheet.uvs.array() += kMargin;
  return sheet;
}

/// The part's vertices by their groups.
std::map<int, Vertices> verticesByGroup(const PartScene& scene, const geometry::TriangleMesh& sheet) {
  std::map<int, Vertices> groups;
  for (const auto& triangle : sheet.triangles.rowwise()) {
    for (const int v : triangle) {
      if (v >= scene.skin_vertices) {
        groups[scene.groups.of_vertex[static_cast<std::size_t>(v - scene.skin_vertices)]].push_back(v);
      }
    }
  }
  for (auto& [group, vertices] : groups) {
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }
  return groups;
}

struct Sphere {
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  double radius = 0.0;
};

/// The sphere of least squares: |p|^2 = 2 p c + (r^2 - |c|^2).
Sphere fitSphere(const Eigen::MatrixX3d& positions, const Vertices& vertices) {
  Eigen::Matrix4d products = 1e-12 * Eigen::Matrix4d::Identity();
  Eigen::Vector4d sums = Eigen::Vector4d::Zero();
  const Eigen::RowVector3d origin = positions.row(vertices.front());
  for (const Eigen::Index v : vertices) {
    Eigen::Vector4d row;
    row << 2.0 * (positions.row(v) - origin).transpose(), 1.0;
    products += row * row.transpose();
    sums += row * (positions.row(v) - origin).squaredNorm();
  }
  const Eigen::Vector4d solved = products.ldlt().solve(sums);
  const double square = solved[3] + solved.head<3>().squaredNorm();
  return {origin + solved.head<3>().transpose(), std::sqrt(std::max(square, 0.0))};
}

/// The eyeball's centre, and where it looks at rest.
struct EyeFrame {
  Eigen::RowVector3d centre, gaze, up, side;
};

/// From the ball to the skin around it: lids, brow and cheek lie before it.
Eigen::RowVector3d roughGaze(const PartScene& scene, const Sphere& ball) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (Eigen::Index v = 0; v < scene.skin_vertices; ++v) {
    const Eigen::RowVector3d offset = scene.positions.row(v) - ball.centre;
    if (offset.norm() < 2.0 * ball.radius) sum += offset;
  }
  return sum.norm() > 0.0 ? sum.normalized() : Eigen::RowVector3d(0, 0, 1);
}

EyeFrame frameOf(const PartScene& scene, const Vertices& vertices) {
  Sphere ball = fitSphere(scene.positions, vertices);
  EyeFrame frame;
  frame.gaze = roughGaze(scene, ball);
  // The back tells of the ball alone, the front of what stands out of it.
  Vertices back;
  std::ranges::copy_if(vertices, std::back_inserter(back),
                       [&](Eigen::Index v) { return (scene.positions.row(v) - ball.centre).dot(frame.gaze) < 0.0; });
  if (back.size() >= 16) ball = fitSphere(scene.positions, back);
  const auto distance = [&](Eigen::Index v) { return (scene.positions.row(v) - ball.centre).norm(); };
  double most = 0.0;
  for (const Eigen::Index v : vertices) most = std::max(most, distance(v));
  if (most > kBulge * ball.radius) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (const Eigen::Index v : vertices) {
      if (distance(v) > 0.5 * (ball.radius + most)) sum += scene.positions.row(v) - ball.centre;
    }
    if (sum.dot(frame.gaze) > 0.0) frame.gaze = sum.normalized();
  }
  frame.centre = ball.centre;
  frame.side = frame.gaze.unitOrthogonal();
  frame.up = frame.gaze.cross(frame.side);
  return frame;
}

/// A colour, 1 to 4 channels, for a point of group `group`.
using Shader = std::function<std::array<double, 4>(const Eigen::RowVector3d& point, int group, double distance)>;

Shader irisShader(const PartScene& scene, const std::map<int, Vertices>& groups, const Iris& iris) {
  std::map<int, EyeFrame> frames;
  for (const auto& [group, vertices] : groups) frames[group] = frameOf(scene, vertices);
  return [frames, iris](const Eigen::RowVector3d& point, int group, double) -> std::array<double, 4> {
    const EyeFrame& frame = frames.at(group);
    const Eigen::RowVector3d offset = point - frame.centre;
    const double along = offset.dot(frame.gaze), x = offset.dot(frame.side), y = offset.dot(frame.up);
    const auto [r, g, b] = eyeColour(iris, std::atan2(std::hypot(x, y), along), std::atan2(y, x));
    return {r, g, b, 255.0};
  };
}

/// White, and there where a hair is: many at the roots, fewer and thinner towards the tips.
Shader hairShader(const PartScene& scene, const std::map<int, Vertices>& groups, const Eigen::VectorXd& distances,
                  double hair) {
  struct Card {
    Eigen::RowVector3d middle, along;
    double roots = 0.0, tips = 0.0;
  };
  std::map<int, Card> cards;
  for (const auto& [group, vertices] : groups) {
    Card card;
    card.middle.setZero();
    card.roots = std::numeric_limits<double>::infinity();
    for (const Eigen::Index v : vertices) {
      card.middle += scene.positions.row(v) / static_cast<double>(vertices.size());
      card.roots = std::min(card.roots, distances[v - scene.skin_vertices]);
      card.tips = std::max(card.tips, distances[v - scene.skin_vertices]);
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Eigen::Index v : vertices) {
      const Eigen::RowVector3d offset = scene.positions.row(v) - card.middle;
      spread += offset.transpose() * offset;
    }
    card.along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2).transpose();
    cards[group] = card;
  }
  return [cards, hair](const Eigen::RowVector3d& point, int group, double distance) -> std::array<double, 4> {
    const Card& card = cards.at(group);
    const double length = std::max(card.tips - card.roots, 1e-9);
    const double t = std::clamp((distance - card.roots) / length, 0.0, 1.0);
    const double at = (point - card.middle).dot(card.along) / hair;
    const double strand = at - std::floor(at) - 0.5;
    const double which = std::floor(at);
    const double jitter = std::sin(12.9898 * which + 78.233 * group) * 43758.5453;
    const double random = jitter - std::floor(jitter);
    const double reach = 0.55 + 0.45 * random;  // of this one
    const double width = 0.30 * (1.0 - t / reach);
    const double inside = width - std::abs(strand + 0.3 * (random - 0.5));
    return {255.0, std::clamp(127.5 + 255.0 * 4.0 * inside, 0.0, 255.0), 0.0, 0.0};
  };
}

/// Dark along the lids.
Shader shadeShader(double depth) {
  return [depth](const Eigen::RowVector3d&, int, double distance) -> std::array<double, 4> {
    return {255.0, 255.0 * 0.7 * std::exp(-distance / depth), 0.0, 0.0};
  };
}

image::Image paint(const PartScene& scene, const geometry::TriangleMesh& sheet, int side, int channels,
                   const Eigen::VectorXd& distances, const Shader& shader) {
  std::vector<int> every(static_cast<std::size_t>(sheet.triangles.rows()));
  std::iota(every.begin(), every.end(), 0);
  const raster::UvRaster raster(sheet, every, side, side, kGutter);
  const std::vector<raster::TexelSample> samples = raster.rows(0, side);
  image::Image image;
  image.shape = {side, side, channels, SampleType::kUint8};
  image.samples.resize(samples.size() * static_cast<std::size_t>(channels));
  const auto distanceOf = [&](int v) { return v < scene.skin_vertices ? 0.0 : distances[v - scene.skin_vertices]; };
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    const raster::TexelSample& sample = samples[i];
    if (sample.triangle < 0) return;
    const double shares[] = {static_cast<double>(sample.b0), static_cast<double>(sample.b1),
                             1.0 - static_cast<double>(sample.b0) - static_cast<double>(sample.b1)};
    Eigen::RowVector3d point = Eigen::RowVector3d::Zero();
    double distance = 0.0;
    int group = -1;
    for (int c = 0; c < 3; ++c) {
      const int v = sheet.triangles(sample.triangle, c);
      point += shares[c] * scene.positions.row(v);
      distance += shares[c] * distanceOf(v);
      if (v >= scene.skin_vertices) group = scene.groups.of_vertex[static_cast<std::size_t>(v - scene.skin_vertices)];
    }
    const std::array<double, 4> colour = shader(point, group, distance);
    for (int c = 0; c < channels; ++c) {
      const double value = std::clamp(colour[static_cast<std::size_t>(c)], 0.0, 255.0);
      image.samples[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] =
          static_cast<std::byte>(std::lround(value));
    }
  });
  return image;
}

/// Puts the sheet's UVs into the mesh, behind its own.
void takeLayout(const geometry::TriangleMesh& sheet, const std::vector<Eigen::Index>& rows,
                geometry::TriangleMesh& mesh) {
  const auto first = static_cast<int>(mesh.uvs.rows());
  mesh.uvs.conservativeResize(mesh.uvs.rows() + sheet.uvs.rows(), 2);
  mesh.uvs.bottomRows(sheet.uvs.rows()) = sheet.uvs;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    mesh.uv_triangles.row(rows[t]) = sheet.uv_triangles.row(static_cast<Eigen::Index>(t)).array() + first;
  }
}

}  // namespace

void paintParts(const PartScene& scene, const Iris& iris, bool repaint, geometry::TriangleMesh& mesh,
                TemplateParts& parts) {
  const double diagonal = geometry::boundingDiagonal(scene.positions.topRows(scene.skin_vertices));
  Eigen::VectorXd distances;
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    TemplatePart& part = parts.parts[p];
    const PartPaint what = lookOf(part.material.name).paint;
    const bool wanted = part.texture.samples.empty() || (repaint && what == PartPaint::kIris);
    if (what == PartPaint::kNone || !wanted) continue;
    std::vector<Eigen::Index> rows;
    const geometry::TriangleMesh sheet = sheetOf(scene, mesh, parts, static_cast<int>(p), rows);
    if (sheet.triangles.rows() == 0) continue;
    if (distances.size() == 0) distances = geometry::distancesToSkin(scene.skin_vertices, scene.positions);
    const std::map<int, Vertices> groups = verticesByGroup(scene, sheet);
    switch (what) {
      case PartPaint::kIris:
        part.texture = paint(scene, sheet, 1024, 3, distances, irisShader(scene, groups, iris));
        part.material.colour = {1, 1, 1};
        break;
      case PartPaint::kHairs:  // about 0.4 mm apart
        part.texture = paint(scene, sheet, 1024, 2, distances, hairShader(scene, groups, distances, 0.0009 * diagonal));
        break;
      case PartPaint::kShade:  // a millimetre or so deep
        part.texture = paint(scene, sheet, 256, 2, distances, shadeShader(0.0025 * diagonal));
        break;
      case PartPaint::kNone:
        break;
    }
    takeLayout(sheet, rows, mesh);
  }
}

}  // namespace facezip::rig
