#include "io/json_field.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "io/quoted.hpp"

namespace facezip::io {
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

namespace {

/// The parser's words, without the middle of what it quotes from the file, which may be all of it.
std::string shortened(const std::string& words) {
  constexpr std::size_t kLongest = 240;
  if (words.size() <= kLongest) return words;
  return words.substr(0, kLongest / 2) + " ... " + words.substr(words.size() - kLongest / 2);
}

/// Reads a document without keeping anything of it. Throws InputError for one that parseJson() refuses.
class Limits : public nlohmann::json_sax<json> {
 public:
  Limits(const std::string& file, const std::string& cure) : file_(file), cure_(cure) {}

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(std::int64_t) override { return value(); }
  bool number_unsigned(std::uint64_t) override { return value(); }
  bool number_float(double, const std::string&) override { return value(); }
  bool string(std::string&) override { return value(); }
  bool binary(json::binary_t&) override { return value(); }
  bool key(std::string&) override { return true; }
  bool start_object(std::size_t) override { return begin(); }
  bool start_array(std::size_t) override { return begin(); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }

  bool parse_error(std::size_t position, const std::string&, const json::exception& error) override {
    const bool of_syntax = dynamic_cast<const json::parse_error*>(&error) != nullptr;
    const std::string item = of_syntax ? fmt::format("byte {}", position) : "";
    fail(item, of_syntax ? "JSON" : "numbers up to 1.8e308", shortened(error.what()));
  }

 private:
  bool value() {
    // A text of "[],[],..." takes forty times its size.
    constexpr std::size_t kMostValues = std::size_t{1} << 21;
    if (++values_ > kMostValues) fail("", fmt::format("at most {} values", kMostValues), "more");
    return true;
  }
  bool begin() {
    constexpr int kDeepest = 64;
    if (++depth_ > kDeepest) fail("", fmt::format("at most {} nested levels", kDeepest), "more");
    return value();
  }
  bool end() {
    --depth_;
    return true;
  }
  [[noreturn]] void fail(const std::string& item, const std::string& expected, const std::string& got) const {
    throw InputError({file_, item, expected, got, cure_});
  }

  const std::string& file_;
  const std::string& cure_;
  std::size_t values_ = 0;
  int depth_ = 0;
};

}  // namespace

json parseJson(const std::string& text, const std::string& file, const std::string& cure) {
  // Twice: the parser's own way of looking on, a callback, takes quadratic time.
  Limits limits(file, cure);
  json::sax_parse(text, &limits);
  return json::parse(text);
}

}  // namespace facezip::io
