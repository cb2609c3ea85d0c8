#include "flow/texture_flow.hpp"

namespace facezip::flow {

TextureFlow flowBetween(const GreyPicture& from, const GreyPicture& to) { return facezipOpenCvFlow()(from, to); }

}  // namespace facezip::flow
