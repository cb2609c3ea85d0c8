#include "contact_sheet.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sheet.hpp"

namespace facezip::cli {
namespace fs = std::filesystem;
namespace {

constexpr int kTile = 256;
constexpr int kShownExpressions = 8;

/// Reads an image as RGB at the size of a tile.
OIIO::ImageBuf tile(const fs::path& file) {
  OIIO::ImageBuf image(file.string());
  if (!image.read(0, 0, true, OIIO::TypeDesc::FLOAT)) {
    throw InputError({file.string(), "", "a readable image", image.geterror(), ""});
  }
  const int channels = image.nchannels();
  const int order[3] = {0, channels >= 3 ? 1 : 0, channels >= 3 ? 2 : 0};
  image = OIIO::ImageBufAlgo::channels(image, 3, order);
  return OIIO::ImageBufAlgo::resize(image, "", 0.0f, OIIO::ROI(0, kTile, 0, kTile, 0, 1, 0, 3));
}

OIIO::ImageBuf amplifiedDifference(const OIIO::ImageBuf& a, const OIIO::ImageBuf& b) {
  constexpr float kGain = 8.0f;
  const OIIO::ImageBuf difference = OIIO::ImageBufAlgo::sub(b, a);
  return OIIO::ImageBufAlgo::add(OIIO::ImageBufAlgo::mul(difference, kGain), 0.5f);
}

}  // namespace

void writeContactSheet(const fs::path& file, const Capture& capture, const Package& package, const fs::path& decoded) {
  const CaptureMap& map = capture.maps.front();
  const PackageMap& packed = package.maps()[static_cast<std::size_t>(package.mapIndex(map.name))];
  const int textures = package.differences();
  const int shown = std::min<int>(kShownExpressions, static_cast<int>(capture.expressions.size()));
  Sheet sheet(std::max(6, textures + 1), 1 + (shown + 1) / 2, kTile, kTile);
  sheet.place(0, 0, tile(package.directory() / packed.neutral_file), "neutral");
  for (int i = 0; i < textures; ++i) {
    sheet.place(i + 1, 0, tile(package.directory() / packed.differences[static_cast<std::size_t>(i)].file),
                fmt::format("difference texture {}", i));
  }
  for (int i = 0; i < shown; ++i) {
    const std::size_t n = static_cast<std::size_t>(i) * capture.expressions.size() / static_cast<std::size_t>(shown);
    const std::string& name = capture.expressions[n];
    const OIIO::ImageBuf original = tile(map.expressions[n]);
    const OIIO::ImageBuf restored = tile(decoded / map.name / (name + ".png"));
    const int column = i % 2 * 3;  // two expressions in a row
    const int row = 1 + i / 2;
    sheet.place(column, row, original, name);
    sheet.place(column + 1, row, restored, "from the package");
    sheet.place(column + 2, row, amplifiedDifference(original, restored), "difference x 8");
  }
  sheet.save(file);
}

}  // namespace facezip::cli
