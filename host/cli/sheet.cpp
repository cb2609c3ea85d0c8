#include "sheet.hpp"

#include <OpenImageIO/imagebufalgo.h>

#include <cstddef>
#include <vector>

#include "facezip/error.hpp"
#include "facezip/frame_file.hpp"

namespace facezip::cli {
namespace fs = std::filesystem;
namespace {

constexpr int kLabel = 22;

}  // namespace

Sheet::Sheet(int columns, int rows, int picture_width, int picture_height, int header)
    : picture_width_(picture_width),
      picture_height_(picture_height),
      header_(header),
      image_(OIIO::ImageSpec(columns * (picture_width + gap()) + gap(),
                             header + rows * (picture_height + kLabel + gap()) + gap(), 3, OIIO::TypeDesc::UINT8)) {
  OIIO::ImageBufAlgo::fill(image_, {0.13f, 0.13f, 0.14f});
}

void Sheet::place(int column, int row, const OIIO::ImageBuf& picture, const std::string& label) {
  const int x = gap() + column * (picture_width_ + gap());
  const int y = header_ + gap() + row * (picture_height_ + kLabel + gap());
  paste(x, y + kLabel, picture);
  write(x + 2, y + kLabel - 6, label);
}

void Sheet::paste(int x, int y, const OIIO::ImageBuf& picture) {
  OIIO::ImageBufAlgo::paste(image_, x, y, 0, 0, picture);
}

void Sheet::write(int x, int y, const std::string& text) {
  // Text needs a font; a sheet without labels is still worth having.
  OIIO::ImageBufAlgo::render_text(image_, x, y, text, 14, "DejaVuSans", {0.9f, 0.9f, 0.9f});
}

void Sheet::save(const fs::path& file) const {
  const OIIO::ImageSpec& spec = image_.spec();
  std::vector<std::byte> samples(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) * 3);
  if (!image_.get_pixels(OIIO::ROI(0, spec.width, 0, spec.height, 0, 1, 0, 3), OIIO::TypeDesc::UINT8, samples.data())) {
    throw OutputError(file, image_.geterror());
  }
  writePicture(file, spec.width, spec.height, samples);
}

}  // namespace facezip::cli
