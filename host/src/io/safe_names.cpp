#include "io/safe_names.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/composed.hpp"
#include "io/quoted.hpp"

namespace facezip::io {

std::optional<NameFault> nameFault(const std::string& name, const std::string& further) {
  constexpr std::size_t kLongest = 200;  // file systems stop at 255, and an extension follows
  const std::string refused = "/\\" + further;
  std::string expected = "a name without ";
  for (const char c : refused) expected += fmt::format("'{}', ", c);
  expected += "'..', a leading '.' or control characters";
  if (name.empty()) return NameFault{expected, "an empty name"};
  if (name.size() > kLongest) return NameFault{fmt::format("a name of at most {} bytes", kLongest), quoted(name)};
  if (!isUtf8(name)) return NameFault{"a name in UTF-8", quoted(name)};
  bool safe = name.front() != '.' && name.find("..") == std::string::npos;
  safe = safe && name.find_first_of(refused) == std::string::npos;
  for (const char c : name) safe = safe && static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
  if (!safe) return NameFault{expected, quoted(name)};
  return std::nullopt;
}

bool isUtf8(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

std::string fileSafeName(const JsonField& field) {
  const std::string name = io::composed(field.text());
  if (const auto fault = nameFault(name)) field.fail(fault->expected, fault->got);
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

}  // namespace facezip::io
