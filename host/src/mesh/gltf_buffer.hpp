// gltf_buffer.hpp - the accessors of a glTF model, whose bytes are all in its one buffer.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

// A system header: its own warnings are not ours.
#include <tiny_gltf.h>

namespace facezip::mesh {

/// Adds accessors to a model that has a buffer; every function returns the new accessor's index.
class GltfBuffer {
 public:
  explicit GltfBuffer(tinygltf::Model& model) : model_(model) {}

  /// values  count x components, 2 to 4 of them
  int addFloats(std::span<const float> values, int components, bool with_bounds);

  /// Vectors of three of which most are 0: only the others are stored. The format wants one at least.
  int addSparse(std::span<const float> values, bool with_bounds);

  int addIndices(std::span<const int> indices);

 private:
  static tinygltf::Accessor describe(std::span<const float> values, int components, bool with_bounds);
  int addView(std::span<const std::byte> bytes, int target);
  int push(tinygltf::Accessor accessor);

  tinygltf::Model& model_;
};

/// The floats of an accessor, sparse or not, element by element. Its ranges were checked or are our own.
std::vector<float> readFloats(const tinygltf::Model& model, int accessor);

/// Its whole numbers, of 8, 16 or 32 bits, likewise; not sparse.
std::vector<std::uint32_t> readIndices(const tinygltf::Model& model, int accessor);

}  // namespace facezip::mesh
