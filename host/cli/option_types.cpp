#include "option_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>

#include "facezip/error.hpp"

namespace facezip::cli {

std::uint64_t parseBytes(const std::string& option, const std::string& text) {
  static const std::map<std::string, double> factors = {
      {"b", 1.0},         {"kb", 1e3},   {"mb", 1e6},           {"gb", 1e9},      {"kib", 1024.0},
      {"mib", 1048576.0}, {"k", 1024.0}, {"gib", 1073741824.0}, {"m", 1048576.0}, {"g", 1073741824.0}};
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const char* const unit_begin = std::find_if(end, text.data() + text.size(), [](char c) { return c != ' '; });
  std::string unit(unit_begin, text.data() + text.size());
  std::ranges::transform(unit, unit.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (error == std::errc() && unit.empty()) {
    throw InputError({option, "", "a size with its unit", text, fmt::format("{0}MiB? {0}B are bytes", text)});
  }
  const auto factor = factors.find(unit);
  if (error != std::errc() || factor == factors.end() || !std::isfinite(number) || number * factor->second < 1.0 ||
      number * factor->second > 1e18) {
    throw InputError({option, "", "a size such as 2GiB or 512MB", text, ""});
  }
  return static_cast<std::uint64_t>(number * factor->second);
}

std::uint64_t parseSeed(const std::string& option, const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error == std::errc() && end == text.data() + text.size()) return seed;
  throw InputError({option, "", "a whole number from 0 to 18446744073709551615", text, ""});
}

namespace {

/// Writes the number that `text` is as CLI11 reads it; false where it is none.
template <typename Number>
bool normalise(std::string& text) {
  const std::size_t plus = text.starts_with('+') && !text.starts_with("+-") ? 1 : 0;
  Number number{};
  const auto [end, error] = std::from_chars(text.data() + plus, text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  text = fmt::format("{}", number);
  return true;
}

template <typename Number>
CLI::Validator makeValidator(const std::string& what) {
  return {[what](std::string& text) {
            const std::string given = text;
            return normalise<Number>(text) ? std::string() : fmt::format("expected {}, got \"{}\"", what, given);
          },
          ""};
}

}  // namespace

const CLI::Validator& wholeNumber() {
  static const CLI::Validator validator = makeValidator<std::int64_t>("a whole number");
  return validator;
}

const CLI::Validator& decimalNumber() {
  static const CLI::Validator validator = makeValidator<double>("a number");
  return validator;
}

std::string formatMegabytes(std::uint64_t bytes) { return fmt::format("{:.2f} MB", static_cast<double>(bytes) / 1e6); }

}  // namespace facezip::cli
