#include "package/footprint.hpp"

#include <set>

#include "io/read_file.hpp"
#include "package/package_json.hpp"

namespace facezip::package {
namespace fs = std::filesystem;
namespace {

std::vector<fs::path> filesIn(const fs::path& directory) {
  const fs::path file = directory / kDescriptionFile;
  try {
    std::vector<std::string> files =
        filesOf(parsePackageJson(io::readFile(file, "the description of a package"), file.string()));
    files.insert(files.end(), {"rig.json", "rig.gltf", "rig.bin", "shapes", "parts"});  // of a rig (docs/rig.md)
    return {files.begin(), files.end()};
  } catch (const InputError& error) {
    throw OutputError(directory, error.what(), "choose another --output, or remove the damaged package");
  }
}

}  // namespace

std::vector<std::string> filesOf(const PackageDescription& description) {
  std::vector<std::string> files = {kDescriptionFile};
  if (!description.mesh_file.empty()) files.push_back(description.mesh_file);
  if (description.parts) {
    files.push_back(description.parts->file);
    for (const PackageMaterial& material : description.parts->materials) {
      if (!material.texture.empty()) files.push_back(material.texture);
    }
  }
  if (description.masks) files.push_back(description.masks->file);
  for (const PackageWeights& set : description.weights) files.insert(files.end(), set.files.begin(), set.files.end());
  for (const PackageMap& map : description.maps) {
    files.push_back(map.neutral_file);
    for (const PackageDifference& difference : map.differences) files.push_back(difference.file);
  }
  std::set<std::string> seen;
  std::erase_if(files, [&](const std::string& file) { return !seen.insert(file).second; });
  return files;
}

io::Footprint footprint() { return {kDescriptionFile, "\"facezip-package\"", filesIn}; }

}  // namespace facezip::package
