#include "convert/shown_texels.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>

#include "io/counts.hpp"
#include "mesh/package_mesh.hpp"
#include "package/package_textures.hpp"
#include "raster/tiles.hpp"
#include "raster/uv_raster.hpp"
#include "scene/gltf_accessors.hpp"

namespace facezip::convert {
namespace {
using raster::kTileSide;

/// Sum over expressions of w w^T, mean of all cells, C by C: D^T of it D is about what a texel's frames differ by.
Eigen::MatrixXd meanProducts(const compress::EncodedWeights& weights, int textures) {
  const Eigen::Map<const Eigen::Array<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> codes(
      weights.codes.data(), static_cast<Eigen::Index>(weights.codes.size() / toSize(textures)), textures);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(textures, textures);
  Eigen::VectorXd w(textures);
  for (Eigen::Index row = 0; row < codes.rows(); ++row) {
    for (int i = 0; i < textures; ++i) {
      w[i] = weights.scale[toSize(i)] * static_cast<double>(codes(row, i)) + weights.offset[toSize(i)];
    }
    products += w * w.transpose();
  }
  return products;
}

/// Rows of the difference textures of a map as values, in units of 1/255.
class DifferenceRows {
 public:
  DifferenceRows(const Package& package, const PackageMap& map) : map_(map) {
    for (int i = 0; i < package.differences(); ++i) {
      readers_.emplace_back(package.folder(), package::differenceTexture(map, i));
    }
    values_.resize(readers_.size());
  }

  void read(int begin, int end) {
    for (std::size_t i = 0; i < readers_.size(); ++i) {
      const image::ImageShape& shape = readers_[i].shape();
      bytes_.resize(toSize(end - begin) * shape.rowBytes());
      readers_[i].readRows(begin, end, bytes_);
      decode(i, shape);
    }
  }

  /// C values, one a texture.
  double value(std::size_t texture, std::size_t sample) const { return static_cast<double>(values_[texture][sample]); }
  bool holdsSomething(std::size_t sample) const {
    return std::ranges::any_of(values_, [sample](const auto& texture) { return texture[sample] != 0.0f; });
  }
  std::size_t textures() const { return values_.size(); }

 private:
  void decode(std::size_t i, const image::ImageShape& shape) {
    const PackageDifference& difference = map_.differences[i];
    const bool wide = shape.type == SampleType::kUint16;
    const double code = wide && map_.difference_bits == 8 ? 257.0 : 1.0;  // samples to a code
    std::vector<float>& values = values_[i];
    values.resize(bytes_.size() / (wide ? 2 : 1));
    const auto channels = toSize(shape.channels);
    for (std::size_t s = 0; s < values.size(); ++s) {
      std::uint16_t sample = 0;
      if (wide) {
        std::memcpy(&sample, &bytes_[2 * s], sizeof(sample));
      } else {
        sample = std::to_integer<std::uint16_t>(bytes_[s]);
      }
      const double scale = difference.scale[s % channels];
      const double zero = scale > 0.0 ? std::round(-difference.offset[s % channels] / scale) : 0.0;
      const double codes = sample / code - zero;
      // Blocks hold zero to a fraction of a code.
      values[s] = std::abs(codes) < 0.5 ? 0.0f : static_cast<float>(scale * codes);
    }
  }

  const PackageMap& map_;
  std::vector<package::TextureReader> readers_;
  std::vector<std::byte> bytes_;
  std::vector<std::vector<float>> values_;  ///< [C][row][column][channel]
};

/// The surface that shows a map; none without a mesh.
std::optional<raster::UvRaster> rasterOf(const std::optional<geometry::TriangleMesh>& mesh, const PackageMap& map) {
  if (!mesh) return std::nullopt;
  std::vector<int> every(toSize(mesh->triangles.rows()));
  std::iota(every.begin(), every.end(), 0);
  return std::optional<raster::UvRaster>(std::in_place, *mesh, every, map.width, map.height, 0);
}

/// Which tiles of a row of tiles change. Adds to `energy`.
/// products  meanProducts()
std::vector<bool> changingTiles(const DifferenceRows& differences, const PackageMap& map, int rows,
                                const Eigen::MatrixXd& products, double& energy) {
  const auto channels = toSize(map.channels);
  std::vector<bool> changes(toSize(raster::tilesAlong(map.width)), false);
  Eigen::VectorXd d(products.rows());
  for (std::size_t s = 0; s < toSize(rows, map.width) * channels; ++s) {
    if (!differences.holdsSomething(s)) continue;
    changes[s / channels % toSize(map.width) / kTileSide] = true;
    for (std::size_t i = 0; i < differences.textures(); ++i) d[static_cast<Eigen::Index>(i)] = differences.value(i, s);
    energy += d.dot(products * d);
  }
  return changes;
}

/// Marks row y of a tile, and the cells below what is covered.
void markRow(const PackageMap& map, int y, int column, std::uint32_t shown, raster::TexelClasses& classes,
             std::span<std::uint8_t> row_of_cells) {
  const int left = column * kTileSide;
  const std::uint32_t inside = (1u << std::min(kTileSide, map.width - left)) - 1u;
  classes.mark(column, y, inside, shown & inside);
  for (int x = 0; x < kTileSide; ++x) {
    if (((shown & inside) >> x & 1u) != 0) row_of_cells[toSize((left + x) / map.weight_scale)] = 1;
  }
}

}  // namespace

ShownTexels findShownTexels(const Package& package, int map_index, const std::optional<geometry::TriangleMesh>& mesh,
                            const compress::EncodedWeights& weights, const compress::WeightSpace& space,
                            Progress& progress) {
  const PackageMap& map = package.maps()[toSize(map_index)];
  const std::optional<raster::UvRaster> raster = rasterOf(mesh, map);
  const Eigen::MatrixXd products =
      meanProducts(weights, space.textures) / static_cast<double>(space.columns) / static_cast<double>(space.rows);
  ShownTexels shown;
  shown.cells.resize(toSize(space.rows, space.columns), 0);
  auto classes = std::make_shared<raster::TexelClasses>(map.width, map.height);
  DifferenceRows differences(package, map);
  progress.stage("looking for texels that change: " + map.name, toSize(map.height));
  for (int begin = 0; begin < map.height; begin += kTileSide) {
    progress.checkCancelled();
    const int end = std::min(begin + kTileSide, map.height);
    differences.read(begin, end);
    const std::vector<bool> changes = changingTiles(differences, map, end - begin, products, shown.energy);
    std::optional<raster::TexelClasses> surface;
    if (raster) surface = raster::TexelClasses::coveredRows(*raster, begin, end);
    for (int y = begin; y < end; ++y) {
      const auto cells =
          std::span(shown.cells).subspan(toSize(y / map.weight_scale, space.columns), toSize(space.columns));
      for (int column = 0; column < static_cast<int>(changes.size()); ++column) {
        if (!changes[toSize(column)]) continue;
        markRow(map, y, column, surface ? surface->covered(column, y - begin) : ~0u, *classes, cells);
      }
    }
    progress.advance(toSize(end));
  }
  shown.classes = std::move(classes);
  return shown;
}

std::optional<geometry::TriangleMesh> uvMesh(const Package& package, std::uint64_t memory_bytes) {
  if (package.description().mesh_file.empty()) return std::nullopt;
  const mesh::PackageMesh found = mesh::readPackageMesh(package, memory_bytes);
  const nlohmann::json& primitive = found.document["meshes"][0]["primitives"][0];
  const nlohmann::json& attributes = primitive["attributes"];
  if (!attributes.contains("TEXCOORD_0")) return std::nullopt;
  const io::JsonField root(found.document, package.description().mesh_file, "");
  const scene::GltfAccessors accessors(root, found.buffer);
  const scene::Accessor& uvs = accessors[attributes["TEXCOORD_0"].get<std::size_t>()];
  const scene::Accessor& indices = accessors[primitive["indices"].get<std::size_t>()];
  if (!uvs.elements || uvs.sparse) return std::nullopt;
  geometry::TriangleMesh mesh;
  mesh.uvs.resize(static_cast<Eigen::Index>(uvs.count), 2);
  for (std::size_t v = 0; v < uvs.count; ++v) {
    // Outside of the map nothing is shown; UVs of glTF run down.
    mesh.uvs(static_cast<Eigen::Index>(v), 0) =
        std::clamp(static_cast<double>(uvs.elements->at<float>(v, 0)), 0.0, 1.0);
    mesh.uvs(static_cast<Eigen::Index>(v), 1) =
        1.0 - std::clamp(static_cast<double>(uvs.elements->at<float>(v, 1)), 0.0, 1.0);
  }
  mesh.triangles.resize(static_cast<Eigen::Index>(indices.count / 3), 3);
  for (std::size_t i = 0; i < indices.count; ++i) {
    mesh.triangles(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) =
        static_cast<int>(indices.elements->index(i, indices.component_type));
  }
  mesh.uv_triangles = mesh.triangles;
  return mesh;
}

}  // namespace facezip::convert
