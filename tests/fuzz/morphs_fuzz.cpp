// Captures in one GLB file: what is read has finite positions, indices in range, and targets of as many vertices.
// FBX is not among these: assimp reads it, whose own fuzzers are where its faults are found.
#include <cstdlib>

#include "fuzz_file.hpp"
#include "fuzz_input.hpp"
#include "scene/morph_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const scene::MorphMesh read = scene::readMorphMesh(fuzz::fileOf("head.glb", data, size), "");
    const geometry::TriangleMesh& mesh = read.neutral;
    const bool good = mesh.positions.allFinite() && mesh.triangles.rows() > 0 && mesh.triangles.minCoeff() >= 0 &&
                      mesh.triangles.maxCoeff() < mesh.positions.rows() && mesh.uv_triangles.minCoeff() >= 0 &&
                      mesh.uv_triangles.maxCoeff() < mesh.uvs.rows();
    if (!good) std::abort();
    for (const auto& [name, positions] : read.positions) {
      if (name.empty() || positions.rows() != mesh.positions.rows() || !positions.allFinite()) std::abort();
    }
  });
  return 0;
}
