// exit_codes.hpp - what the exit status of the command means; docs/command_line.md lists them for scripts.
#pragma once

namespace facezip::cli {

enum ExitCode : int {
  kExitSuccess = 0,
  kExitInternal = 1,     ///< a failure that facezip does not understand
  kExitUsage = 2,        ///< the command line
  kExitInput = 3,        ///< a file or value of the input
  kExitDevice = 4,       ///< no OpenCL device, or it failed
  kExitOutput = 5,       ///< the output could not be written
  kExitSolver = 6,       ///< a linear system was not solved
  kExitCancelled = 130,  ///< Ctrl-C, as shells report it
};

}  // namespace facezip::cli
