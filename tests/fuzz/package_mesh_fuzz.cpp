// mesh.glb, and parts.glb, which is alike: what is let through keeps the rules, also as facezip writes it.
#include <cstdlib>

#include "fuzz_input.hpp"
#include "mesh/package_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const mesh::PackageMesh found = mesh::parsePackageMesh(fuzz::textOf(data, size), "mesh.glb");
    try {
      const PackageParts parts{"parts.glb", {PackageMaterial()}};
      mesh::parsePackageParts(fuzz::textOf(data, size), parts.file, parts, found);  // a part with the same targets
      const mesh::PackageMesh again = mesh::parsePackageMesh(mesh::packageMeshFile(found), "again.glb");
      if (again.vertices != found.vertices || again.targets != found.targets) std::abort();
    } catch (const InputError&) {
      std::abort();
    }
  });
  fuzz::refuseOrRead([&] {
    const PackageParts parts{"parts.glb", {PackageMaterial(), PackageMaterial()}};
    mesh::PackageMesh still;  // without targets
    still.document["meshes"] = nlohmann::json::array({nlohmann::json::object()});
    mesh::parsePackageParts(fuzz::textOf(data, size), parts.file, parts, still);
  });
  return 0;
}
