# Writes OUTPUT, a C++ file that holds the text of every file in FILES (ASCII only) and defines
#   const std::map<std::string_view, std::string_view>& NAMESPACE::FUNCTION()
# by file name; HEADER declares it.
set(arrays "")
set(entries "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  string(MAKE_C_IDENTIFIER ${name} identifier)
  # As bytes: brackets and semicolons are special in CMake strings, and a literal may not be as long as a kernel.
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr char k_${identifier}[] = {${bytes}};\n")
  string(APPEND entries "      {\"${name}\", {k_${identifier}, sizeof(k_${identifier})}},\n")
endforeach()
file(WRITE ${OUTPUT} "// Generated. Do not edit.
#include \"${HEADER}\"

namespace ${NAMESPACE} {
namespace {

${arrays}
}  // namespace

const std::map<std::string_view, std::string_view>& ${FUNCTION}() {
  static const std::map<std::string_view, std::string_view> files = {
${entries}  };
  return files;
}

}  // namespace ${NAMESPACE}
")
