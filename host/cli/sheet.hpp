// sheet.hpp - pictures in a grid with labels above them, written as one image.
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <filesystem>
#include <string>

namespace facezip::cli {

class Sheet {
 public:
  /// columns, rows  of pictures of picture_width x picture_height pixels
  /// header         pixels to leave free above the pictures
  Sheet(int columns, int rows, int picture_width, int picture_height, int header = 0);

  /// Puts `picture`, RGB in [0, 1], and its label at a place of the grid.
  void place(int column, int row, const OIIO::ImageBuf& picture, const std::string& label);
  /// Puts a picture or a text at pixels from the upper left corner; a text stands on row y.
  void paste(int x, int y, const OIIO::ImageBuf& picture);
  void write(int x, int y, const std::string& text);

  static constexpr int gap() { return 6; }
  int width() const { return image_.spec().width; }

  /// Writes the sheet, in the format of the extension, so that a reader sees all of it or none. Throws OutputError.
  void save(const std::filesystem::path& file) const;

 private:
  int picture_width_;
  int picture_height_;
  int header_;
  OIIO::ImageBuf image_;
};

}  // namespace facezip::cli
