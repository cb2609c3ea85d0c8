// run_command.hpp - runs the facezip command and keeps what it says.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace facezip::test {

struct CommandResult {
  int exit_code = -1;
  std::string out;
  std::string error;
};

/// Runs `facezip arguments` in a shell, standard output and error in pipes.
/// before  what stands before the command: variables, another program that runs it
CommandResult runFacezip(const std::string& arguments, const std::string& before = "");

/// Quotes a path for the shell.
std::string quoted(const std::filesystem::path& path);

/// Every file and directory below `folder`, hidden ones too.
std::set<std::string> filesBelow(const std::filesystem::path& folder);

}  // namespace facezip::test
