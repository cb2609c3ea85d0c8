#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <string>

#include "blend/names.hpp"
#include "blend/number.hpp"
#include "facezip/blend.hpp"
#include "io/counts.hpp"
#include "io/read_file.hpp"
#include "package/package_json.hpp"

namespace facezip {
namespace {

constexpr int kSkippedColumn = -1;

std::string fieldItem(std::size_t line, std::size_t column) {
  return fmt::format("line {}, column {}", line, column + 1);
}

/// Fields of one line, blanks and one pair of double quotes taken off.
std::vector<std::string> splitLine(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view field = blend::trimmed(line.substr(begin, end - begin));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    fields.emplace_back(field);
    begin = end + 1;
  }
  return fields;
}

bool isTimeColumn(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name == "frame" || name == "time";
}

/// Expression of each column, kSkippedColumn for time. Names of the package go first: an expression may be called
/// "time".
std::vector<int> parseHeader(const std::string& line, std::size_t line_number, const std::filesystem::path& file,
                             const Package& package) {
  std::vector<int> columns;
  for (const std::string& name : splitLine(line)) {
    const std::string item = fieldItem(line_number, columns.size());
    const std::vector<std::string>& names = package.expressions();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end() && isTimeColumn(name)) {
      columns.push_back(kSkippedColumn);
      continue;
    }
    if (found == names.end()) {
      throw InputError({file.string(), item, "an expression of the package", package::quoted(name),
                        fmt::format("the nearest is {}", blend::nearestNames(name, names, 1).front())});
    }
    const int n = static_cast<int>(found - names.begin());
    if (std::find(columns.begin(), columns.end(), n) != columns.end()) {
      throw InputError({file.string(), item, "each expression once", package::quoted(name) + " twice", ""});
    }
    columns.push_back(n);
  }
  return columns;
}

void appendFrame(const std::string& line, std::size_t line_number, const std::filesystem::path& file,
                 const std::vector<int>& columns, AnimationClip& clip) {
  const std::vector<std::string> fields = splitLine(line);
  if (fields.size() != columns.size()) {
    throw InputError({file.string(), fmt::format("line {}", line_number), fmt::format("{} columns", columns.size()),
                      fmt::format("{}", fields.size()), ""});
  }
  const std::size_t frame = clip.weights.size();
  clip.weights.resize(frame + toSize(clip.expressions), 0.0f);
  for (std::size_t column = 0; column < fields.size(); ++column) {
    if (columns[column] == kSkippedColumn) continue;
    const std::optional<float> weight = blend::parseNumber(fields[column]);
    if (!weight || std::abs(*weight) > kLargestWeight) {
      throw InputError({file.string(), fieldItem(line_number, column),
                        fmt::format("a number of at most {:g} either way", kLargestWeight),
                        package::quoted(fields[column]), ""});
    }
    clip.weights[frame + toSize(columns[column])] = *weight;
  }
}

}  // namespace

AnimationClip readAnimation(const std::filesystem::path& file, const Package& package) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
  std::istringstream stream(io::readFile(file, "a table of blendshape weights", "", kMostBytes));
  AnimationClip clip;
  clip.expressions = static_cast<int>(package.expressions().size());
  std::vector<int> columns;
  std::string line;
  for (std::size_t line_number = 1; std::getline(stream, line); ++line_number) {
    if (line_number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);  // spreadsheets write a byte order mark
    if (blend::trimmed(line).empty()) continue;
    if (columns.empty()) {
      columns = parseHeader(line, line_number, file, package);
    } else {
      appendFrame(line, line_number, file, columns, clip);
    }
  }
  if (columns.empty()) throw InputError({file.string(), "", "a header of expression names", "an empty file", ""});
  if (clip.weights.empty())
    throw InputError({file.string(), "", "a row of weights for each frame", "a header alone", ""});
  return clip;
}

}  // namespace facezip
