// loaded_flow.cpp - OpenCV as a module that is loaded by the commands that need it.
#include "flow/texture_flow.hpp"
#include "io/load_module.hpp"

namespace facezip::flow {

TextureFlow flowBetween(const GreyPicture& from, const GreyPicture& to) {
  static const FlowFunction between = reinterpret_cast<FlowFunction (*)()>(
      io::loadModule(FACEZIP_FLOW_MODULE, kOpenCvFlowEntry, "which finds how textures slide"))();
  return between(from, to);
}

}  // namespace facezip::flow
