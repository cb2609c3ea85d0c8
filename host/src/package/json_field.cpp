#include "package/json_field.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "facezip/printable.hpp"
#include "package/package_json.hpp"

namespace facezip::package {
using nlohmann::json;

JsonField JsonField::operator[](const std::string& key) const {
  if (!value_.is_object()) fail("an object", got());
  const auto found = value_.find(key);
  const std::string path = path_.empty() ? key : path_ + "." + key;
  if (found == value_.end()) throw InputError({file_, path, "", "no such field", "write the package again"});
  return {*found, file_, path, cure_};
}

bool JsonField::has(const std::string& key) const {
  if (!value_.is_object()) fail("an object", got());
  return value_.contains(key);
}

std::vector<JsonField> JsonField::elements(std::size_t least, std::size_t most) const {
  const std::string expected =
      least == most ? fmt::format("an array of {}", least) : fmt::format("an array of {} to {}", least, most);
  if (!value_.is_array()) fail(expected, got());
  if (value_.size() < least || value_.size() > most) fail(expected, fmt::format("{} elements", value_.size()));
  std::vector<JsonField> fields;
  for (std::size_t i = 0; i < value_.size(); ++i) {
    fields.emplace_back(value_[i], file_, fmt::format("{}[{}]", path_, i), cure_);
  }
  return fields;
}

std::string JsonField::text() const {
  if (!value_.is_string()) fail("a string", got());
  return value_.get<std::string>();
}

int JsonField::integer(int least, int most) const {
  const std::string expected = fmt::format("an integer from {} to {}", least, most);
  if (!value_.is_number_integer()) fail(expected, got());
  // Compared in the type that the parser chose: a cast to int first would let 2^32 + 1 pass as 1.
  const bool fits = value_.is_number_unsigned()
                        ? most >= 0 && value_.get<std::uint64_t>() <= static_cast<std::uint64_t>(most) &&
                              (least <= 0 || value_.get<std::uint64_t>() >= static_cast<std::uint64_t>(least))
                        : value_.get<std::int64_t>() >= least && value_.get<std::int64_t>() <= most;
  if (!fits) fail(expected, got());
  return value_.get<int>();
}

int JsonField::oneOf(std::span<const int> choices) const {
  for (const int choice : choices) {
    if (value_.is_number_integer() && value_ == choice) return choice;
  }
  fail(fmt::format("{} or {}", fmt::join(choices.first(choices.size() - 1), ", "), choices.back()), got());
}

double JsonField::number(double least, double most) const {
  const std::string expected = fmt::format("a number from {} to {}", least, most);
  if (!value_.is_number()) fail(expected, got());
  const double number = value_.get<double>();
  if (!std::isfinite(number) || number < least || number > most) fail(expected, got());
  return number;
}

const json& JsonField::object() const {
  if (!value_.is_object()) fail("an object", got());
  return value_;
}

void JsonField::fail(const std::string& expected, const std::string& got, const std::string& cure) const {
  throw InputError({file_, path_, expected, got, cure.empty() ? cure_ : cure});
}

std::string JsonField::got() const {
  if (value_.is_object()) return "an object";
  if (value_.is_array()) return "an array";
  return value_.is_string() ? quoted(value_.get<std::string>()) : value_.dump();
}

std::string quoted(const std::string& text) {
  constexpr std::size_t kLongest = 80;
  std::size_t length = std::min(kLongest, text.size());
  while (length > 0 && length < text.size() && (static_cast<unsigned char>(text[length]) & 0xc0u) == 0x80u) --length;
  return fmt::format("\"{}{}\"", printable(std::string_view(text).substr(0, length)),
                     text.size() > kLongest ? "..." : "");
}

json parseJson(const std::string& text, const std::string& file, const std::string& cure) {
  constexpr int kDeepest = 64;
  const auto limitDepth = [&](int depth, json::parse_event_t, json&) {
    if (depth > kDeepest) throw InputError({file, "", fmt::format("at most {} nested levels", kDeepest), "more", cure});
    return true;
  };
  try {
    return json::parse(text, limitDepth);
  } catch (const json::parse_error& error) {
    throw InputError({file, fmt::format("byte {}", error.byte), "JSON", error.what(), cure});
  } catch (const json::out_of_range& error) {  // 1e999
    throw InputError({file, "", "numbers up to 1.8e308", error.what(), cure});
  }
}

}  // namespace facezip::package
