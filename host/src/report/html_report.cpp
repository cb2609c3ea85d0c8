#include "facezip/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "facezip/report.hpp"
#include "image/image_file.hpp"
#include "io/base64.hpp"
#include "io/json_field.hpp"
#include "io/read_file.hpp"
#include "io/safe_names.hpp"
#include "io/scratch_directory.hpp"
#include "package/guides.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"
#include "package/package_textures.hpp"
#include "package/weight_atlas.hpp"
#include "report/report_page.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {
using nlohmann::json;

constexpr int kLargestThumbnail = 512;
constexpr int kLargestPicture = 4096;
constexpr std::size_t kMostScans = 65536;

/// Pictures as data URIs. PNG: what JPEG adds would be taken for what the package lost.
class Pictures {
 public:
  std::string uri(const image::Image& picture) const {
    const fs::path file = scratch_.path() / "picture.png";
    image::writeImage(file, picture);
    return "data:image/png;base64," + io::base64(io::readFile(file, "a picture of the report"));
  }

 private:
  io::ScratchDirectory scratch_;
};

image::Image fromValues(int width, int height, int channels, const std::vector<float>& values) {
  image::Image picture{{width, height, channels, SampleType::kUint8}, {}};
  for (const float value : values) {
    picture.samples.push_back(static_cast<std::byte>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f))));
  }
  return picture;
}

/// Share of the scale as gray; texels that are not covered are transparent.
image::Image errorPicture(const ErrorPictures& pictures, const std::vector<float>& errors) {
  std::vector<float> values;
  const auto scale = static_cast<float>(std::max(pictures.scale, 1e-6));
  for (const float error : errors) {
    values.push_back(std::max(error, 0.0f) / scale);
    values.push_back(error < 0.0f ? 0.0f : 1.0f);
  }
  return fromValues(pictures.width, pictures.height, 2, values);
}

/// An image of the package at no more than kLargestThumbnail a side: means of step x step texels, of fewer where a side
/// is shorter than that. Opaque: four channels become three. Read some rows at a time: it may be of any size.
image::Image thumbnail(package::TextureReader reader) {
  const image::ImageShape& shape = reader.shape();
  const int step = (std::max(shape.width, shape.height) - 1) / kLargestThumbnail + 1;
  const int width = std::max(1, shape.width / step);
  const int height = std::max(1, shape.height / step);
  const int rows = std::min(step, shape.height);
  const int columns = std::min(step, shape.width);
  const int channels = shape.channels < 3 ? 1 : 3;
  image::Image band{{shape.width, rows, shape.channels, shape.type}, {}};
  band.samples.resize(static_cast<std::size_t>(rows) * shape.rowBytes());
  std::vector<float> values;
  for (int y = 0; y < height; ++y) {
    reader.readRows(y * step, y * step + rows, band.samples);
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        float sum = 0.0f;
        for (int row = 0; row < rows; ++row) {
          for (int column = x * step; column < x * step + columns; ++column) {
            sum += image::sampleAt(band, (static_cast<std::size_t>(row) * static_cast<std::size_t>(shape.width) +
                                          static_cast<std::size_t>(column)) *
                                                 static_cast<std::size_t>(shape.channels) +
                                             static_cast<std::size_t>(c));
          }
        }
        values.push_back(sum / static_cast<float>(rows * columns));
      }
    }
  }
  return fromValues(width, height, channels, values);
}

/// A colour for each mask, mixed by the masks.
image::Image maskPicture(const Package& package) {
  const PackageMasks& masks = *package.description().masks;
  const image::Image tiles =
      image::readImage(package::openImage(package.folder(), masks.file, package::masksShape(masks)));
  std::vector<float> values(static_cast<std::size_t>(masks.tile_width * masks.tile_height * 3), 0.0f);
  for (int k = 0; k < masks.count; ++k) {
    const float turn = static_cast<float>(k) * 0.618034f;
    for (std::size_t i = 0; i < values.size() / 3; ++i) {
      const int x = static_cast<int>(i) % masks.tile_width + k % masks.columns * masks.tile_width;
      const int y = static_cast<int>(i) / masks.tile_width + k / masks.columns * masks.tile_height;
      const float mask = image::sampleAt(tiles, static_cast<std::size_t>(y * tiles.shape.width + x));
      for (std::size_t c = 0; c < 3; ++c) {
        values[3 * i + c] += mask * (0.5f + 0.45f * std::cos(6.28319f * (turn + static_cast<float>(c) / 3.0f)));
      }
    }
  }
  return fromValues(masks.tile_width, masks.tile_height, 3, values);
}

/// Captured, decoded and error of every expression.
json comparisonJson(const ErrorPictures& collected, const Pictures& pictures) {
  json comparison = {{"map", collected.map}, {"scale", collected.scale}, {"expressions", json::array()}};
  for (std::size_t n = 0; n < collected.images.size(); ++n) {
    const auto face = [&](std::size_t i) {
      return pictures.uri(fromValues(collected.width, collected.height, 3, collected.images[n][i]));
    };
    comparison["expressions"].push_back({{"captured", face(0)},
                                         {"decoded", face(1)},
                                         {"error", pictures.uri(errorPicture(collected, collected.errors[n][0]))}});
  }
  return comparison;
}

json picturesJson(const Package& package, const Evaluation& evaluation, const Pictures& pictures) {
  json images = {{"maps", json::array()}, {"textures", json::array()}, {"weights", json::array()}};
  for (const ErrorPictures& collected : evaluation.pictures) {
    images["maps"].push_back(comparisonJson(collected, pictures));
  }
  const auto add = [&](const char* where, const std::string& title, const package::StoredTexture& texture) {
    images[where].push_back(
        {{"title", title}, {"src", pictures.uri(thumbnail(package::TextureReader(package.folder(), texture)))}});
  };
  for (const PackageMap& map : package.maps()) {
    add("textures", map.name + ": neutral", package::neutralTexture(map));
    for (int i = 0; i < package.differences(); ++i) {
      add("textures", fmt::format("{}: difference {}", map.name, i), package::differenceTexture(map, i));
    }
  }
  for (const PackageWeights& set : package.weightSets()) {
    for (std::size_t f = 0; f < set.files.size(); ++f) {
      const auto shape = package::atlasShape(set, package.differences(), static_cast<int>(f));
      add("weights", set.files[f], {set.files[f], std::nullopt, shape});
    }
  }
  if (package.description().masks) images["masks"] = pictures.uri(maskPicture(package));
  return images;
}

/// What was found of each scan, and its picture where there is one.
json registrationJson(const HtmlReportOptions& options, const Pictures& pictures) {
  if (options.registration_json.empty()) return nullptr;
  json registration = json::parse(options.registration_json);
  for (json& scan : registration["scans"]) {
    const std::string name = scan["name"];
    const fs::path file = options.capture / "registration" / (name + ".png");
    std::error_code error;
    if (io::nameFault(name) || !fs::exists(file, error)) continue;
    image::ImageReader reader(file);
    const image::ImageShape& shape = reader.shape();
    if (shape.channels != 3 || shape.type != SampleType::kUint8 || shape.width > kLargestPicture ||
        shape.height > kLargestPicture) {
      throw InputError({file.string(), "",
                        fmt::format("an 8-bit RGB picture of at most {} pixels a side", kLargestPicture), "another",
                        "register the scans again"});
    }
    scan["picture"] = pictures.uri(image::readImage(std::move(reader)));
  }
  return registration;
}

json searchJson(const Evaluation& evaluation) {
  if (!evaluation.search) return nullptr;
  json search = {{"cost", evaluation.search->cost}, {"convergence", evaluation.search->convergence}};
  if (evaluation.search->bound) {
    search["bound"] = *evaluation.search->bound;
    search["gap"] = evaluation.search->cost > 0.0
                        ? (evaluation.search->cost - *evaluation.search->bound) / evaluation.search->cost
                        : 0.0;
  }
  return search;
}

/// What the page calls the keys of the evaluation.
json titlesJson() {
  json titles = json::object();
  for (const auto& [key, title] : evaluationTitles()) titles[key] = title;
  return titles;
}

/// JSON inside a page: no end of a script can stand in it.
std::string forScript(const json& data) {
  std::string text = data.dump(-1, ' ', /*ensure_ascii=*/true);
  std::string escaped;
  for (const char c : text) escaped += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return escaped;
}

/// The text of a report of this kind, as its command wrote it.
std::string readReport(const fs::path& file, const std::string& kind) {
  const std::string expected = fmt::format("what `facezip {} --report` wrote", kind);
  std::string text = io::readFile(file, expected);
  const json report = io::parseJson(text, file.string());
  if (report.is_object() && report.value("facezip_report", json()) == kind) return text;
  throw InputError({file.string(), "", expected, "something else", ""});
}

}  // namespace

std::string readCompressReport(const fs::path& file) { return readReport(file, "compress"); }

std::string readRegistrationReport(const fs::path& file) {
  std::string text = readReport(file, "register");
  const json report = io::parseJson(text, file.string());
  for (const io::JsonField& scan : io::JsonField(report, file.string(), "")["scans"].elements(1, kMostScans)) {
    scan["name"].text();
  }
  return text;
}

void writeHtmlReport(const fs::path& file, const Package& package, const Evaluation& evaluation,
                     const HtmlReportOptions& options, Progress* progress) {
  assert(!evaluation.pictures.empty());
  const Pictures pictures;
  json data = {{"evaluation", json::parse(toJson(evaluation))},
               {"package", json::parse(package::packageJson(package.description()))},
               {"device", options.device},
               {"compress", options.compress_json.empty() ? json() : json::parse(options.compress_json)},
               {"registration", registrationJson(options, pictures)},
               {"titles", titlesJson()},
               {"search", searchJson(evaluation)},
               {"sweep", json::array()},
               {"note", ""},
               {"images", picturesJson(package, evaluation, pictures)}};
  for (const MaskSweepPoint& point : evaluation.mask_sweep) {
    data["sweep"].push_back({{"masks", point.masks}, {"rmse", point.rmse}});
  }
  std::string page(report::embeddedReportPage().at("report.html"));
  constexpr std::string_view kPlace = "@DATA@";
  page.replace(page.find(kPlace), kPlace.size(), forScript(data));
  writeReport(file, page, progress);
}

}  // namespace facezip
