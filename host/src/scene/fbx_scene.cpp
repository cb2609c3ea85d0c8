#include "scene/fbx_scene.hpp"

#include "io/read_file.hpp"
#include "scene/fbx_reader.hpp"

namespace facezip::scene {

std::vector<SceneMesh> readFbx(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
  return fbxReader()(io::readFile(file, "an FBX file", "", kMostBytes), file.string());
}

}  // namespace facezip::scene
