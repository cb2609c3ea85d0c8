#include "image/image_format.hpp"

namespace facezip::image {

AnyFormat& anyFormat() { return facezipOpenImageIo(); }

}  // namespace facezip::image
