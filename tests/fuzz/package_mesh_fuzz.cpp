// mesh.glb: what is let through keeps the rules, also as facezip writes it.
#include <cstdlib>

#include "fuzz_input.hpp"
#include "mesh/package_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const mesh::PackageMesh found = mesh::parsePackageMesh(fuzz::textOf(data, size), "mesh.glb");
    try {
      const mesh::PackageMesh again = mesh::parsePackageMesh(mesh::packageMeshFile(found), "again.glb");
      if (again.vertices != found.vertices || again.targets != found.targets) std::abort();
    } catch (const InputError&) {
      std::abort();
    }
  });
  return 0;
}
