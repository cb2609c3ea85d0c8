#include "scene/gltf_accessors.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "io/counts.hpp"
#include "io/quoted.hpp"

namespace facezip::scene {
namespace {
using io::JsonField;
using nlohmann::json;
using Bytes = std::span<const std::byte>;

static_assert(std::endian::native == std::endian::little, "numbers of glTF are read as they stand");

constexpr int kLargest = std::numeric_limits<int>::max();
constexpr std::size_t kMostViews = std::size_t{1} << 18;
constexpr std::size_t kMostAccessors = std::size_t{1} << 17;
constexpr int kLargestStride = 252;  // of glTF
constexpr int kByte = 5120, kShort = 5122;

int most(std::size_t bytes) { return static_cast<int>(std::min(bytes, toSize(kLargest))); }

std::size_t bytesOf(int component_type) {
  return component_type == kUnsignedByte ? 1 : component_type == kUnsignedShort ? 2 : 4;
}

/// 1 to 4 numbers an element; there is no use for matrices.
int componentsOf(const JsonField& type) {
  constexpr std::array<std::string_view, 4> kNames = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const std::string name = type.text();
  for (std::size_t n = 0; n < kNames.size(); ++n) {
    if (kNames[n] == name) return static_cast<int>(n) + 1;
  }
  type.fail("SCALAR, VEC2, VEC3 or VEC4", io::quoted(name));
}

/// Of matrices, bytes or shorts.
bool isOther(const JsonField& accessor) {
  const int component_type = accessor["componentType"].integer(kByte, kFloat);
  return accessor["type"].text().starts_with("MAT") || component_type == kByte || component_type == kShort;
}

int optionalInteger(const JsonField& object, const char* key, int least, int largest, int otherwise) {
  return object.has(key) ? object[key].integer(least, largest) : otherwise;
}

void requireFinite(const JsonField& field, const Elements& elements, int components, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < toSize(components); ++c) {
      if (std::isfinite(elements.at<float>(i, c))) continue;
      field.fail("finite numbers", fmt::format("{} in element {}", elements.at<float>(i, c), i));
    }
  }
}

json boundsJson(const JsonField& field, int components) {
  json bounds = json::array();
  for (const JsonField& bound : field.elements(toSize(components), toSize(components))) {
    bounds.push_back(bound.number(std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()));
  }
  return bounds;
}

}  // namespace

std::size_t Elements::index(std::size_t element, int component_type) const {
  if (component_type == kUnsignedByte) return at<std::uint8_t>(element);
  return component_type == kUnsignedShort ? at<std::uint16_t>(element) : at<std::uint32_t>(element);
}

GltfAccessors::GltfAccessors(const JsonField& root, Bytes buffer, OtherNumbers others) : bytes_left_(buffer.size()) {
  for (const JsonField& view : root["bufferViews"].elements(1, kMostViews)) readView(view, buffer);
  for (const JsonField& accessor : root["accessors"].elements(1, kMostAccessors)) {
    if (others == OtherNumbers::kLeftOut && isOther(accessor)) {
      accessors_.emplace_back();
    } else {
      readAccessor(accessor);
    }
  }
}

const Accessor& GltfAccessors::at(const JsonField& reference) const {
  return accessors_[toSize(reference.integer(0, static_cast<int>(accessors_.size()) - 1))];
}

void GltfAccessors::readView(const JsonField& field, Bytes buffer) {
  field["buffer"].integer(0, 0);
  const int offset = optionalInteger(field, "byteOffset", 0, most(buffer.size()), 0);
  const int length = field["byteLength"].integer(1, most(buffer.size() - toSize(offset)));
  const int stride = optionalInteger(field, "byteStride", 4, kLargestStride, 0);
  views_.push_back({buffer.subspan(toSize(offset), toSize(length)), toSize(offset), toSize(stride)});
  json& view = views_json_.emplace_back(json{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}});
  if (stride > 0) view["byteStride"] = stride;
  if (field.has("target")) view["target"] = field["target"].oneOf(std::array{34962, 34963});  // attributes, indices
}

Elements GltfAccessors::elementsOf(const JsonField& field, int component_type, int components, std::size_t count) {
  const JsonField reference = field["bufferView"];
  if (views_.empty()) reference.fail("none, as there are no buffer views", reference.got());
  const View& view = views_[toSize(reference.integer(0, static_cast<int>(views_.size()) - 1))];
  const std::size_t offset = toSize(optionalInteger(field, "byteOffset", 0, most(view.bytes.size()), 0));
  const std::size_t number = bytesOf(component_type);
  const std::size_t element = number * toSize(components);
  const std::size_t stride = view.stride > 0 ? view.stride : element;
  if ((view.offset + offset) % number != 0 || stride % number != 0 || stride < element) {
    reference.fail(fmt::format("elements of {} bytes that are aligned to {}", element, number),
                   fmt::format("byte {}, and every {} bytes", view.offset + offset, stride));
  }
  if (offset + stride * (count - 1) + element > view.bytes.size()) {
    reference.fail(fmt::format("{} elements, {} bytes apart", count, stride),
                   fmt::format("{} bytes", view.bytes.size() - offset));
  }
  if (count * element > bytes_left_) reference.fail("numbers that no other accessor has", "the same again");
  bytes_left_ -= count * element;
  return {view.bytes.subspan(offset), stride};
}

void GltfAccessors::readAccessor(const JsonField& field) {
  Accessor accessor;
  accessor.component_type =
      field["componentType"].oneOf(std::array<int, 4>{kUnsignedByte, kUnsignedShort, kUnsignedInt, kFloat});
  accessor.components = componentsOf(field["type"]);
  accessor.count = toSize(field["count"].integer(1, kLargest));
  json clean = {{"componentType", accessor.component_type}, {"type", field["type"].text()}, {"count", accessor.count}};
  if (field.has("bufferView")) {
    accessor.elements = elementsOf(field, accessor.component_type, accessor.components, accessor.count);
    clean["bufferView"] = field["bufferView"].integer(0, kLargest);
    clean["byteOffset"] = optionalInteger(field, "byteOffset", 0, kLargest, 0);
    if (accessor.component_type == kFloat) {
      requireFinite(field, *accessor.elements, accessor.components, accessor.count);
    }
  }
  for (const char* bound : {"min", "max"}) {
    if (field.has(bound)) clean[bound] = boundsJson(field[bound], accessor.components);
  }
  if (field.has("sparse")) accessor.sparse = readSparse(field["sparse"], accessor, clean["sparse"]);
  accessors_.push_back(std::move(accessor));
  accessors_json_.push_back(std::move(clean));
}

SparseElements GltfAccessors::readSparse(const JsonField& field, const Accessor& accessor, json& clean) {
  const std::size_t count = toSize(field["count"].integer(1, most(accessor.count)));
  const JsonField indices = field["indices"], values = field["values"];
  const int index_type =
      indices["componentType"].oneOf(std::array<int, 3>{kUnsignedByte, kUnsignedShort, kUnsignedInt});
  const Elements at = elementsOf(indices, index_type, 1, count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t index = at.index(i, index_type);
    if (index < accessor.count && (i == 0 || index > at.index(i - 1, index_type))) continue;
    indices.fail(fmt::format("rising indices below {}", accessor.count), fmt::format("{} at {}", index, i));
  }
  const Elements replacing = elementsOf(values, accessor.component_type, accessor.components, count);
  if (accessor.component_type == kFloat) requireFinite(values, replacing, accessor.components, count);
  const auto place = [](const JsonField& where) {
    return json{{"bufferView", where["bufferView"].integer(0, kLargest)},
                {"byteOffset", optionalInteger(where, "byteOffset", 0, kLargest, 0)}};
  };
  clean = {{"count", count}, {"indices", place(indices)}, {"values", place(values)}};
  clean["indices"]["componentType"] = index_type;
  return {count, index_type, at, replacing};
}

}  // namespace facezip::scene
