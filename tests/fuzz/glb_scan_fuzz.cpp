// Scans as GLB: what is read has finite positions, and indices in range.
#include <cstdlib>

#include "fuzz_file.hpp"
#include "fuzz_input.hpp"
#include "register/glb_scan.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const registration::GlbScan scan = registration::readGlbScan(fuzz::fileOf("scan.glb", data, size));
    const geometry::TriangleMesh& mesh = scan.textured.mesh;
    if (!mesh.positions.allFinite() || mesh.triangles.rows() == 0 || mesh.triangles.minCoeff() < 0 ||
        mesh.triangles.maxCoeff() >= mesh.positions.rows()) {
      std::abort();
    }
  });
  return 0;
}
