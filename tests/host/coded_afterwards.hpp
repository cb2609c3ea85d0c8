// coded_afterwards.hpp - what closing the loop is compared with: a package's textures coded as they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "blocks/block_decoder.hpp"
#include "blocks/block_encoder.hpp"
#include "image/image_file.hpp"
#include "package/package_textures.hpp"
#include "test_device.hpp"

namespace facezip::test {

/// Puts what blocks decode to in the place of each texture of the first map, three channels of 8 bits, without another
/// look at what is blended from them.
inline void codeAfterwards(const std::filesystem::path& package, BlockFormat format) {
  const Package images = Package::open(package);
  blocks::EncoderOptions options;
  options.format = format;
  const auto encoder = blocks::makeBlockEncoder(testDevice().context(), options);
  const auto decoder = blocks::makeBlockDecoder(format, 3);
  const auto recode = [&](const package::StoredTexture& texture) {
    image::Image image = package::readTexture(images.folder(), texture);
    const image::ImageShape& shape = image.shape;
    std::vector<std::byte> coded(blocks::blockBytes(format, shape.width, shape.height));
    const std::span samples(reinterpret_cast<std::uint8_t*>(image.samples.data()), image.samples.size());
    encoder->encode({shape.width, shape.height, 3, std::span<const std::uint8_t>(samples), {}}, coded, {});
    decoder->decode(shape.width, shape.height, coded, samples);
    image::writeImage(package / texture.file, image);
  };
  recode(package::neutralTexture(images.maps()[0]));
  for (int i = 0; i < images.differences(); ++i) recode(package::differenceTexture(images.maps()[0], i));
}

}  // namespace facezip::test
