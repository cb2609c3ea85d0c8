// texture_painter.hpp - paints the textures of a synthetic capture, band by band.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "image/image_file.hpp"
#include "synth/chart_raster.hpp"
#include "synth/head_mesh.hpp"
#include "synth/scanner.hpp"
#include "synth/skin.hpp"
#include "synth/skin_state.hpp"
#include "synth/wrinkles.hpp"

namespace facezip::synth {

enum class MapKind { kAlbedo, kNormal, kSpecular, kRoughness, kDisplacement };

struct MapFormat {
  MapKind kind;
  const char* name;
  int channels;
  image::SampleType type;
  const char* colour_space;
};

/// Every map that can be painted.
const std::vector<MapFormat>& mapFormats();

/// One texture's worth of subject: the neutral or an expression.
struct Performance {
  std::string name;
  std::vector<SkinState> states;  ///< #V
  double flush = 0.0;
  Scanner scanner;
};

/// What all textures of a capture share of the rows [begin, end): computed once, read by every expression.
struct SkinBand {
  struct Texel {
    MeshPoint point;
    SkinSample skin;
    float flush;  ///< how much a flush reddens this texel
    CreasePattern creases;
  };
  int begin = 0;
  int end = 0;
  std::vector<Texel> texels;  ///< (end - begin) * R, row-major
};

class TexturePainter {
 public:
  /// head, raster and fields are kept by reference.
  TexturePainter(const HeadMesh& head, std::uint64_t seed, int resolution);

  int resolution() const { return resolution_; }

  /// Fixed skin for painting the rows [begin, end): with a margin for resampling, in parallel over rows.
  SkinBand skinBand(int begin, int end) const;

  /// Samples of the rows [begin, end) of every map in `formats`, in the format each asks for. Reentrant.
  std::vector<std::vector<std::byte>> paint(const Performance& performance, const SkinBand& skin, int begin, int end,
                                            const std::vector<MapFormat>& formats) const;

 private:
  struct Planes;
  Planes paintSurface(const Performance& performance, const SkinBand& skin) const;
  Planes misaligned(const Performance& performance, const Planes& planes, int begin, int end) const;
  void encodeAlbedo(const Performance& performance, const Planes& planes, int begin, int end, std::byte* out) const;
  void encodeNormal(const Performance& performance, const SkinBand& skin, const Planes& planes, int begin, int end,
                    std::byte* out) const;
  void encodeGrey(const Planes& planes, int plane, int begin, int end, std::byte* out) const;
  void encodeDisplacement(const Planes& planes, int begin, int end, std::byte* out) const;
  SkinState stateAt(const Performance& performance, const MeshPoint& point) const;

  const HeadMesh& head_;
  int resolution_;
  ChartRaster raster_;
  Skin skin_;
  CreaseField creases_;
};

}  // namespace facezip::synth
