// sample_type.hpp - how the samples of a texture are kept.
#pragma once

namespace facezip {

/// Other types on disk are widened: half to float, 32-bit integers to float.
enum class SampleType {
  kUint8,    ///< 0..255
  kUint16,   ///< 0..65535
  kFloat32,  ///< full scale is 1
};

}  // namespace facezip
