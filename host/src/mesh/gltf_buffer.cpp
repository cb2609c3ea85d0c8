#include "mesh/gltf_buffer.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <utility>

namespace facezip::mesh {
namespace {

/// Where the elements of a view begin, and how far one is from the next.
struct Elements {
  const unsigned char* first = nullptr;
  std::size_t stride = 0;
};

Elements elementsOf(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t element_bytes) {
  const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(view_index));
  const std::vector<unsigned char>& data = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
  return {data.data() + view.byteOffset + offset, view.byteStride > 0 ? view.byteStride : element_bytes};
}

std::uint32_t indexAt(const unsigned char* at, int component_type) {
  std::uint16_t two = 0;
  std::uint32_t four = 0;
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return *at;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      std::memcpy(&two, at, sizeof(two));
      return two;
    default:
      std::memcpy(&four, at, sizeof(four));
      return four;
  }
}

std::size_t indexBytes(int component_type) {
  return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type)));
}

}  // namespace

int GltfBuffer::addFloats(std::span<const float> values, int components, bool with_bounds) {
  tinygltf::Accessor accessor = describe(values, components, with_bounds);
  accessor.bufferView = addView(std::as_bytes(values), TINYGLTF_TARGET_ARRAY_BUFFER);
  return push(std::move(accessor));
}

int GltfBuffer::addSparse(std::span<const float> values, bool with_bounds) {
  std::vector<std::uint32_t> indices;
  std::vector<float> kept;
  for (std::size_t v = 0; v < values.size() / 3; ++v) {
    const std::span<const float> vector = values.subspan(3 * v, 3);
    if (std::ranges::all_of(vector, [](float x) { return x == 0.0f; })) continue;
    indices.push_back(static_cast<std::uint32_t>(v));
    kept.insert(kept.end(), vector.begin(), vector.end());
  }
  if (2 * kept.size() >= values.size()) return addFloats(values, 3, with_bounds);
  if (indices.empty()) {
    indices.push_back(0);
    kept.assign(3, 0.0f);
  }
  tinygltf::Accessor accessor = describe(values, 3, with_bounds);
  accessor.sparse.isSparse = true;
  accessor.sparse.count = static_cast<int>(indices.size());
  // tinygltf leaves these as they were in memory, and writes them.
  accessor.sparse.indices.byteOffset = 0;
  accessor.sparse.values.byteOffset = 0;
  accessor.sparse.indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  accessor.sparse.indices.bufferView = addView(std::as_bytes(std::span(indices)), 0);
  accessor.sparse.values.bufferView = addView(std::as_bytes(std::span(kept)), 0);
  return push(std::move(accessor));
}

int GltfBuffer::addIndices(std::span<const int> indices) {
  tinygltf::Accessor accessor;
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  accessor.type = TINYGLTF_TYPE_SCALAR;
  accessor.count = indices.size();
  accessor.bufferView = addView(std::as_bytes(indices), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  return push(std::move(accessor));
}

tinygltf::Accessor GltfBuffer::describe(std::span<const float> values, int components, bool with_bounds) {
  tinygltf::Accessor accessor;
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
  accessor.type = components;  // TINYGLTF_TYPE_VEC2 is 2, and so on
  accessor.count = values.size() / static_cast<std::size_t>(components);
  if (!with_bounds) return accessor;
  const std::size_t stride = static_cast<std::size_t>(components);
  for (std::size_t c = 0; c < stride; ++c) {
    float least = std::numeric_limits<float>::infinity();
    float most = -least;
    for (std::size_t i = c; i < values.size(); i += stride) {
      least = std::min(least, values[i]);
      most = std::max(most, values[i]);
    }
    accessor.minValues.push_back(static_cast<double>(least));
    accessor.maxValues.push_back(static_cast<double>(most));
  }
  return accessor;
}

int GltfBuffer::addView(std::span<const std::byte> bytes, int target) {
  std::vector<unsigned char>& data = model_.buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  data.resize((data.size() + 3) / 4 * 4);  // elements are of 4 bytes; what others left may end anywhere
  view.byteOffset = data.size();
  view.byteLength = bytes.size();
  view.target = target;
  const auto* begin = reinterpret_cast<const unsigned char*>(bytes.data());
  data.insert(data.end(), begin, begin + bytes.size());
  model_.bufferViews.push_back(std::move(view));
  return static_cast<int>(model_.bufferViews.size()) - 1;
}

int GltfBuffer::push(tinygltf::Accessor accessor) {
  model_.accessors.push_back(std::move(accessor));
  return static_cast<int>(model_.accessors.size()) - 1;
}

std::vector<float> readFloats(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
  const auto components = static_cast<std::size_t>(accessor.type);
  const std::size_t bytes = components * sizeof(float);
  std::vector<float> values(accessor.count * components, 0.0f);
  if (accessor.bufferView >= 0) {
    const Elements from = elementsOf(model, accessor.bufferView, accessor.byteOffset, bytes);
    for (std::size_t i = 0; i < accessor.count; ++i) {
      std::memcpy(values.data() + i * components, from.first + i * from.stride, bytes);
    }
  }
  if (!accessor.sparse.isSparse) return values;
  const auto& sparse = accessor.sparse;
  const std::size_t index_bytes = indexBytes(sparse.indices.componentType);
  const Elements where =
      elementsOf(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), index_bytes);
  const Elements what =
      elementsOf(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), bytes);
  for (std::size_t i = 0; i < static_cast<std::size_t>(sparse.count); ++i) {
    const std::size_t vertex = indexAt(where.first + i * index_bytes, sparse.indices.componentType);
    std::memcpy(values.data() + vertex * components, what.first + i * bytes, bytes);
  }
  return values;
}

std::vector<std::uint32_t> readIndices(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
  const Elements from = elementsOf(model, accessor.bufferView, accessor.byteOffset, indexBytes(accessor.componentType));
  std::vector<std::uint32_t> values;
  values.reserve(accessor.count);
  for (std::size_t i = 0; i < accessor.count; ++i) {
    values.push_back(indexAt(from.first + i * from.stride, accessor.componentType));
  }
  return values;
}

}  // namespace facezip::mesh
