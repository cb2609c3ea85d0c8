// texture_source.hpp - where the difference textures that are written come from: the paper's clusters, or a fit to the
// weights as they are decoded.
#pragma once

#include <span>
#include <vector>

#include "bands/map_bands.hpp"
#include "bands/map_set.hpp"
#include "codes/coded_textures.hpp"
#include "codes/map_codes.hpp"
#include "raster/texel_masks.hpp"
#include "refine/difference_fit.hpp"
#include "refine/grid_weights.hpp"
#include "search/difference_texture.hpp"

namespace facezip::compress {

class TextureSource {
 public:
  virtual ~TextureSource() = default;
  /// Tiles of rows [begin, end) of a map, with what compute() needs of masks.
  virtual TileMasks tiles(const OpenMap& map, int begin, int end) const = 0;
  /// Difference textures of a band, [tile][C][channel][256] float in units of 1/255. The next call overwrites them.
  virtual const cl::Buffer& compute(const GridMap& map, const MapBand& band) = 0;
};

/// FaceZip, Eq. 5.
class ClusterTextures : public TextureSource {
 public:
  ClusterTextures(device::DeviceContext& context, const raster::TexelMasks& masks,
                  const TextureCoefficients& coefficients)
      : masks_(masks), textures_(context, coefficients) {}
  TileMasks tiles(const OpenMap& map, int begin, int end) const override {
    return masks_.tiles(*map.raster, begin, end, raster::TexelMasks::Texels::kCoveredAndGutter);
  }
  const cl::Buffer& compute(const GridMap&, const MapBand& band) override {
    return textures_.compute(band.tiles, band.differences, band.shape);
  }

 private:
  const raster::TexelMasks& masks_;
  DifferenceTextures textures_;
};

/// What textures that were fitted leave.
class MeasuredTextures {
 public:
  /// Squared error over the covered texels of all bands so far, in (1/255)^2, before frames are rounded.
  double squaredError() const { return squared_error_; }

 protected:
  ~MeasuredTextures() = default;
  double squared_error_ = 0.0;
};

/// The textures that suit the weights as they are decoded, rounded to their codes (difference_fit.hpp).
class FittedTextures final : public TextureSource, public MeasuredTextures {
 public:
  /// weights, codes  are kept by reference; the codes are the map's
  FittedTextures(device::DeviceContext& context, const WeightSpace& space, const EncodedWeights& weights,
                 const MapCodes& codes);
  TileMasks tiles(const OpenMap& map, int begin, int end) const override;
  const cl::Buffer& compute(const GridMap& map, const MapBand& band) override;

 private:
  const EncodedWeights& weights_;
  const MapCodes& codes_;
  float ridge_;
  WeightWindow window_;
  DifferenceFit fit_;
};

/// The textures in blocks that suit the weights as they are decoded (coded_textures.hpp).
class BlockTextures final : public MeasuredTextures {
 public:
  /// weights  is kept by reference
  BlockTextures(device::DeviceContext& context, const WeightSpace& space, const EncodedWeights& weights,
                const MapCodes& codes, int channels);
  TileMasks tiles(const OpenMap& map, int begin, int end) const;
  /// Fits and codes a band whose differences are to the decoded neutral; rows as CodedTextures::compute() wants them.
  void compute(const GridMap& map, const MapBand& band);
  /// Blocks of a texture of that band.
  std::span<const std::byte> blocks(int texture) const { return textures_.blocks(texture); }

 private:
  const EncodedWeights& weights_;
  float ridge_;
  WeightWindow window_;
  CodedTextures textures_;
};

}  // namespace facezip::compress
