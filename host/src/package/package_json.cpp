#include "package/package_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "blocks/block_format.hpp"
#include "image/map_fields.hpp"
#include "io/composed.hpp"
#include "io/json_field.hpp"
#include "io/quoted.hpp"
#include "io/safe_names.hpp"
#include "package/guides.hpp"
#include "package/package_writer.hpp"

namespace facezip::package {
namespace {
using nlohmann::json;
using Document = nlohmann::ordered_json;  // fields in the order of docs/package_format.md

constexpr double kLargestCoefficient = 1e9;
constexpr std::pair<SampleType, const char*> kSampleTypes[] = {
    {SampleType::kUint8, "8-bit"}, {SampleType::kUint16, "16-bit"}, {SampleType::kFloat32, "float"}};

const char* sampleTypeText(SampleType type) {
  for (const auto& [value, text] : kSampleTypes) {
    if (value == type) return text;
  }
  return "";
}

Document weightsJson(const PackageWeights& weights) {
  return {{"files", weights.files},
          {"columns", weights.columns},
          {"rows", weights.rows},
          {"tile_width", weights.tile_width},
          {"tile_height", weights.tile_height},
          {"border", weights.border},
          {"scale", weights.scale},
          {"offset", weights.offset}};
}

Document textureJson(const std::string& file, const std::optional<BlockFormat>& format) {
  Document texture = {{"file", file}};
  if (format) texture["format"] = blockFormatName(*format);
  return texture;
}

Document mapJson(const PackageMap& map) {
  Document differences = Document::array();
  for (const PackageDifference& difference : map.differences) {
    Document& texture = differences.emplace_back(textureJson(difference.file, difference.format));
    texture["scale"] = difference.scale;
    texture["offset"] = difference.offset;
  }
  return {{"name", map.name},
          {"width", map.width},
          {"height", map.height},
          {"channels", map.channels},
          {"sample_type", sampleTypeText(map.sample_type)},
          {"colour_space", map.colour_space},
          {"weights", map.weight_set},
          {"weight_scale", map.weight_scale},
          {"metric_weight", map.metric_weight},
          {"neutral", textureJson(map.neutral_file, map.neutral_format)},
          {"difference_bits", map.difference_bits},
          {"differences", differences}};
}

void requireUnique(const std::vector<io::JsonField>& fields, const char* what) {
  std::set<std::string> seen;
  for (const io::JsonField& field : fields) {
    if (!seen.insert(io::composed(field.text())).second)
      field.fail(fmt::format("unique {} names", what), field.got() + " twice");
  }
}

std::vector<std::string> parseExpressions(const io::JsonField& field) {
  const std::vector<io::JsonField> fields = field.elements(1, image::kMaxExpressions);
  std::vector<std::string> names;
  for (const io::JsonField& name : fields) names.push_back(io::fileSafeName(name));
  requireUnique(fields, "expression");
  return names;
}

std::vector<double> parseNumbers(const io::JsonField& field, int count, double least, double most) {
  std::vector<double> numbers;
  for (const io::JsonField& number : field.elements(static_cast<std::size_t>(count), static_cast<std::size_t>(count))) {
    numbers.push_back(number.number(least, most));
  }
  return numbers;
}

PackageWeights parseWeights(const io::JsonField& field, int expressions, int differences) {
  PackageWeights weights;
  const std::size_t files = static_cast<std::size_t>(differences - 1) / 4 + 1;
  for (const io::JsonField& file : field["files"].elements(files, files))
    weights.files.push_back(io::fileInPackage(file, ".png"));
  weights.columns = field["columns"].integer(1, kMaxAtlasSide);
  weights.rows = field["rows"].integer(1, kMaxAtlasSide);
  weights.tile_width = field["tile_width"].integer(1, kMaxAtlasSide - 2);
  weights.tile_height = field["tile_height"].integer(1, kMaxAtlasSide - 2);
  weights.border = field["border"].integer(1, 1);
  weights.scale = parseNumbers(field["scale"], differences, 0, kLargestCoefficient);
  weights.offset = parseNumbers(field["offset"], differences, -kLargestCoefficient, kLargestCoefficient);
  if (weights.columns > kMaxAtlasSide / (weights.tile_width + 2 * weights.border)) {
    field["columns"].fail(fmt::format("an atlas at most {} cells wide", kMaxAtlasSide), field["columns"].got());
  }
  if (weights.rows > kMaxAtlasSide / (weights.tile_height + 2 * weights.border)) {
    field["rows"].fail(fmt::format("an atlas at most {} cells high", kMaxAtlasSide), field["rows"].got());
  }
  if (weights.columns * weights.rows < expressions) {
    field["rows"].fail(fmt::format("tiles for {} expressions", expressions),
                       fmt::format("{} x {} tiles", weights.columns, weights.rows));
  }
  return weights;
}

/// Zero must be a code: outside the face a difference is zero, and there the neutral must come back untouched. Numbers
/// of 17 digits come back from JSON as they were written, so no tolerance is needed.
void requireExactZero(const io::JsonField& field, double scale, double offset, int largest_code) {
  if (scale == 0.0 && offset == 0.0) return;
  const double zero_code = std::round(-offset / scale);
  if (scale > 0.0 && zero_code >= 0.0 && zero_code <= largest_code && offset == -(scale * zero_code)) return;
  field.fail(fmt::format("-scale times an integer from 0 to {}, so that zero has a code", largest_code),
             fmt::format("offset {} at scale {}", offset, scale));
}

/// The blocks that a texture of a map says that it has.
std::optional<BlockFormat> parseFormat(const io::JsonField& field, const PackageMap& map) {
  if (!field.has("format")) return std::nullopt;
  const io::JsonField format = field["format"];
  const std::string name = format.text();
  const auto formats = blocks::blockFormats();
  const auto found = std::ranges::find(formats, name, &blocks::BlockFormatInfo::name);
  if (found == formats.end()) format.fail("one of " + blockFormatNames(), io::quoted(name));
  if (map.channels > found->max_channels) {
    format.fail(fmt::format("a format of {} channels", map.channels), format.got());
  }
  if (map.sample_type != SampleType::kUint8) format.fail("none: blocks hold maps of 8 bits", format.got());
  return found->format;
}

PackageDifference parseDifference(const io::JsonField& field, const PackageMap& map) {
  const int channels = map.channels;
  const int largest_code = (1 << map.difference_bits) - 1;
  PackageDifference difference;
  difference.format = parseFormat(field, map);
  difference.file = io::fileInPackage(field["file"], difference.format ? ".ktx2" : ".png");
  if (difference.format && map.difference_bits != 8) {
    field["format"].fail("none beside difference_bits of 16: blocks hold codes of 8", field["format"].got());
  }
  difference.scale = parseNumbers(field["scale"], channels, 0, kLargestCoefficient);
  difference.offset = parseNumbers(field["offset"], channels, -largest_code * kLargestCoefficient, 0);
  for (std::size_t c = 0; c < difference.scale.size(); ++c) {
    requireExactZero(field["offset"], difference.scale[c], difference.offset[c], largest_code);
  }
  return difference;
}

const char* neutralExtension(const PackageMap& map) {
  if (map.neutral_format) return ".ktx2";
  return map.sample_type == SampleType::kFloat32 ? ".exr" : ".png";
}

SampleType parseSampleType(const io::JsonField& field) {
  const std::string name = field.text();
  for (const auto& [value, text] : kSampleTypes) {
    if (name == text) return value;
  }
  field.fail("\"8-bit\", \"16-bit\" or \"float\"", io::quoted(name));
}

/// Map and set must agree on the cells: the kernel that samples weights clamps to the set's grid.
void requireSameGrid(const io::JsonField& field, const PackageMap& map, const PackageWeights& weights) {
  const int columns = weightCells(map.width, map.weight_scale);
  const int rows = weightCells(map.height, map.weight_scale);
  if (columns == weights.tile_width && rows == weights.tile_height) return;
  field.fail(fmt::format("{} x {} texels to need {} x {} cells (tile_width, tile_height of weights[{}])", map.width,
                         map.height, weights.tile_width, weights.tile_height, map.weight_set),
             fmt::format("{} x {} at weight_scale {}", columns, rows, map.weight_scale));
}

PackageMap parseMap(const io::JsonField& field, const std::vector<PackageWeights>& weight_sets, int differences) {
  PackageMap map;
  map.name = io::fileSafeName(field["name"]);
  map.width = field["width"].integer(1, kMaxSide);
  map.height = field["height"].integer(1, kMaxSide);
  map.channels = field["channels"].integer(1, 4);
  map.sample_type = parseSampleType(field["sample_type"]);
  map.colour_space = image::parseColourSpace(field["colour_space"]);
  map.weight_set = field["weights"].integer(0, static_cast<int>(weight_sets.size()) - 1);
  map.weight_scale = field["weight_scale"].integer(1, kMaxSide);
  map.metric_weight = image::parseMetricWeight(field["metric_weight"]);
  map.neutral_format = parseFormat(field["neutral"], map);
  map.neutral_file = io::fileInPackage(field["neutral"]["file"], neutralExtension(map));
  map.difference_bits = field["difference_bits"].oneOf(std::array{8, 16});
  const std::size_t count = static_cast<std::size_t>(differences);
  for (const io::JsonField& difference : field["differences"].elements(count, count)) {
    map.differences.push_back(parseDifference(difference, map));
  }
  requireSameGrid(field, map, weight_sets[static_cast<std::size_t>(map.weight_set)]);
  return map;
}

/// A set that no map uses would cost memory in every reader and change no frame.
void requireUsed(const std::vector<io::JsonField>& weight_sets, const std::vector<PackageMap>& maps) {
  for (std::size_t set = 0; set < weight_sets.size(); ++set) {
    const auto uses = [set](const PackageMap& map) { return static_cast<std::size_t>(map.weight_set) == set; };
    if (std::none_of(maps.begin(), maps.end(), uses)) {
      weight_sets[set].fail("weights that a map uses (maps[].weights)", "no map that does", "write the package again");
    }
  }
}

void requireKnownVersion(const io::JsonField& document) {
  const io::JsonField format = document["format"];
  if (format.text() != "facezip-package")
    format.fail("\"facezip-package\"", format.got(), "is this a facezip package?");
  const io::JsonField version = document["version"];
  const int number = version.integer(0, INT32_MAX);
  if (number < kImageFormatVersion || number > kFormatVersion) {
    version.fail(fmt::format("{} or {}, the versions that this facezip reads", kImageFormatVersion, kFormatVersion),
                 version.got(), number > kFormatVersion ? "update facezip" : "write the package again");
  }
}

bool hasBlocks(const PackageDescription& description) {
  return std::ranges::any_of(description.maps, [](const PackageMap& map) {
    return map.neutral_format ||
           std::ranges::any_of(map.differences, [](const auto& d) { return d.format.has_value(); });
  });
}

/// Version 2 knows no blocks: whoever reads it would not find them.
void requireVersionOfBlocks(const io::JsonField& document, const PackageDescription& description) {
  const io::JsonField version = document["version"];
  if (!hasBlocks(description) || version.integer(0, INT32_MAX) >= 3) return;
  version.fail("3, for textures in blocks (\"format\")", version.got(), "write the package again");
}

}  // namespace

std::string packageJson(const PackageDescription& description) {
  Document weight_sets = Document::array();
  for (const PackageWeights& weights : description.weights) weight_sets.push_back(weightsJson(weights));
  Document maps = Document::array();
  for (const PackageMap& map : description.maps) maps.push_back(mapJson(map));
  try {
    Document document = {{"format", "facezip-package"},
                         {"version", hasBlocks(description) ? kFormatVersion : kImageFormatVersion},
                         {"generator", description.generator},
                         {"name", description.name},
                         {"expressions", description.expressions},
                         {"differences", description.differences},
                         {"weights", weight_sets},
                         {"maps", maps},
                         {"method", Document::parse(description.method_json)}};
    addGuides(description, document);
    return document.dump(2) + "\n";
  } catch (const Document::exception& error) {
    throw InputError({kDescriptionFile, "", "names in UTF-8 and a method record that is JSON", error.what(), ""});
  }
}

PackageDescription parsePackageJson(const std::string& text, const std::string& file) {
  constexpr std::size_t kMostMaps = 256;
  const json json_document = io::parseJson(text, file);
  const io::JsonField document(json_document, file, "");
  requireKnownVersion(document);
  PackageDescription description;
  description.generator = document["generator"].text();
  description.name = document["name"].text();
  description.expressions = parseExpressions(document["expressions"]);
  description.differences = document["differences"].integer(1, kMaxDifferences);
  const std::vector<io::JsonField> weight_sets = document["weights"].elements(1, kMostMaps);
  for (const io::JsonField& weights : weight_sets) {
    description.weights.push_back(
        parseWeights(weights, static_cast<int>(description.expressions.size()), description.differences));
  }
  const std::vector<io::JsonField> maps = document["maps"].elements(1, kMostMaps);
  std::vector<io::JsonField> names;
  for (const io::JsonField& map : maps) {
    description.maps.push_back(parseMap(map, description.weights, description.differences));
    names.push_back(map["name"]);
  }
  requireUnique(names, "map");
  requireUsed(weight_sets, description.maps);
  requireVersionOfBlocks(document, description);
  parseGuides(document, description);
  description.method_json = document["method"].object().dump();
  return description;
}

}  // namespace facezip::package
