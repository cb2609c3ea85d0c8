// fbx_reader.hpp - where assimp is: linked, or in a module that is loaded for the first FBX file.
#pragma once

#include "scene/fbx_scene.hpp"

namespace facezip::scene {

/// Throws Error where the module cannot be loaded.
FbxFunction fbxReader();

}  // namespace facezip::scene
