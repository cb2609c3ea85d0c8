// load_module.hpp - parts of facezip that bring many libraries along, loaded when they are asked for.
#pragma once

namespace facezip::io {

/// Loads a module and finds what it exports. It is never unloaded: what it made may outlive the caller.
/// file  looked for where the program's or library's RUNPATH says
/// what  for the message: "which finds optical flow"
/// Throws Error.
void* loadModule(const char* file, const char* entry, const char* what);

}  // namespace facezip::io
