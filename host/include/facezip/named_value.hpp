// named_value.hpp - values of enumerations by name, as the command line, package.json and reports spell them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace facezip {

/// One value of an enumeration.
template <typename Value>
struct NamedValue {
  Value value;
  std::string_view name;   ///< "no-permutation"
  std::string_view title;  ///< what tables call it: "not permuted"
};

/// All values of an enumeration that has names, in the order that tables have them.
template <typename Value>
const std::vector<NamedValue<Value>>& namesOf();

template <typename Value>
std::string nameOf(Value value) {
  for (const NamedValue<Value>& entry : namesOf<Value>()) {
    if (entry.value == value) return std::string(entry.name);
  }
  return "";  // not reached: every value is in its table
}

/// The value of that name; none where no value has it.
template <typename Value>
std::optional<Value> findNamed(std::string_view name) {
  for (const NamedValue<Value>& entry : namesOf<Value>()) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

/// The names, for choices on a command line.
template <typename Value>
std::vector<std::string> allNames() {
  std::vector<std::string> names;
  for (const NamedValue<Value>& entry : namesOf<Value>()) names.emplace_back(entry.name);
  return names;
}

}  // namespace facezip
