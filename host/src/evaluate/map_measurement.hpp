// map_measurement.hpp - packages decoded beside the captured textures of one map, band by band.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bands/tile_band.hpp"
#include "evaluate/error_distribution.hpp"
#include "evaluate/error_pictures.hpp"
#include "evaluate/package_decoder.hpp"

namespace facezip::evaluate {

/// Errors of one package on one map.
struct PackageErrors {
  std::vector<ErrorDistribution> texels;  ///< N, texel errors in 1/255
  std::vector<ErrorDistribution> angles;  ///< N, degrees; of normal maps only, else empty
  std::vector<ErrorDistribution> blends;  ///< R, texel errors of each weight vector

  ErrorDistribution pooledTexels() const;
  ErrorDistribution pooledAngles() const;
};

class MapMeasurement {
 public:
  struct Wanted {
    bool angles = false;                                ///< the map holds normals
    std::span<const std::vector<float>> blend_weights;  ///< R vectors of N
    PictureCollector* pictures = nullptr;               ///< takes what is decoded along
  };
  /// decoders  whose map is open already; kept by reference, like all of `wanted`
  MapMeasurement(std::vector<PackageDecoder*> decoders, int expressions, const Wanted& wanted);

  /// Adds rows [begin, end). samples, shape  as a MapBand has them; texels  the covered ones
  /// Throws InputError for damaged packages, DeviceError.
  void addBand(int begin, int end, std::span<const std::byte> samples, const compress::BandShape& shape,
               std::span<const std::uint32_t> texels);

  /// One per decoder.
  const std::vector<PackageErrors>& errors() const { return errors_; }

 private:
  void addExpression(std::size_t decoder, int expression, int begin, const compress::BandShape& shape,
                     std::span<const std::uint32_t> texels);
  void addBlends(std::span<const std::byte> samples, const compress::BandShape& shape,
                 std::span<const std::uint32_t> texels);

  std::vector<PackageDecoder*> decoders_;
  int expressions_;
  Wanted wanted_;
  std::vector<PackageErrors> errors_;
  std::vector<float> captured_;
  std::vector<float> decoded_;
  std::vector<float> texel_errors_;
};

}  // namespace facezip::evaluate
