#include "device/kernel_sources.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "facezip/device.hpp"
#include "io/read_file.hpp"

namespace facezip::device {
namespace {

/// The text of one file: of FACEZIP_KERNEL_DIR where that has it, else as it was built in.
std::string textOf(std::string_view name) {
  if (const char* folder = std::getenv("FACEZIP_KERNEL_DIR")) {
    if (!std::filesystem::is_directory(folder)) {
      throw InputError({"FACEZIP_KERNEL_DIR", "", "a folder with kernel files", folder, "unset it for those built in"});
    }
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    std::error_code error;
    if (std::filesystem::exists(file, error)) return io::readFile(file, "a kernel file");
  }
  const auto& embedded = embeddedKernelSources();
  const auto found = embedded.find(name);
  if (found == embedded.end()) throw DeviceError(fmt::format("kernel file {}", name), 0, "not part of this build");
  return std::string(found->second);
}

/// Appends a file with what it includes, each file once. Build logs name files and their own lines.
void append(const std::string& name, std::set<std::string>& seen, std::string& out) {
  constexpr std::string_view kInclude = "#include \"";
  if (!seen.insert(name).second) return;
  const std::string text = textOf(name);
  out += fmt::format("#line 1 \"{}\"\n", name);
  int line_number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++line_number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    if (line.starts_with(kInclude)) {
      append(std::string(line.substr(kInclude.size(), line.rfind('"') - kInclude.size())), seen, out);
      out += fmt::format("#line {} \"{}\"\n", line_number + 1, name);
    } else {
      out.append(line).push_back('\n');
    }
    begin = end + 1;
  }
}

}  // namespace

std::string kernelSource(std::string_view file_name) {
  std::set<std::string> seen;
  std::string source;
  append(std::string(file_name), seen, source);
  return source;
}

}  // namespace facezip::device
