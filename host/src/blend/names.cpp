#include "blend/names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "blend/number.hpp"
#include "blend/shape_names.hpp"
#include "facezip/blend.hpp"
#include "facezip/nearest_names.hpp"
#include "io/counts.hpp"
#include "io/quoted.hpp"

namespace facezip {
namespace blend {

void refuseUnknown(const Package& package, const std::string& name, const std::string& item) {
  throw InputError({package.directory().string(), item, "an expression of the package", io::quoted(name),
                    fmt::format("the nearest are {}", fmt::join(nearestNames(name, package.expressions()), ", "))});
}

int expressionIndex(const Package& package, const std::string& name, const std::string& item) {
  const auto found = findName(name, package.expressions());
  if (!found) refuseUnknown(package, name, item);
  return static_cast<int>(*found);
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

namespace {

/// A number that is out of a float's range: 0 or the nearest denormal where it is too small, none where it is too
/// large.
std::optional<float> roundTiny(std::string_view text) {
  double value = 0.0;
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc()) {
    return std::abs(value) < 1.0 ? std::optional(static_cast<float>(value)) : std::nullopt;
  }
  const bool tiny = text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos;
  return tiny ? std::optional(0.0f) : std::nullopt;
}

}  // namespace

std::optional<float> parseNumber(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  float value = 0.0f;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return roundTiny(text);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace blend

std::vector<float> weightsByName(const Package& package, const std::vector<std::pair<std::string, float>>& weights) {
  std::vector<std::string> given;
  for (const auto& [name, weight] : weights) given.push_back(name);
  const std::vector<blend::NameMatch> matches = blend::matchNames(given, package.expressions());
  std::vector<float> beta(package.expressions().size(), 0.0f);
  for (std::size_t g = 0; g < given.size(); ++g) {
    const float weight = weights[g].second;
    if (const auto earlier = matches[g].repeats) {
      throw InputError({"", "weights", "each expression once",
                        given[g] == given[*earlier] ? io::quoted(given[g]) + " twice"
                                                    : io::quoted(given[*earlier]) + " and " + io::quoted(given[g]),
                        ""});
    }
    if (matches[g].drives.empty()) blend::refuseUnknown(package, given[g], "weights");
    if (!(std::abs(weight) <= kLargestWeight)) {
      throw InputError({"", "weights",
                        fmt::format("a number of at most {:g} either way for {}", kLargestWeight, given[g]),
                        fmt::format("{:g}", weight), ""});
    }
    for (const blend::Drive& drive : matches[g].drives) beta[drive.expression] += drive.share * weight;
  }
  return beta;
}

std::vector<std::pair<std::string, float>> parseWeights(std::string_view text) {
  std::vector<std::pair<std::string, float>> weights;
  if (blend::trimmed(text).empty()) return weights;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view part = text.substr(begin, end - begin);
    const std::size_t equals = part.rfind('=');
    const std::string name(blend::trimmed(part.substr(0, std::min(equals, part.size()))));
    const std::optional<float> weight =
        equals == std::string_view::npos ? std::nullopt : blend::parseNumber(part.substr(equals + 1));
    if (name.empty() || !weight) {
      throw InputError({"", "weights", "NAME=NUMBER, separated by commas", io::quoted(std::string(part)), ""});
    }
    weights.emplace_back(name, *weight);
    begin = end + 1;
  }
  return weights;
}

}  // namespace facezip
