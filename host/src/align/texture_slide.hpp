// texture_slide.hpp - rounds of optical flow in the layout, until an expression's texture lies on the neutral's.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "align/slide_field.hpp"
#include "device/device_context.hpp"
#include "facezip/alignment.hpp"
#include "image/image_file.hpp"

namespace facezip::align {

struct Slide {
  SlideField field;
  AlignedExpression found;
};

/// The neutral's picture, that the expressions' are laid on.
class TextureSlide {
 public:
  /// neutral  the neutral's texture
  /// region   triangles of the mesh whose textures are compared
  /// Throws InputError.
  TextureSlide(const geometry::TriangleMesh& mesh, std::span<const int> region, const std::filesystem::path& neutral,
               device::DeviceContext& context, Progress& progress);

  int width() const { return shape_.width; }

  /// name, texture  of the expression. Throws InputError, DeviceError, Cancelled, Error.
  Slide slideOf(const std::string& name, const std::filesystem::path& texture) const;

 private:
  struct Grey {
    image::Image image;  ///< one channel of floats
    std::span<const float> values() const;
  };
  Grey readGrey(const std::filesystem::path& file) const;
  double differenceFrom(std::span<const float> grey) const;

  int factor_;
  image::ImageShape shape_;  ///< of the pictures that flow is taken of
  LayoutTexels texels_;
  Grey neutral_;
  device::DeviceContext& context_;
  Progress& progress_;
};

}  // namespace facezip::align
