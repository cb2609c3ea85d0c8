#include "package/safe_names.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "package/package_json.hpp"

namespace facezip::package {

std::string fileSafeName(const JsonField& field) {
  constexpr std::size_t kLongest = 200;  // file systems stop at 255, and an extension follows
  const std::string name = field.text();
  const std::string expected = "a name without '/', '\\', '..', a leading '.' or control characters";
  if (name.empty()) field.fail(expected, "an empty name");
  if (name.size() > kLongest) field.fail(fmt::format("a name of at most {} bytes", kLongest), quoted(name));
  bool safe = name.front() != '.' && name.find("..") == std::string::npos;
  for (const char c : name) safe = safe && static_cast<unsigned char>(c) >= 0x20 && c != 0x7f && c != '/' && c != '\\';
  if (!safe) field.fail(expected, quoted(name));
  return name;
}

std::string fileInPackage(const JsonField& field, const std::string& extension) {
  const std::string name = field.text();
  bool safe = !name.empty() && name.size() < 4096;
  std::size_t begin = 0;
  while (safe && begin <= name.size()) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    const std::string part = name.substr(begin, end - begin);
    safe = !part.empty() && part != "." && part.find("..") == std::string::npos;
    begin = end + 1;
  }
  for (const char c : name) safe = safe && static_cast<unsigned char>(c) >= 0x20 && c != 0x7f && c != '\\' && c != ':';
  if (!safe) field.fail("a path inside the package, without '..'", quoted(name));
  if (!name.ends_with(extension)) field.fail(fmt::format("the name of a {} file", extension), quoted(name));
  return name;
}

}  // namespace facezip::package
