#include "run_command.hpp"

#include <sys/wait.h>

#include <cstdlib>

#include "file_contents.hpp"
#include "temporary_directory.hpp"

namespace facezip::test {
namespace fs = std::filesystem;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

CommandResult runFacezip(const std::string& arguments, const std::string& before) {
  const TemporaryDirectory folder;
  const std::string command = before + " " + quoted(FACEZIP_COMMAND) + " " + arguments + " >" + quoted(folder / "out") +
                              " 2>" + quoted(folder / "error") + " </dev/null";
  const int status = std::system(command.c_str());
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  result.out = contentsOf(folder / "out");
  result.error = contentsOf(folder / "error");
  return result;
}

std::set<std::string> filesBelow(const fs::path& folder) {
  std::set<std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    files.insert(entry.path().lexically_relative(folder).string());
  }
  return files;
}

}  // namespace facezip::test
