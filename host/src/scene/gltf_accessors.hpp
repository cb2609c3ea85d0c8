// gltf_accessors.hpp - the numbers of a glTF file of strangers: where they stand in its buffer, and that they do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "io/json_field.hpp"

namespace facezip::scene {

/// glTF's names for types of numbers.
enum ComponentType : int { kUnsignedByte = 5121, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126 };

/// Elements that stand in the buffer at regular distances.
struct Elements {
  std::span<const std::byte> bytes;  ///< from the first on
  std::size_t stride = 0;

  template <typename Number>
  Number at(std::size_t element, std::size_t component = 0) const {
    Number number;
    std::memcpy(&number, bytes.data() + element * stride + component * sizeof(Number), sizeof(Number));
    return number;
  }
  /// One of an unsigned type.
  std::size_t index(std::size_t element, int component_type) const;
};

/// Elements that stand elsewhere than the others.
struct SparseElements {
  std::size_t count = 0;
  int index_type = 0;
  Elements indices;  ///< rising, in range
  Elements values;
};

struct Accessor {
  int component_type = 0;
  int components = 0;
  std::size_t count = 0;
  std::optional<SparseElements> sparse;
  std::optional<Elements> elements;  ///< zeros where there are none
};

/// What accessors of matrices and of signed integers are, which meshes have no use for (bones and animations have).
enum class OtherNumbers { kRefused, kLeftOut };

/// Every accessor of a file. Ranges, alignment, sparse indices and floats, which must be finite, were checked.
class GltfAccessors {
 public:
  /// root  the document; buffer  the bytes of its one buffer; others  left out, they have no elements and no components
  /// Throws InputError naming the field.
  GltfAccessors(const io::JsonField& root, std::span<const std::byte> buffer,
                OtherNumbers others = OtherNumbers::kRefused);

  std::size_t size() const { return accessors_.size(); }
  const Accessor& operator[](std::size_t index) const { return accessors_[index]; }
  /// The one that a field refers to. Throws InputError.
  const Accessor& at(const io::JsonField& reference) const;

  /// `bufferViews` and `accessors` anew, of what was read alone.
  const nlohmann::json& viewsJson() const { return views_json_; }
  const nlohmann::json& accessorsJson() const { return accessors_json_; }

 private:
  struct View {
    std::span<const std::byte> bytes;
    std::size_t offset = 0;
    std::size_t stride = 0;  ///< 0: one element behind the other
  };
  void readView(const io::JsonField& field, std::span<const std::byte> buffer);
  void readAccessor(const io::JsonField& field);
  SparseElements readSparse(const io::JsonField& field, const Accessor& accessor, nlohmann::json& json);
  Elements elementsOf(const io::JsonField& field, int component_type, int components, std::size_t count);

  std::size_t bytes_left_;  ///< of the buffer: accessors over the same bytes could go on for ever
  std::vector<View> views_;
  std::vector<Accessor> accessors_;
  nlohmann::json views_json_ = nlohmann::json::array();
  nlohmann::json accessors_json_ = nlohmann::json::array();
};

}  // namespace facezip::scene
