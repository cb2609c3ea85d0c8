#include "scene/fbx_reader.hpp"

namespace facezip::scene {

FbxFunction fbxReader() { return facezipAssimpFbx(); }

}  // namespace facezip::scene
