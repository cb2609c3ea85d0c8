#include "capture/capture_meshes.hpp"

#include <utility>

#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/topology.hpp"
#include "io/quoted.hpp"

namespace facezip {
namespace {

scene::MorphMesh readNeutral(const Capture& capture) {
  if (scene::isSceneFile(capture.neutral_mesh)) return scene::readMorphMesh(capture.neutral_mesh, capture.mesh_name);
  scene::MorphMesh alone;
  alone.neutral = geometry::readObj(capture.neutral_mesh);
  return alone;
}

}  // namespace

CaptureMeshes::CaptureMeshes(Capture capture) : capture_(std::move(capture)), morphs_(readNeutral(capture_)) {
  if (!capture_.tile || morphs_.neutral.uvs.rows() == 0) return;
  const int tile = *capture_.tile - kFirstTile;
  morphs_.neutral.uvs.rowwise() -= Eigen::RowVector2d(tile % kTilesInRow, tile / kTilesInRow);
}

Eigen::MatrixX3d CaptureMeshes::positions(std::size_t expression) const {
  const std::filesystem::path& file = capture_.expression_meshes[expression];
  const std::string& name = capture_.expressions[expression];
  if (scene::isSceneFile(file)) {
    const auto found = morphs_.positions.find(name);
    if (file == capture_.neutral_mesh && found != morphs_.positions.end()) return found->second;
    throw InputError({file.string(), "expression " + io::quoted(name),
                      "a morph target of the file that has the neutral", "none", ""});
  }
  geometry::TriangleMesh mesh = geometry::readObj(file);
  if (capture_.tile.value_or(kFirstTile) != kFirstTile) mesh.uv_triangles.resize(0, 3);  // in the tile or moved from it
  geometry::requireSameTopology(morphs_.neutral, capture_.neutral_mesh.string(), mesh, file.string());
  return std::move(mesh.positions);
}

}  // namespace facezip
