#include "error_sheet.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <string>
#include <vector>

#include "facezip/evaluate.hpp"
#include "sheet.hpp"

namespace facezip::cli {
namespace {

constexpr int kHeader = 78;
constexpr int kBarWidth = 256;
constexpr int kBarHeight = 14;

OIIO::ImageBuf imageOf(int width, int height, int channels, const std::vector<float>& values) {
  OIIO::ImageBuf image(OIIO::ImageSpec(width, height, channels, OIIO::TypeDesc::FLOAT));
  image.set_pixels(OIIO::ROI(0, width, 0, height, 0, 1, 0, channels), OIIO::TypeDesc::FLOAT, values.data());
  return image;
}

/// Shares of the scale in [0, 1] in colours that rise in brightness, so that the picture reads in grey as well.
OIIO::ImageBuf falseColours(int width, int height, const std::vector<float>& shares) {
  return OIIO::ImageBufAlgo::color_map(imageOf(width, height, 1, shares), 0, "inferno");
}

/// Errors in false colours; pixels without a covered texel are dark grey.
OIIO::ImageBuf errorImage(const ErrorPictures& pictures, const std::vector<float>& errors) {
  std::vector<float> shares(errors.size());
  const auto scale = static_cast<float>(std::max(pictures.scale, 1e-6));
  for (std::size_t i = 0; i < errors.size(); ++i) shares[i] = std::clamp(errors[i] / scale, 0.0f, 1.0f);
  OIIO::ImageBuf image = falseColours(pictures.width, pictures.height, shares);
  const float uncovered[] = {0.2f, 0.2f, 0.21f};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (errors[i] >= 0.0f) continue;
    const int pixel = static_cast<int>(i);
    image.setpixel(pixel % pictures.width, pixel / pictures.width, uncovered);
  }
  return image;
}

void drawLegend(Sheet& sheet, const ErrorPictures& pictures) {
  std::vector<float> ramp(static_cast<std::size_t>(kBarWidth) * kBarHeight);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<float>(i % kBarWidth) / (kBarWidth - 1);
  const int x = Sheet::gap();
  sheet.write(x + 2, 18, fmt::format("{}: error of a texel in 1/255; figures above are RMSE", pictures.map));
  sheet.paste(x, 28, falseColours(kBarWidth, kBarHeight, ramp));
  const int y = 28 + kBarHeight + 16;
  sheet.write(x + 2, y, "0");
  sheet.write(x + kBarWidth / 2 - 10, y, fmt::format("{:.3g}", pictures.scale / 2));
  sheet.write(x + kBarWidth - 50, y, fmt::format("{:.3g}+", pictures.scale));
}

const Evaluation::Map& mapOf(const Evaluation& evaluation) {
  return *std::find_if(evaluation.maps.begin(), evaluation.maps.end(),
                       [&](const Evaluation::Map& map) { return map.name == evaluation.pictures.front().map; });
}

}  // namespace

void writeErrorSheet(const std::filesystem::path& file, const Evaluation& evaluation,
                     const std::vector<std::string>& titles) {
  assert(!evaluation.pictures.empty());
  const ErrorPictures& pictures = evaluation.pictures.front();
  const auto methods = static_cast<int>(pictures.methods.size());
  // The legend needs its width even above the thumbnails of a tiny map.
  const int columns = std::max(1 + 2 * methods, (kBarWidth + Sheet::gap()) / (pictures.width + Sheet::gap()) + 1);
  Sheet sheet(columns, static_cast<int>(evaluation.expressions.size()), pictures.width, pictures.height, kHeader);
  drawLegend(sheet, pictures);
  for (std::size_t n = 0; n < evaluation.expressions.size(); ++n) {
    const int row = static_cast<int>(n);
    const auto image = [&](std::size_t i) {
      return imageOf(pictures.width, pictures.height, 3, pictures.images[n][i]);
    };
    sheet.place(0, row, image(0), evaluation.expressions[n]);
    for (int m = 0; m < methods; ++m) {
      const auto at = static_cast<std::size_t>(m);
      const std::string& title = titles[at];
      const double rmse = mapOf(evaluation).rmse.at(pictures.methods[at]).per_expression[n];
      sheet.place(1 + m, row, image(at + 1), title);
      sheet.place(1 + methods + m, row, errorImage(pictures, pictures.errors[n][at]),
                  fmt::format("{}: {:.2f}", title, rmse));
    }
  }
  sheet.save(file);
}

}  // namespace facezip::cli
