# Writes OUTPUT, a C++ file that holds the text of every kernel file in KERNELS (ASCII only).
set(arrays "")
set(entries "")
foreach(kernel IN LISTS KERNELS)
  get_filename_component(name ${kernel} NAME)
  get_filename_component(identifier ${kernel} NAME_WE)
  # As bytes: brackets and semicolons are special in CMake strings, and a literal may not be as long as a kernel.
  file(READ ${kernel} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr char k_${identifier}[] = {${bytes}};\n")
  string(APPEND entries "      {\"${name}\", {k_${identifier}, sizeof(k_${identifier})}},\n")
endforeach()
file(WRITE ${OUTPUT} "// Generated from kernels/cl. Do not edit.
#include \"device/kernel_sources.hpp\"

namespace facezip::device {
namespace {

${arrays}
}  // namespace

const std::map<std::string_view, std::string_view>& embeddedKernelSources() {
  static const std::map<std::string_view, std::string_view> sources = {
${entries}  };
  return sources;
}

}  // namespace facezip::device
")
