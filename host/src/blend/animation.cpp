#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>

#include "blend/names.hpp"
#include "blend/number.hpp"
#include "blend/shape_names.hpp"
#include "facezip/blend.hpp"
#include "facezip/nearest_names.hpp"
#include "io/counts.hpp"
#include "io/quoted.hpp"
#include "io/read_file.hpp"

namespace facezip {
namespace {

std::string lineItem(std::size_t line) { return fmt::format("line {}", line); }

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

/// What the columns of a table hold.
struct Header {
  std::vector<std::string> names;
  std::vector<std::vector<blend::Drive>> drives;  ///< none: the column is skipped
  std::optional<std::size_t> shape_count;         ///< the column of "BlendShapeCount"
};

bool isShapeCount(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name == "blendshapecount";
}

Header parseHeader(const std::string& line, std::size_t line_number, const std::filesystem::path& file,
                   const Package& package) {
  Header header{splitLine(line), {}, std::nullopt};
  const std::vector<blend::NameMatch> matches = blend::matchNames(header.names, package.expressions());
  bool any = false;
  for (std::size_t column = 0; column < matches.size(); ++column) {
    if (const auto earlier = matches[column].repeats) {
      const std::string& name = header.names[column];
      throw InputError({file.string(), fieldItem(line_number, column), "each expression once",
                        name == header.names[*earlier]
                            ? io::quoted(name) + " twice"
                            : io::quoted(header.names[*earlier]) + " and " + io::quoted(name),
                        ""});
    }
    header.drives.push_back(matches[column].drives);
    any = any || !header.drives.back().empty();
    if (header.drives.back().empty() && isShapeCount(header.names[column])) header.shape_count = column;
  }
  if (any) return header;
  const auto named = std::ranges::find_if_not(header.names, blend::isNoShape);
  const std::string name = named == header.names.end() ? "" : *named;
  throw InputError(
      {file.string(), lineItem(line_number), "names of expressions of the package", io::quoted(line),
       fmt::format("the nearest to {} is {}", io::quoted(name), nearestNames(name, package.expressions(), 1).front())});
}

/// Says which columns nothing comes of: a misspelt name would otherwise go unnoticed.
void noteSkipped(const Header& header, const std::filesystem::path& file, const Package& package, Progress& progress) {
  constexpr std::size_t kMostListed = 8;
  std::vector<std::string> skipped, shown;
  for (std::size_t column = 0; column < header.names.size(); ++column) {
    const std::string& name = header.names[column];
    if (header.drives[column].empty() && !name.empty() && !blend::isNoShape(name)) skipped.push_back(name);
  }
  if (skipped.empty()) return;
  const std::size_t listed = std::min(skipped.size(), kMostListed);
  for (std::size_t i = 0; i < listed; ++i) shown.push_back(io::quoted(skipped[i]));
  std::string text =
      fmt::format("{}: columns skipped, since no expression is called so: {}", file.string(), fmt::join(shown, ", "));
  if (listed < skipped.size()) text += fmt::format(" and {} more", skipped.size() - listed);
  progress.note(fmt::format("{} (the nearest to the first is {})", text,
                            nearestNames(skipped.front(), package.expressions(), 1).front()));
}

/// The largest weight, either way, and where it stands.
struct Largest {
  float weight = 0.0f;
  std::string item;
};

/// Live Link Face writes rows of no shapes, some without the other fields, while it sees no face.
bool hasNoFace(const Header& header, const std::vector<std::string>& fields) {
  return header.shape_count && *header.shape_count < fields.size() && fields[*header.shape_count] == "0";
}

void appendFrame(const std::string& line, std::size_t line_number, const std::filesystem::path& file,
                 const Header& header, AnimationClip& clip, Largest& largest) {
  const std::vector<std::string> fields = splitLine(line);
  const std::size_t frame = clip.weights.size();
  clip.weights.resize(frame + toSize(clip.expressions), 0.0f);
  if (hasNoFace(header, fields)) {
    if (frame > 0)
      std::copy_n(clip.weights.end() - 2 * clip.expressions, clip.expressions, clip.weights.end() - clip.expressions);
    return;
  }
  if (fields.size() != header.names.size()) {
    throw InputError({file.string(), lineItem(line_number), fmt::format("{} columns", header.names.size()),
                      fmt::format("{}", fields.size()), ""});
  }
  for (std::size_t column = 0; column < fields.size(); ++column) {
    if (header.drives[column].empty()) continue;
    const std::optional<float> weight = blend::parseNumber(fields[column]);
    if (!weight || std::abs(*weight) > kLargestWeight) {
      throw InputError({file.string(), fieldItem(line_number, column),
                        fmt::format("a number of at most {:g} either way", kLargestWeight), io::quoted(fields[column]),
                        ""});
    }
    for (const blend::Drive& drive : header.drives[column]) {
      clip.weights[frame + drive.expression] += drive.share * *weight;
    }
    if (std::abs(*weight) > std::abs(largest.weight)) largest = {*weight, fieldItem(line_number, column)};
  }
}

}  // namespace

AnimationClip readAnimation(const std::filesystem::path& file, const Package& package, Progress* progress) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
  std::istringstream stream(io::readFile(file, "a table of blendshape weights", "", kMostBytes));
  AnimationClip clip;
  clip.expressions = static_cast<int>(package.expressions().size());
  std::optional<Header> header;
  Largest largest;
  std::string line;
  for (std::size_t line_number = 1; std::getline(stream, line); ++line_number) {
    if (line_number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);  // spreadsheets write a byte order mark
    if (blend::trimmed(line).empty()) continue;
    if (header) {
      appendFrame(line, line_number, file, *header, clip, largest);
    } else {
      header = parseHeader(line, line_number, file, package);
    }
  }
  if (!header) throw InputError({file.string(), "", "a header of expression names", "an empty file", ""});
  if (clip.weights.empty())
    throw InputError({file.string(), "", "a row of weights for each frame", "a header alone", ""});
  if (progress == nullptr) return clip;
  noteSkipped(*header, file, package, *progress);
  if (std::abs(largest.weight) > kUsualWeight) {
    progress->note(fmt::format("{}: weights up to {:g} ({}): 1 is the whole expression; are these per cent?",
                               file.string(), largest.weight, largest.item));
  }
  return clip;
}

}  // namespace facezip
