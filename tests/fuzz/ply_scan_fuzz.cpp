// Scans as PLY: what is read has finite numbers, and indices in range.
#include <cstdlib>

#include "facezip/geometry/textured_mesh.hpp"
#include "fuzz_file.hpp"
#include "fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const geometry::TexturedMesh read = geometry::readTexturedPly(fuzz::fileOf("scan.ply", data, size));
    const geometry::TriangleMesh& mesh = read.mesh;
    const auto inRange = [](const Eigen::MatrixX3i& indices, Eigen::Index rows) {
      return indices.minCoeff() >= 0 && indices.maxCoeff() < rows;
    };
    const bool good = mesh.positions.allFinite() && mesh.uvs.allFinite() && read.colours.allFinite() &&
                      mesh.triangles.rows() > 0 && inRange(mesh.triangles, mesh.positions.rows()) &&
                      (mesh.uv_triangles.rows() == 0 || inRange(mesh.uv_triangles, mesh.uvs.rows())) &&
                      (read.colours.rows() == 0 || read.colours.rows() == mesh.positions.rows());
    if (!good) std::abort();
    for (const int material : read.materials) {
      if (material < 0 || static_cast<std::size_t>(material) >= read.textures.size()) std::abort();
    }
  });
  return 0;
}
