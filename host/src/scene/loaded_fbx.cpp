// loaded_fbx.cpp - assimp as a module that is loaded for the first FBX file.
#include "io/load_module.hpp"
#include "scene/fbx_reader.hpp"

namespace facezip::scene {

FbxFunction fbxReader() {
  static const FbxFunction reader = reinterpret_cast<FbxFunction (*)()>(
      io::loadModule(FACEZIP_FBX_MODULE, kAssimpFbxEntry, "which reads FBX files"))();
  return reader;
}

}  // namespace facezip::scene
