// compress_options.hpp - what of the options can be refused before anything is read.
#pragma once

#include "facezip/compress.hpp"

namespace facezip::compress {

/// Throws InputError that names the option, where one is out of its range or does not go with another.
void requireSaneOptions(const CompressOptions& options);

}  // namespace facezip::compress
