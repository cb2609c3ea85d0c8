#include "facezip/geometry/topology.hpp"

#include <fmt/format.h>

#include <numeric>
#include <vector>

#include "facezip/error.hpp"

namespace facezip::geometry {
namespace {

// OBJ files hold 4 to 6 decimals, and exporters flip v (v = 1 - v') in single precision.
constexpr double kUvTolerance = 1e-5;
constexpr const char* kSameTopology = "export every expression with the vertex and face order of the neutral";

void requireSameCount(const char* what, Eigen::Index expected, Eigen::Index got, const std::string& neutral_file,
                      const std::string& file) {
  if (expected == got) return;
  throw InputError({file, fmt::format("number of {}", what), fmt::format("{} as in {}", expected, neutral_file),
                    std::to_string(got), kSameTopology});
}

void requireSameTriangles(const char* what, const Eigen::MatrixX3i& expected, const Eigen::MatrixX3i& got,
                          const std::string& neutral_file, const std::string& file) {
  for (Eigen::Index t = 0; t < expected.rows(); ++t) {
    if (expected.row(t) == got.row(t)) continue;
    const auto text = [t](const Eigen::MatrixX3i& rows) {
      return fmt::format("{} {} {}", rows(t, 0) + 1, rows(t, 1) + 1, rows(t, 2) + 1);
    };
    throw InputError({file, fmt::format("{} {} (counted from 0)", what, t),
                      fmt::format("{} as in {}", text(expected), neutral_file), text(got), kSameTopology});
  }
}

void requireSameUvs(const TriangleMesh& neutral, const std::string& neutral_file, const TriangleMesh& expression,
                    const std::string& file) {
  requireSameCount("texture coordinates", neutral.uvs.rows(), expression.uvs.rows(), neutral_file, file);
  requireSameTriangles("UV triangle", neutral.uv_triangles, expression.uv_triangles, neutral_file, file);
  for (Eigen::Index i = 0; i < neutral.uvs.rows(); ++i) {
    if (((neutral.uvs.row(i) - expression.uvs.row(i)).array().abs() <= kUvTolerance).all()) continue;  // NaN is not
    throw InputError({file, fmt::format("texture coordinate {}", i + 1),
                      fmt::format("({}, {}) as in {}", neutral.uvs(i, 0), neutral.uvs(i, 1), neutral_file),
                      fmt::format("({}, {})", expression.uvs(i, 0), expression.uvs(i, 1)),
                      "give every expression the UVs of the neutral, or none"});
  }
}

}  // namespace

void requireSameTopology(const TriangleMesh& neutral, const std::string& neutral_file, const TriangleMesh& expression,
                         const std::string& expression_file) {
  requireSameCount("vertices", neutral.positions.rows(), expression.positions.rows(), neutral_file, expression_file);
  requireSameCount("triangles", neutral.triangles.rows(), expression.triangles.rows(), neutral_file, expression_file);
  requireSameTriangles("triangle", neutral.triangles, expression.triangles, neutral_file, expression_file);
  if (expression.uv_triangles.rows() > 0) requireSameUvs(neutral, neutral_file, expression, expression_file);
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
