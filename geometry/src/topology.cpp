#include "facezip/geometry/topology.hpp"

#include <fmt/format.h>

#include <numeric>
#include <optional>
#include <vector>

#include "facezip/error.hpp"

namespace facezip::geometry {
namespace {

// OBJ files hold 4 to 6 decimals, cut or rounded, and exporters flip v (v = 1 - v') in single precision.
constexpr double kUvTolerance = 1.1e-4;
constexpr const char* kSameTopology = "export every expression with the vertex and face order of the neutral";

void requireSameCount(const char* what, Eigen::Index expected, Eigen::Index got, const std::string& neutral_file,
                      const std::string& file) {
  if (expected == got) return;
  throw InputError({file, fmt::format("number of {}", what), fmt::format("{} as in {}", expected, neutral_file),
                    std::to_string(got), kSameTopology});
}

// The triangles [begin, end) of one face of a file, and its corners: a fan's second triangle adds the fourth.
struct Polygon {
  Eigen::Index begin = 0;
  Eigen::Index end = 0;

  Eigen::Index corners() const { return end - begin + 2; }
  int corner(const Eigen::MatrixX3i& triangles, Eigen::Index c) const {
    return c < 2 ? triangles(begin, c) : triangles(begin + c - 2, 2);
  }
};

// The face that begins with a triangle. Where the meshes do not tell faces, or tell other ones, that triangle alone.
Polygon polygonAt(Eigen::Index begin, const TriangleMesh& a, const TriangleMesh& b) {
  Eigen::Index end = begin + 1;
  const auto goes_on = [&](const TriangleMesh& mesh) {
    const auto at = static_cast<std::size_t>(end);
    return mesh.polygons.size() > at && mesh.polygons[at] == mesh.polygons[at - 1];
  };
  while (goes_on(a) && goes_on(b)) ++end;
  return goes_on(a) == goes_on(b) ? Polygon{begin, end} : Polygon{begin, begin + 1};
}

// Compares an expression with the neutral, face by face. A face may begin at any of its corners, and texture
// coordinates are compared where they are used: exporters list them in another order, or more than once.
class TopologyCheck {
 public:
  TopologyCheck(const TriangleMesh& neutral, const std::string& neutral_file, const TriangleMesh& expression,
                const std::string& file)
      : neutral_(neutral), neutral_file_(neutral_file), expression_(expression), file_(file) {}

  void requireSame(const Polygon& face) const {
    std::optional<Eigen::Index> turned;  // by so many corners the vertices are the same
    for (Eigen::Index turn = 0; turn < face.corners(); ++turn) {
      if (!sameVertices(face, turn)) continue;
      if (!firstOtherUv(face, turn)) return;
      turned = turned.value_or(turn);
    }
    if (turned) refuseUv(face, *turned);
    throw InputError({file_, fmt::format("triangle {} (counted from 0)", face.begin),
                      fmt::format("{} as in {}", text(neutral_, face), neutral_file_), text(expression_, face),
                      kSameTopology});
  }

 private:
  static std::string text(const TriangleMesh& mesh, const Polygon& face) {
    std::string vertices;
    for (Eigen::Index c = 0; c < face.corners(); ++c) {
      vertices += fmt::format("{}{}", c == 0 ? "" : " ", face.corner(mesh.triangles, c) + 1);
    }
    return vertices;
  }

  static Eigen::Index turnedCorner(const Polygon& face, Eigen::Index corner, Eigen::Index turn) {
    return (corner + turn) % face.corners();
  }

  bool sameVertices(const Polygon& face, Eigen::Index turn) const {
    for (Eigen::Index c = 0; c < face.corners(); ++c) {
      const int vertex = face.corner(expression_.triangles, turnedCorner(face, c, turn));
      if (vertex != face.corner(neutral_.triangles, c)) return false;
    }
    return true;
  }

  // The corner whose texture coordinates differ; none where the expression has no UVs.
  std::optional<Eigen::Index> firstOtherUv(const Polygon& face, Eigen::Index turn) const {
    if (expression_.uv_triangles.rows() == 0 || neutral_.uv_triangles.rows() == 0) return std::nullopt;
    for (Eigen::Index c = 0; c < face.corners(); ++c) {
      const auto expected = neutral_.uvs.row(face.corner(neutral_.uv_triangles, c));
      const auto got = expression_.uvs.row(face.corner(expression_.uv_triangles, turnedCorner(face, c, turn)));
      if (!((expected - got).array().abs() <= kUvTolerance).all()) return c;  // NaN is not
    }
    return std::nullopt;
  }

  [[noreturn]] void refuseUv(const Polygon& face, Eigen::Index turn) const {
    const Eigen::Index corner = *firstOtherUv(face, turn);
    const int got = face.corner(expression_.uv_triangles, turnedCorner(face, corner, turn));
    const int expected = face.corner(neutral_.uv_triangles, corner);
    throw InputError(
        {file_, fmt::format("texture coordinate {} (vertex {})", got + 1, face.corner(neutral_.triangles, corner) + 1),
         fmt::format("({}, {}) as in {}", neutral_.uvs(expected, 0), neutral_.uvs(expected, 1), neutral_file_),
         fmt::format("({}, {})", expression_.uvs(got, 0), expression_.uvs(got, 1)),
         "give every expression the UVs of the neutral, or none"});
  }

  const TriangleMesh& neutral_;
  const std::string& neutral_file_;
  const TriangleMesh& expression_;
  const std::string& file_;
};

}  // namespace

void requireSameTopology(const TriangleMesh& neutral, const std::string& neutral_file, const TriangleMesh& expression,
                         const std::string& expression_file) {
  requireSameCount("vertices", neutral.positions.rows(), expression.positions.rows(), neutral_file, expression_file);
  requireSameCount("triangles", neutral.triangles.rows(), expression.triangles.rows(), neutral_file, expression_file);
  const TopologyCheck check(neutral, neutral_file, expression, expression_file);
  for (Eigen::Index t = 0; t < neutral.triangles.rows();) {
    const Polygon face = polygonAt(t, neutral, expression);
    check.requireSame(face);
    t = face.end;
  }
}

void requireUvs(const TriangleMesh& mesh, const std::string& file, std::span<const int> triangles) {
  if (mesh.uv_triangles.rows() == 0) {
    throw InputError({file, "", "a mesh with texture coordinates (vt)", "none", "unwrap the mesh or export its UVs"});
  }
  for (const int t : triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const int i = mesh.uv_triangles(t, corner);
      const double u = mesh.uvs(i, 0);
      const double v = mesh.uvs(i, 1);
      const auto inside = [](double x) { return x >= -kUvTolerance && x <= 1 + kUvTolerance; };
      if (inside(u) && inside(v)) continue;  // NaN is not inside
      throw InputError({file, fmt::format("texture coordinate {} (vertex {})", i + 1, mesh.triangles(t, corner) + 1),
                        "u and v from 0 to 1", fmt::format("({}, {})", u, v),
                        "move the UVs into one tile, or leave those triangles out of the face region"});
    }
  }
}

void requireUvs(const TriangleMesh& mesh, const std::string& file) {
  std::vector<int> all(static_cast<std::size_t>(mesh.triangles.rows()));
  std::iota(all.begin(), all.end(), 0);
  requireUvs(mesh, file, all);
}

}  // namespace facezip::geometry
