// Meshes: what is read has finite coordinates and indices in range, and comes back from the file that it is written to.
#include <cstdlib>

#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/topology.hpp"
#include "fuzz_file.hpp"
#include "fuzz_input.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const geometry::TriangleMesh mesh = geometry::readObj(fuzz::fileOf("mesh.obj", data, size));
    require(mesh.positions.allFinite() && mesh.uvs.allFinite() && mesh.triangles.rows() > 0);
    require(mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < mesh.positions.rows());
    require(mesh.polygons.size() == static_cast<std::size_t>(mesh.triangles.rows()));
    require(mesh.uv_triangles.rows() == 0 ||
            (mesh.uv_triangles.rows() == mesh.triangles.rows() && mesh.uv_triangles.minCoeff() >= 0 &&
             mesh.uv_triangles.maxCoeff() < mesh.uvs.rows()));
    const std::filesystem::path again = fuzz::folder() / "again.obj";
    geometry::writeObj(again, mesh);
    const geometry::TriangleMesh copy = geometry::readObj(again);
    require(copy.positions == mesh.positions && copy.triangles == mesh.triangles && copy.uvs == mesh.uvs);
    geometry::requireSameTopology(mesh, "mesh", mesh, "mesh");
  });
  return 0;
}
