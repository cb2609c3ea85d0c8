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
    // tinyobjloader rounds the last digit of some numbers another way than they are written.
    constexpr double kLastDigits = 1e-12;
    require(copy.triangles == mesh.triangles && copy.positions.isApprox(mesh.positions, kLastDigits));
    require(copy.uvs.rows() == mesh.uvs.rows() && (mesh.uvs.rows() == 0 || copy.uvs.isApprox(mesh.uvs, kLastDigits)));
    geometry::requireSameTopology(mesh, "mesh", mesh, "mesh");
  });
  return 0;
}
