#include "compress/face_guides.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "facezip/geometry/float_origin.hpp"
#include "mesh/gltf_scene.hpp"
#include "package/guides.hpp"
#include "package/package_json.hpp"

namespace facezip::compress {
namespace {

std::size_t size(int value) { return static_cast<std::size_t>(value); }

/// A UV of each vertex: that of the first triangle corner that has it.
std::vector<std::array<double, 2>> sampleUvs(const Face& face, const FaceMasks& masks) {
  std::vector<int> corner(size(static_cast<int>(face.mesh.positions.rows())), -1);
  for (const int t : face.region) {
    for (int c = 0; c < 3; ++c) {
      int& uv = corner[size(face.mesh.triangles(t, c))];
      if (uv < 0) uv = face.mesh.uv_triangles(t, c);
    }
  }
  std::vector<std::array<double, 2>> uvs;
  for (const int sample : masks.samples.vertices) {
    const int uv = corner[size(masks.region.mesh_vertices[size(sample)])];
    uvs.push_back({face.mesh.uvs(uv, 0), face.mesh.uvs(uv, 1)});
  }
  return uvs;
}

/// Mask k is tile k; cells are means of `step` x `step` cells of the grid.
PackageMasks layOut(const FaceMasks& masks, const raster::GridMasks& grid, int step) {
  PackageMasks out;
  out.file = package::kMasksFile;
  out.count = masks.masks.mask_count;
  out.tile_width = (grid.columns + step - 1) / step;
  out.tile_height = (grid.rows + step - 1) / step;
  const double square = std::sqrt(static_cast<double>(out.count) * out.tile_height / out.tile_width);
  out.columns = std::clamp(static_cast<int>(std::ceil(square)), 1, out.count);
  out.rows = (out.count - 1) / out.columns + 1;
  return out;
}

image::Image drawMasks(const PackageMasks& masks, const raster::GridMasks& grid, int step) {
  image::Image picture{package::masksShape(masks), {}};
  const std::size_t width = size(picture.shape.width);
  std::vector<float> sums(width * size(picture.shape.height), 0.0f);
  std::vector<float> cells(size(masks.tile_width) * size(masks.tile_height), 0.0f);
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      const std::size_t cell = size(y) * size(grid.columns) + size(x);
      cells[size(y / step) * size(masks.tile_width) + size(x / step)] += 1.0f;
      for (int e = grid.cells.cell_begin[cell]; e < grid.cells.cell_begin[cell + 1]; ++e) {
        const int k = grid.cells.mask_index[size(e)];
        const std::size_t row = size(k / masks.columns * masks.tile_height + y / step);
        sums[row * width + size(k % masks.columns * masks.tile_width + x / step)] += grid.cells.mask_weights[size(e)];
      }
    }
  }
  picture.samples.resize(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const std::size_t x = i % width % size(masks.tile_width);
    const std::size_t y = i / width % size(masks.tile_height);
    const float mean = sums[i] / cells[y * size(masks.tile_width) + x];
    picture.samples[i] = static_cast<std::byte>(std::lround(255.0f * std::clamp(mean, 0.0f, 1.0f)));
  }
  return picture;
}

std::vector<PackageRegion> nameRegions(const FaceMasks& masks) {
  constexpr const char* kNames[3][3] = {
      {"lower right", "lower", "lower left"}, {"right", "centre", "left"}, {"upper right", "upper", "upper left"}};
  const Eigen::RowVector3d low = masks.region.positions.colwise().minCoeff();
  const Eigen::RowVector3d extent = masks.region.positions.colwise().maxCoeff() - low;
  const auto third = [&](int sample, int axis) {
    if (extent(axis) <= 0.0) return 1;
    const double share = (masks.region.positions(sample, axis) - low(axis)) / extent(axis);
    return std::clamp(static_cast<int>(3.0 * share), 0, 2);
  };
  std::array<std::array<std::vector<int>, 3>, 3> cells;
  for (std::size_t k = 0; k < masks.samples.vertices.size(); ++k) {
    const int sample = masks.samples.vertices[k];
    cells[size(third(sample, 1))][size(third(sample, 0))].push_back(static_cast<int>(k));
  }
  std::vector<PackageRegion> regions;
  for (const std::size_t row : {2u, 1u, 0u}) {  // as one reads a face: from the top, the subject's right first
    for (std::size_t column = 0; column < 3; ++column) {
      if (!cells[row][column].empty()) regions.push_back({kNames[row][column], cells[row][column]});
    }
  }
  return regions;
}

}  // namespace

MaskGuides makeMaskGuides(const Face& face, const FaceMasks& masks, const raster::GridMasks& grid) {
  int step = (std::max(grid.columns, grid.rows) - 1) / package::kMostMaskCells + 1;
  MaskGuides guides;
  const auto fits = [&guides] {
    const image::ImageShape shape = package::masksShape(guides.masks);
    return std::max(shape.width, shape.height) <= package::kMaxAtlasSide;
  };
  for (guides.masks = layOut(masks, grid, step); !fits();) guides.masks = layOut(masks, grid, ++step);
  guides.masks.samples = sampleUvs(face, masks);
  guides.regions = nameRegions(masks);
  guides.picture = drawMasks(guides.masks, grid, step);
  return guides;
}

void writeFaceMesh(const Capture& capture, const Face& face, std::optional<geometry::LengthUnit> unit,
                   const std::vector<Eigen::MatrixX3f>& expressions, const std::filesystem::path& directory) {
  mesh::GltfScene scene;
  scene.name = capture.name.empty() ? "face" : capture.name;
  scene.neutral = face.mesh;
  // In floats, as the expressions are: what does not move is then exactly 0.
  scene.origin = geometry::floatOrigin(face.mesh.positions);
  scene.neutral.positions = (face.mesh.positions.rowwise() - scene.origin).cast<float>().cast<double>();
  scene.metres_per_unit = unit ? geometry::metresPerUnit(*unit) : 1.0;  // no head: its own unit will do
  for (std::size_t n = 0; n < expressions.size(); ++n) {
    if (expressions[n].rows() == 0) continue;
    scene.targets.push_back({capture.expressions[n], expressions[n].cast<double>()});
  }
  mesh::writeGltf(directory / package::kMeshFile, scene);
}

}  // namespace facezip::compress
