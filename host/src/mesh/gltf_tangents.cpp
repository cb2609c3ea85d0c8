#include "mesh/gltf_tangents.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/gltf_buffer.hpp"

namespace facezip::mesh {
namespace {

using Vectors = Eigen::Matrix<float, 3, Eigen::Dynamic>;

Vectors readVectors(const tinygltf::Model& model, int accessor) {
  const std::vector<float> values = readFloats(model, accessor);
  return Eigen::Map<const Vectors>(values.data(), 3, static_cast<Eigen::Index>(values.size() / 3));
}

/// Directions of u and of falling v (up in the texture) at every vertex, sums over the triangles around it.
struct Directions {
  Eigen::Matrix3Xd across, up;
};

Directions directionsOf(const Vectors& positions, const std::vector<float>& uvs,
                        std::span<const std::uint32_t> indices) {
  Directions sums{Eigen::Matrix3Xd::Zero(3, positions.cols()), Eigen::Matrix3Xd::Zero(3, positions.cols())};
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    Eigen::Vector3d p[3];
    Eigen::Vector2d uv[3];
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = positions.col(indices[t + c]).cast<double>();
      uv[c] = {static_cast<double>(uvs[2 * indices[t + c]]), -static_cast<double>(uvs[2 * indices[t + c] + 1])};
    }
    const Eigen::Vector3d e1 = p[1] - p[0], e2 = p[2] - p[0];
    const Eigen::Vector2d d1 = uv[1] - uv[0], d2 = uv[2] - uv[0];
    const double area = d1[0] * d2[1] - d2[0] * d1[1];
    if (area == 0.0) continue;
    const Eigen::Vector3d across = ((e1 * d2[1] - e2 * d1[1]) / area).stableNormalized();
    const Eigen::Vector3d up = ((e2 * d1[0] - e1 * d2[0]) / area).stableNormalized();
    for (std::size_t c = 0; c < 3; ++c) {
      const Eigen::Vector3d a = (p[(c + 1) % 3] - p[c]).stableNormalized(),
                            b = (p[(c + 2) % 3] - p[c]).stableNormalized();
      const double angle = std::acos(std::clamp(a.dot(b), -1.0, 1.0));
      sums.across.col(indices[t + c]) += angle * across;
      sums.up.col(indices[t + c]) += angle * up;
    }
  }
  return sums;
}

/// Tangents with their side, 4 x #V.
Eigen::Matrix4Xf tangentsOf(const Vectors& positions, const Vectors& normals, const std::vector<float>& uvs,
                            std::span<const std::uint32_t> indices) {
  const Directions sums = directionsOf(positions, uvs, indices);
  Eigen::Matrix4Xf tangents(4, positions.cols());
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    const Eigen::Vector3d normal = normals.col(v).cast<double>().stableNormalized();
    Eigen::Vector3d tangent = sums.across.col(v) - normal.dot(sums.across.col(v)) * normal;
    // Any will do where UVs say nothing.
    if (!(tangent.norm() > 1e-6 * sums.across.col(v).norm())) tangent = normal.unitOrthogonal();
    tangent.normalize();
    const double side = normal.cross(tangent).dot(sums.up.col(v)) < 0.0 ? -1.0 : 1.0;
    tangents.col(v) << tangent.cast<float>(), static_cast<float>(side);
  }
  return tangents;
}

void addTangents(tinygltf::Primitive& primitive, tinygltf::Model& model) {
  std::map<std::string, int>& attributes = primitive.attributes;
  if (attributes.contains("TANGENT") || !attributes.contains("NORMAL") || !attributes.contains("TEXCOORD_0")) return;
  const std::vector<std::uint32_t> indices = readIndices(model, primitive.indices);
  const std::vector<float> uvs = readFloats(model, attributes.at("TEXCOORD_0"));
  const Vectors positions = readVectors(model, attributes.at("POSITION"));
  const Vectors normals = readVectors(model, attributes.at("NORMAL"));
  const Eigen::Matrix4Xf tangents = tangentsOf(positions, normals, uvs, indices);
  GltfBuffer buffer(model);
  attributes["TANGENT"] = buffer.addFloats({tangents.data(), static_cast<std::size_t>(tangents.size())}, 4, false);
  for (std::map<std::string, int>& target : primitive.targets) {
    if (!target.contains("NORMAL") || target.contains("TANGENT")) continue;
    const Vectors moved = positions + readVectors(model, target.at("POSITION"));
    const Vectors turned = normals + readVectors(model, target.at("NORMAL"));
    const Vectors change = tangentsOf(moved, turned, uvs, indices).topRows<3>() - tangents.topRows<3>();
    target["TANGENT"] = buffer.addSparse({change.data(), static_cast<std::size_t>(change.size())}, false);
  }
}

}  // namespace

void addTangents(tinygltf::Model& model) {
  for (tinygltf::Primitive& primitive : model.meshes.at(0).primitives) addTangents(primitive, model);
}

}  // namespace facezip::mesh
