// compress_stretch.hpp - compress and stretch maps (Li et al. 2020, section 5; Oat 2007), as a method beside FaceZip's.
// A package of them is blended like any other: T_C - T_N and T_S - T_N are its two difference textures, the normalised
// influences its weight maps, and Eq. 14 is then FaceZip's Eq. 8 with C = 2.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "compress/texture_source.hpp"
#include "facezip/geometry/mesh.hpp"
#include "io/counts.hpp"
#include "raster/uv_raster.hpp"
#include "refine/difference_fit.hpp"
#include "refine/grid_weights.hpp"

namespace facezip::compress {

inline constexpr int kCompressStretchMaps = 2;
/// The influences of Eq. 10 and 11 are lengths, so the exp of Eq. 12 would depend on the mesh's unit. They are taken in
/// units of this share of the mean edge length E_N of their vertex: an expression that compresses the skin by so much
/// more than another counts e times as much.
inline constexpr double kInfluenceUnit = 0.05;

/// Influences of N expressions at every vertex: |E_N - E_P| where edges get shorter (column 2 n, Eq. 10) or longer (2 n
/// + 1, Eq. 11), over kInfluenceUnit E_N. #V by 2 N, unitless, >= 0; 0 where E_N is 0. expressions  N positions
Eigen::MatrixXd vertexInfluences(const geometry::TriangleMesh& neutral,
                                 const std::vector<Eigen::MatrixX3d>& expressions);

/// Shares of a whole at the cells of a weight grid: of either map they add up to 1 over the members in every cell.
struct InfluenceShares {
  int members = 0;            ///< expressions, or shapes of a rig
  int columns = 0;            ///< cells of a row
  std::vector<float> shares;  ///< [cell][2][member]; a cell without any is all 0

  std::size_t cells() const { return shares.size() / toSize(kCompressStretchMaps * members); }
  /// As many code steps to a share of 1, 255 at least, as leave a code to the largest share of `map`.
  int steps(int map) const;
};

/// Influences at the cells of the weight grid, interpolated from the vertices at the texel nearest to each cell's
/// centre and normalised over the members (Eq. 12). Cells without covered texels copy the nearest cell that has some.
/// scale  texels per cell and axis, of the raster
InfluenceShares normalisedInfluences(const geometry::TriangleMesh& neutral, const Eigen::MatrixXd& influences,
                                     const raster::UvRaster& raster, int scale);

/// Codes of shares of which `steps` make 1, each less than one code off: [member][cell][2]. In every cell the codes
/// of a map add up to its steps exactly, for Eq. 13 is a mean only where shares add up to 1. Rounded one by one they
/// would not: a hundred shares of 1/100 are 2.55 codes each, and three codes each are 18 % too many. Which of them are
/// rounded up differs from cell to cell, so that no expression is favoured.
std::vector<std::uint8_t> shareCodes(const InfluenceShares& shares, const std::array<int, kCompressStretchMaps>& steps);

/// The shares as a package holds them, in the finest codes that they allow.
EncodedWeights encodeShares(const InfluenceShares& shares);

/// Eq. 13 on the device. Returned textures: [tile][2][channel][256] float.
class CompressStretchTextures : public TextureSource {
 public:
  /// influences  kept by reference
  CompressStretchTextures(device::DeviceContext& context, const WeightSpace& space, const EncodedWeights& influences,
                          device::KernelVariant variant = device::KernelVariant::kAuto);
  TileMasks tiles(const OpenMap& map, int begin, int end) const override;
  const cl::Buffer& compute(const GridMap& map, const MapBand& band) override;

 private:
  const EncodedWeights& influences_;
  device::DeviceContext& context_;
  bool gpu_;
  WeightWindow window_;
  device::PooledBuffer textures_;
};

/// Launches compress_stretch.cl on a band. window  holds the cells that the band interpolates between
void launchCompressStretch(device::DeviceContext& context, const GridBand& band, const WeightWindow& window, bool gpu,
                           const cl::Buffer& textures);

}  // namespace facezip::compress
