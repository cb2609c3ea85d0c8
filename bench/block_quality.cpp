// block_quality - what formats of blocks cost and keep: bytes, error and speed of every encoder, on images or on a
// procedural picture. Figures of docs/block_formats.md.
//   block_quality [IMAGE...] [--formats bc7,astc-6x6] [--qualities fast,normal,best] [--channels N] [--repeats N]
//                 [--astc SEARCH[:ENOUGH[:plain]]...]
// With several images errors are of all their texels together. --astc adds rows of libastcenc at such an effort
// (AstcEffort of block_encoder.hpp); ENOUGH 0 is libastcenc's own.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "blocks/block_encoder.hpp"
#include "blocks/block_texture.hpp"
#include "facezip/device.hpp"
#include "image/image_file.hpp"
#include "photograph_like.hpp"

namespace facezip::bench {
namespace {

using blocks::BlockFormat;
using blocks::Quality;

double processSeconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

struct Picture {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> texels;  // code units
};

Picture readPicture(const std::string& file) {
  const image::Image image = image::readImage(file);
  Picture picture{image.shape.width, image.shape.height, image.shape.channels, {}};
  const std::size_t samples = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) *
                              static_cast<std::size_t>(picture.channels);
  for (std::size_t i = 0; i < samples; ++i) picture.texels.push_back(255.0f * image::sampleAt(image, i));
  return picture;
}

Picture proceduralPicture(int side) {
  const std::vector<std::uint8_t> bytes = test::photographLike(side, side);
  return {side, side, 3, {bytes.begin(), bytes.end()}};
}

Picture firstChannels(const Picture& picture, int channels) {
  Picture part{picture.width, picture.height, channels, {}};
  const auto all = static_cast<std::size_t>(picture.channels);
  for (std::size_t p = 0; p < picture.texels.size() / all; ++p) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
      part.texels.push_back(picture.texels[p * all + c]);
    }
  }
  return part;
}

struct Row {
  double squared_error = 0.0;
  double samples = 0.0;
  double texels = 0.0;
  double bytes = 0.0;
  double seconds = 0.0;  // of processors
};

/// The best of some repeats: the first one compiles.
void measure(blocks::BlockEncoder& encoder, BlockFormat format, const Picture& picture, int repeats, Row& row) {
  std::vector<std::byte> coded(blocks::blockBytes(format, picture.width, picture.height));
  std::vector<float> decoded(picture.texels.size());
  const blocks::TexelRows rows{.width = picture.width,
                               .rows = picture.height,
                               .channels = picture.channels,
                               .samples = std::span<const float>(picture.texels),
                               .weights = {}};
  encoder.encode(rows, coded, decoded);
  double least = 1e9;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const double begin = processSeconds();
    encoder.encode(rows, coded, {});
    least = std::min(least, processSeconds() - begin);
  }
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    const double rest = static_cast<double>(picture.texels[i]) - static_cast<double>(decoded[i]);
    row.squared_error += rest * rest;
  }
  row.samples += static_cast<double>(decoded.size());
  row.texels += static_cast<double>(picture.width) * picture.height;
  row.bytes += static_cast<double>(coded.size());
  row.seconds += least;
}

struct Arguments {
  std::vector<std::string> images;
  std::vector<std::string> formats = {"bc1", "bc7", "astc-4x4", "astc-5x5", "astc-6x6", "astc-8x8", "astc-10x10"};
  std::vector<std::string> qualities = {"fast", "normal", "best"};
  std::vector<std::string> astc;
  int channels = 3;
  int side = 1024;
  int repeats = 2;
};

blocks::AstcEffort effortOf(const std::string& text) {
  const std::vector<std::string> words = CLI::detail::split(text, ':');
  blocks::AstcEffort effort{.search = std::stof(words.at(0))};
  if (words.size() > 1 && std::stof(words[1]) > 0.0f) effort.enough = std::stof(words[1]);
  effort.plain = words.size() > 2;
  return effort;
}

void measureRow(const Arguments& arguments, const std::vector<Picture>& pictures, const Device& device,
                const std::string& name, const blocks::EncoderOptions& options) {
  Row row;
  const auto encoder = blocks::makeBlockEncoder(device.context(), options);
  for (const Picture& picture : pictures) {
    measure(*encoder, options.format, firstChannels(picture, options.channels), arguments.repeats, row);
  }
  const double rmse = std::sqrt(row.squared_error / row.samples);
  fmt::print("| {} | {} | {:.2f} | {:.3f} | {:.2f} | {:.2f} |\n", blocks::infoOf(options.format).name, name,
             8.0 * row.bytes / row.texels, rmse, 20.0 * std::log10(255.0 / rmse), row.texels / row.seconds / 1e6);
  std::fflush(stdout);
}

void run(const Arguments& arguments) {
  std::vector<Picture> pictures;
  for (const std::string& image : arguments.images) pictures.push_back(readPicture(image));
  if (pictures.empty()) pictures.push_back(proceduralPicture(arguments.side));
  const Device device = openDevice();
  fmt::print("| format | effort | bits a texel | RMSE | PSNR | Mtexel/cpu-s |\n|---|---|---|---|---|---|\n");
  for (const std::string& name : arguments.formats) {
    const BlockFormat format = blocks::blockFormatOf(name, "--formats");
    int channels = std::min(arguments.channels, blocks::infoOf(format).max_channels);
    for (const Picture& picture : pictures) channels = std::min(channels, picture.channels);
    for (const auto& [quality, word] :
         {std::pair{Quality::kFast, "fast"}, {Quality::kNormal, "normal"}, {Quality::kBest, "best"}}) {
      if (std::count(arguments.qualities.begin(), arguments.qualities.end(), word) == 0) continue;
      measureRow(arguments, pictures, device, word, {.format = format, .channels = channels, .quality = quality});
    }
    for (const std::string& effort : blocks::isAstc(format) ? arguments.astc : std::vector<std::string>()) {
      blocks::EncoderOptions options{.format = format, .channels = channels};
      options.quality = Quality::kFast;
      options.astc_effort = effortOf(effort);
      measureRow(arguments, pictures, device, "libastcenc " + effort, options);
    }
  }
}

}  // namespace
}  // namespace facezip::bench

int main(int argc, char** argv) {
  facezip::bench::Arguments arguments;
  CLI::App app("what formats of blocks cost and keep");
  app.add_option("images", arguments.images, "images; none: a procedural picture");
  app.add_option("--formats", arguments.formats, "names of formats")->delimiter(',');
  app.add_option("--qualities", arguments.qualities, "fast, normal, best")->delimiter(',');
  app.add_option("--astc", arguments.astc, "efforts of libastcenc beside them");
  app.add_option("--channels", arguments.channels, "the first channels of the images");
  app.add_option("--side", arguments.side, "texels along a side of the procedural picture");
  app.add_option("--repeats", arguments.repeats, "runs, of which the quickest counts");
  CLI11_PARSE(app, argc, argv);
  try {
    facezip::bench::run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "block_quality: {}\n", error.what());
    return 1;
  }
  return 0;
}
