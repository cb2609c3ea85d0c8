// json_field.hpp - a value of an untrusted JSON file that knows where it stands, for messages like
// "package.json: maps[0].width: expected an integer from 1 to 65536, got \"wide\"".
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "facezip/error.hpp"

namespace facezip::io {

class JsonField {
 public:
  /// `value` must outlive the field. `path` is empty for the document itself. `cure`: of errors that have none.
  JsonField(const nlohmann::json& value, std::string file, std::string path, std::string cure = "")
      : value_(value), file_(std::move(file)), path_(std::move(path)), cure_(std::move(cure)) {}

  /// The member `key` of an object. Throws InputError if this is no object or has no such member.
  JsonField operator[](const std::string& key) const;
  /// True for an object that has the member `key`. Throws InputError if this is no object.
  bool has(const std::string& key) const;
  /// The elements of an array of `least` to `most` elements. Throws InputError.
  std::vector<JsonField> elements(std::size_t least, std::size_t most) const;

  std::string text() const;
  /// An integer in [least, most]; 3.0 is not one.
  int integer(int least, int most) const;
  /// One of `choices`, which are two or more.
  int oneOf(std::span<const int> choices) const;
  /// A finite number in [least, most].
  double number(double least, double most) const;
  const nlohmann::json& object() const;

  /// Throws the InputError of this field.
  [[noreturn]] void fail(const std::string& expected, const std::string& got, const std::string& cure = "") const;
  /// The value as it stands in the file, short enough for a message.
  std::string got() const;
  const std::string& path() const { return path_; }

 private:
  const nlohmann::json& value_;
  std::string file_;
  std::string path_;
  std::string cure_;
};

/// Parses `text`. Throws InputError with the offset of the fault. Nesting deeper than 64 is refused, since code that
/// walks a document by recursion would run out of stack, and so are more than 2^21 values, which take far more memory
/// than their text. `cure`: what to do about a fault, where people write the file.
nlohmann::json parseJson(const std::string& text, const std::string& file,
                         const std::string& cure = "the file is damaged: write it again");

}  // namespace facezip::io
