// package.hpp - a compressed capture on disk: what docs/package_format.md says, as C++ values.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "facezip/block_format.hpp"
#include "facezip/error.hpp"
#include "facezip/protected_paths.hpp"
#include "facezip/sample_type.hpp"

namespace facezip {

namespace io {
class Folder;
}

/// One difference texture D_i of one map: an image of 8- or 16-bit codes that decode to D_i = scale * code + offset. Of
/// one in blocks, a code is 255 times what a sampler returns; it may lie between whole numbers.
struct PackageDifference {
  std::string file;                        ///< relative to the package
  std::vector<double> scale;               ///< one per channel, >= 0, in units of 1/255 of full scale for each code
  std::vector<double> offset;              ///< one per channel, -scale times a whole code, in double: zero is exact
  std::optional<BlockFormat> format = {};  ///< of the blocks of a KTX2 file; none: a PNG
};

/// One map (albedo, normal, ...): its neutral texture I_0 and its difference textures.
struct PackageMap {
  std::string name;                             ///< names the map's folder too
  int width = 0;                                ///< texels
  int height = 0;                               ///< texels; row 0 is v = 1
  int channels = 0;                             ///< 1 to 4, interleaved
  SampleType sample_type = SampleType::kUint8;  ///< of the neutral, and so of every frame that is blended from it
  std::string colour_space;                     ///< "sRGB", "linear" or "" (not said)
  int weight_scale = 8;                         ///< s: texels to a cell of the weight maps, along each axis
  int weight_set = 0;                           ///< which of Package::weightSets() this map is blended with
  double metric_weight = 1.0;                   ///< how much the map counted in the compression
  std::string neutral_file;                     ///< relative to the package
  std::optional<BlockFormat> neutral_format;    ///< of the blocks of a KTX2 file; none: an image
  int difference_bits = 8;                      ///< of a code of the difference textures: 8 or 16
  std::vector<PackageDifference> differences;   ///< C, in the order of the weight channels

  /// Bytes of a whole neutral texture, or of a blended frame: height x width x channels samples, no padding.
  std::size_t frameBytes() const;
};

/// A set of weight maps: W_n of all expressions, C channels a cell, one tile an expression, in one image (two above
/// C = 4). Maps share one set, or have sets of their own.
struct PackageWeights {
  std::vector<std::string> files;  ///< relative to the package; file f holds channels 4 f to 4 f + 3
  int columns = 0;                 ///< tiles in a row of the atlas; expression n is tile n in row-major order
  int rows = 0;
  int tile_width = 0;  ///< cells of one weight map, without the border
  int tile_height = 0;
  int border = 1;              ///< cells around a tile that repeat its edge
  std::vector<double> scale;   ///< C; W = scale * code + offset
  std::vector<double> offset;  ///< C
};

/// Masks M_k of the method on a grid of at most 128 cells a side, one tile a mask in one gray image, 255 = 1: where
/// gains of regions act, and what viewers show. Frames do not need them.
struct PackageMasks {
  std::string file;  ///< relative to the package
  int count = 0;     ///< K
  int columns = 0;   ///< tiles in a row; mask k is tile k in row-major order, without borders
  int rows = 0;
  int tile_width = 0;                          ///< cells over the width of a map
  int tile_height = 0;                         ///< cells over its height
  std::vector<std::array<double, 2>> samples;  ///< K, UV of the vertex that each mask was laid around, v up
};

/// A part of the face that people can name: the sum of some masks.
struct PackageRegion {
  std::string name;
  std::vector<int> masks;  ///< indices into the masks, each in one region at most
};

/// How parts of the head that move, but whose texture does not, look (eyes, teeth, lashes).
struct PackageMaterial {
  /// What a texture's alpha, and `opacity`, do.
  enum class Alpha { kOpaque, kMask, kBlend };  ///< nothing; a texel is there from 0.5 on; how much of it is there

  std::string name;                          ///< unique
  std::array<double, 3> colour = {1, 1, 1};  ///< 0 to 1, linear light; times the texture
  double opacity = 1.0;                      ///< 0 to 1; times the texture's alpha
  Alpha alpha = Alpha::kOpaque;
  double roughness = 0.6;  ///< 0 to 1
  std::string texture;     ///< PNG of 8 bits, relative to the package, sRGB; 2 or 4 channels have alpha. "" for none
  int width = 0;           ///< of the texture, texels
  int height = 0;
  int channels = 0;  ///< 1 to 4
};

/// Parts beyond the captured skin: a mesh of a primitive for each material, with the morph targets of the package's
/// mesh.
struct PackageParts {
  std::string file;                        ///< glTF 2.0 binary
  std::vector<PackageMaterial> materials;  ///< of the mesh's primitives, in their order
};

/// All that package.json says.
struct PackageDescription {
  std::string generator;                 ///< "facezip X.Y.Z", what wrote it
  std::string name;                      ///< the capture's
  std::vector<std::string> expressions;  ///< N names in the order of the weight vector beta
  int differences = 4;                   ///< C, 1 to 8
  std::vector<PackageWeights> weights;   ///< at least one; each is used by a map
  std::vector<PackageMap> maps;
  std::string mesh_file;               ///< glTF 2.0 binary, neutral and morph targets; "" where there is none
  std::optional<PackageParts> parts;   ///< with a mesh
  std::optional<PackageMasks> masks;   ///< with regions
  std::vector<PackageRegion> regions;  ///< empty without masks
  /// EXPERIMENTAL: a JSON object that records how the package was made; its fields may change in any version.
  std::string method_json = "{}";
};

/// A package on disk that was found to be whole. Holds the description only; texels are read when they are needed.
class Package {
 public:
  /// Opens the package in `directory` (its package.json is accepted as well) and checks every field of package.json,
  /// and of every image that it exists, has the size, channels and type that package.json says and is not cut short.
  /// Damage inside an image that keeps its length is found when its texels are read. All files are read from the folder
  /// that is found now, and stay open as long as the Package lives: it is one package, even while another is renamed to
  /// its place. Links in it are refused.
  /// Throws InputError that names the file, the field as a JSON path ("maps[0].width"), and what was expected.
  static Package open(const std::filesystem::path& directory);

  const std::filesystem::path& directory() const noexcept { return directory_; }
  /// Whether another package took this one's place. What is read of it is its own, never the other's; of a package of
  /// more than 256 files some may be gone, and reading them throws InputError: open the package again.
  bool wasReplaced() const;
  const PackageDescription& description() const noexcept { return description_; }
  const std::string& name() const noexcept { return description_.name; }
  /// N names in the order of the weight vector.
  const std::vector<std::string>& expressions() const noexcept { return description_.expressions; }
  const std::vector<PackageMap>& maps() const noexcept { return description_.maps; }
  /// Index of the map of that name. Throws InputError that lists the names there are.
  int mapIndex(const std::string& map_name) const;
  /// C, the number of difference textures of each map.
  int differences() const noexcept { return description_.differences; }
  /// Sets of weight maps: one that all maps share, or several; PackageMap::weight_set counts in them.
  const std::vector<PackageWeights>& weightSets() const noexcept { return description_.weights; }
  /// EXPERIMENTAL: how the package was made, a JSON object.
  const std::string& methodJson() const noexcept { return description_.method_json; }

  /// Bytes of the texels that a renderer keeps (FaceZip, Table 1): per map 1 + C textures (in blocks as they are; of
  /// images the neutral in its own type, differences in their 8 or 16 bits), and of each set N weight maps of C bytes a
  /// cell without their borders. Mip levels, a third more, are not counted.
  std::uint64_t bytesInMemory() const;
  /// Bytes of all files of the package.
  std::uint64_t bytesOnDisk() const noexcept { return bytes_on_disk_; }

  /// The open folder, for facezip's own sources: all of a package is read from there.
  const io::Folder& folder() const noexcept { return *folder_; }

 private:
  Package() = default;
  static Package openOnce(const std::filesystem::path& directory);

  std::filesystem::path directory_;
  std::shared_ptr<const io::Folder> folder_;
  PackageDescription description_;
  std::uint64_t bytes_on_disk_ = 0;
};

/// The package's directory.
ProtectedPaths inputsOf(const Package& package);

/// Opens a package and returns what `use(package)` does. Where another package takes its place before `use` has read
/// all that it needs, which it then says by an InputError, the same with that one.
template <typename Use>
auto withPackage(const std::filesystem::path& directory, const Use& use) {
  constexpr int kMostTries = 20;
  for (int tries = 1;; ++tries) {
    const Package package = Package::open(directory);
    try {
      return use(package);
    } catch (const InputError&) {
      if (tries == kMostTries || !package.wasReplaced()) throw;
    }
  }
}

}  // namespace facezip
