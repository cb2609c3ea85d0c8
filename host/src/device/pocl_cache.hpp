// pocl_cache.hpp - the folder that PoCL wants before it shows any device.
#pragma once

#include <string>

namespace facezip::device {

/// PoCL keeps kernels in POCL_CACHE_DIR, else below XDG_CACHE_HOME or HOME, and where that folder cannot be written to
/// it has no device at all: in a container, of a service without a home. Then it gets a folder for this process alone.
/// To be called before the first call of OpenCL; sets POCL_CACHE_DIR in the environment where it has to.
void givePoclAPlace();

/// Why PoCL has no device, where it is that: a sentence for the user. Empty where its folder can be written to.
std::string poclCacheFault();

}  // namespace facezip::device
