#include "synth/head_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "synth/noise.hpp"

namespace facezip::synth {
namespace {

// 100 x 100 quads. Columns are dense over mouth and eyes and grow towards the ears; the corners of mouth and eyes
// fall on columns, the slits on rows.
constexpr int kQuads = 100;
constexpr int kMiddleColumn = kQuads / 2;
constexpr int kInnerEyeColumn = 9;
constexpr int kMouthColumn = 13;
constexpr int kOuterEyeColumn = 24;
constexpr int kMouthRow = 30;
constexpr int kEyeRow = 66;

struct Slit {
  int row;
  int first_column;  ///< of the slit's corners
  int last_column;
  double centre_s, half_width, t;
  double upper_height, lower_height;        ///< on the skin, neutral
  double upper_height_uv, lower_height_uv;  ///< in the layout: lips need a hole of some texels even when they touch
  double reach;                             ///< how far above and below the slit the skin gives way
};

std::array<Slit, kHoleCount> makeSlits(const Landmarks& marks) {
  const Slit mouth{kMouthRow,
                   kMiddleColumn - kMouthColumn,
                   kMiddleColumn + kMouthColumn,
                   0.0,
                   marks.mouth_half_width,
                   0.0,
                   0.0005,
                   0.0005,
                   0.0028,
                   0.0028,
                   0.016};
  const Slit left{kEyeRow,
                  kMiddleColumn + kInnerEyeColumn,
                  kMiddleColumn + kOuterEyeColumn,
                  marks.eye_s,
                  marks.eye_half_width,
                  marks.eye_t,
                  marks.upper_lid_height,
                  marks.lower_lid_height,
                  marks.upper_lid_height,
                  marks.lower_lid_height,
                  0.0160};
  Slit right = left;
  right.first_column = kMiddleColumn - kOuterEyeColumn;
  right.last_column = kMiddleColumn - kInnerEyeColumn;
  right.centre_s = -left.centre_s;
  return {mouth, left, right};
}

/// Distance from the midline of column `column` >= 0, before the outline is rounded.
double columnDistance(int column, const Landmarks& marks) {
  const double inner = marks.eye_s - marks.eye_half_width;
  const double outer = marks.eye_s + marks.eye_half_width;
  if (column <= kInnerEyeColumn) return inner * column / kInnerEyeColumn;
  if (column <= kMouthColumn)
    return mix(inner, marks.mouth_half_width, (column - kInnerEyeColumn) / double(kMouthColumn - kInnerEyeColumn));
  if (column <= kOuterEyeColumn)
    return mix(marks.mouth_half_width, outer, (column - kMouthColumn) / double(kOuterEyeColumn - kMouthColumn));
  const double step = (outer - marks.mouth_half_width) / (kOuterEyeColumn - kMouthColumn);
  const double n = column - kOuterEyeColumn;
  const double last = kMiddleColumn - kOuterEyeColumn;
  return outer + step * n + (HeadShape::halfWidth(0.025) - outer - step * last) * (n / last) * (n / last);
}

/// Growing steps away from a slit row: `n` of `count` rows over `length`, the first of height `step`.
double growingRows(double n, double count, double length, double step) {
  return step * n + (length - step * count) * (n / count) * (n / count);
}

double rowHeight(int row, const Landmarks& marks) {
  const double step = marks.eye_t / (kEyeRow - kMouthRow);
  if (row < kMouthRow) return -growingRows(kMouthRow - row, kMouthRow, -marks.bottom, step);
  if (row <= kEyeRow) return step * (row - kMouthRow);
  return marks.eye_t + growingRows(row - kEyeRow, kQuads - kEyeRow, marks.top - marks.eye_t, step);
}

double columnS(int column, double t, const Landmarks& marks) {
  const int offset = column - kMiddleColumn;
  const double distance = columnDistance(std::abs(offset), marks);
  const double outer = marks.eye_s + marks.eye_half_width;
  const double edge = HeadShape::halfWidth(0.025);
  // Only the part beside the eyes follows the rounded outline: the columns through mouth and eyes stay straight.
  const double f = std::max(0.0, (distance - outer) / (edge - outer));
  return std::copysign(distance - f * f * (edge - HeadShape::halfWidth(t)), offset);
}

/// How much of an opening arrives at a skin point, 0..1; 1 at the middle of the slit, 0 at its corners.
double openingProfile(const Slit& slit, double s, double t) {
  const double x = (s - slit.centre_s) / slit.half_width;
  if (std::abs(x) >= 1.0) return 0.0;
  return (1.0 - x * x) * smoothStep(slit.reach, 0.0, std::abs(t - slit.t));
}

double lowerLip(const GridVertex& vertex, const Landmarks& marks, bool on_slit) {
  const double side = std::abs(vertex.s) / marks.mouth_half_width;
  const double blend = mix(0.003, 0.034, smoothStep(0.6, 1.7, side));
  const double apart = on_slit && side < 1.0 ? blend * (1.0 - std::pow(side, 4)) : 0.0;
  return smoothStep(blend, -blend, vertex.t + vertex.side[kMouth] * apart);
}

/// Index of the grid's vertices; those on a slit exist twice.
class GridIndex {
 public:
  GridIndex(const std::array<Slit, kHoleCount>& slits, const Landmarks& marks, std::vector<GridVertex>& grid)
      : slits_(slits) {
    for (int row = 0; row <= kQuads; ++row) {
      for (int column = 0; column <= kQuads; ++column) {
        const double t = rowHeight(row, marks);
        GridVertex vertex{columnS(column, t, marks), t, {}, 0.0};
        for (std::size_t h = 0; h < kHoleCount; ++h) vertex.side[h] = row > slits[h].row ? 1 : -1;
        vertex.lower_lip = lowerLip(vertex, marks, row == kMouthRow);
        below_.push_back(static_cast<int>(grid.size()));
        grid.push_back(vertex);
        above_.push_back(below_.back());
        for (std::size_t h = 0; h < kHoleCount; ++h) {
          if (!isOnSlit(slits[h], column, row)) continue;
          vertex.side[h] = 1;
          vertex.lower_lip = lowerLip(vertex, marks, row == kMouthRow);
          above_.back() = static_cast<int>(grid.size());
          grid.push_back(vertex);
        }
      }
    }
  }

  /// The vertex at (column, row) as a quad above (its bottom edge) or below (its top edge) sees it.
  int seenFromAbove(int column, int row) const { return above_[static_cast<std::size_t>(row * (kQuads + 1) + column)]; }
  int seenFromBelow(int column, int row) const { return below_[static_cast<std::size_t>(row * (kQuads + 1) + column)]; }

 private:
  static bool isOnSlit(const Slit& slit, int column, int row) {
    return row == slit.row && column > slit.first_column && column < slit.last_column;
  }

  std::array<Slit, kHoleCount> slits_;
  std::vector<int> above_;
  std::vector<int> below_;
};

Eigen::MatrixX3i makeTriangles(const GridIndex& index) {
  Eigen::MatrixX3i triangles(2 * kQuads * kQuads, 3);
  Eigen::Index next = 0;
  for (int row = 0; row < kQuads; ++row) {
    for (int column = 0; column < kQuads; ++column) {
      const int a = index.seenFromAbove(column, row);
      const int b = index.seenFromAbove(column + 1, row);
      const int c = index.seenFromBelow(column + 1, row + 1);
      const int d = index.seenFromBelow(column, row + 1);
      // Diagonals mirror at the midline, as the face does.
      if (column < kMiddleColumn) {
        triangles.row(next++) << a, b, c;
        triangles.row(next++) << a, c, d;
      } else {
        triangles.row(next++) << a, b, d;
        triangles.row(next++) << b, c, d;
      }
    }
  }
  return triangles;
}

std::vector<std::vector<int>> makeRings(const Eigen::MatrixX3i& triangles, std::size_t vertex_count) {
  std::vector<std::vector<int>> rings(vertex_count);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      rings[static_cast<std::size_t>(triangles(f, k))].push_back(triangles(f, (k + 1) % 3));
      rings[static_cast<std::size_t>(triangles(f, k))].push_back(triangles(f, (k + 2) % 3));
    }
  }
  for (std::vector<int>& ring : rings) {
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  }
  return rings;
}

Eigen::RowVector2d uvOf(const GridVertex& vertex, const std::array<Slit, kHoleCount>& slits, const Landmarks& marks) {
  double t = vertex.t;
  for (std::size_t h = 0; h < kHoleCount; ++h) {
    const double height = vertex.side[h] > 0 ? slits[h].upper_height_uv : -slits[h].lower_height_uv;
    t += height * openingProfile(slits[h], vertex.s, vertex.t);
  }
  const double middle = 0.5 * (marks.bottom + marks.top);
  return {0.5 + vertex.s / HeadMesh::kUvExtent, 0.5 + (t - middle) / HeadMesh::kUvExtent};
}

}  // namespace

HeadMesh::HeadMesh(const HeadShape& shape) {
  const Landmarks& marks = shape.landmarks();
  const std::array<Slit, kHoleCount> slits = makeSlits(marks);
  const GridIndex index(slits, marks, grid);
  mesh.triangles = makeTriangles(index);
  mesh.uv_triangles = mesh.triangles;
  const auto count = static_cast<Eigen::Index>(grid.size());
  mesh.positions.resize(count, 3);
  mesh.uvs.resize(count, 2);
  for (Eigen::Index v = 0; v < count; ++v) {
    const auto i = static_cast<std::size_t>(v);
    skin.push_back(skinPoint(i, Openings{}));
    mesh.positions.row(v) = shape.position(skin.back());
    mesh.uvs.row(v) = uvOf(grid[i], slits, marks);
  }
  rings = makeRings(mesh.triangles, grid.size());
}

SkinPoint HeadMesh::skinPoint(std::size_t index, const Openings& openings) const {
  // Landmarks are the same for every head, and so are the slits.
  static const std::array<Slit, kHoleCount> slits = makeSlits(Landmarks{});
  const GridVertex& vertex = grid[index];
  double t = vertex.t;
  for (std::size_t h = 0; h < kHoleCount; ++h) {
    double upper = openings[h].upper * slits[h].upper_height;
    double lower = openings[h].lower * slits[h].lower_height;
    // Lids that several actions close meet half-way; they do not pass each other.
    constexpr double kContact = 0.0003;
    const double overlap = std::max(0.0, kContact - upper - lower);
    upper += 0.5 * overlap;
    lower += 0.5 * overlap;
    t += (vertex.side[h] > 0 ? upper : -lower) * openingProfile(slits[h], vertex.s, vertex.t);
  }
  return {vertex.s, t};
}

}  // namespace facezip::synth
