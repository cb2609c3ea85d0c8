#include "usage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "facezip/nearest_names.hpp"

namespace facezip::cli {
namespace {

/// "; did you mean X?", where a name is near enough to be meant.
std::string question(const std::string& given, const std::vector<std::string>& names) {
  const std::vector<std::string> nearest = nearestNames(given, names, 1);
  const auto most = static_cast<int>(std::max<std::size_t>(2, given.size() / 3));
  if (nearest.empty() || editDistance(given, nearest.front()) > most) return "";
  return fmt::format("; did you mean {}?", nearest.front());
}

std::vector<std::string> commandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

/// "--output", ...
std::vector<std::string> optionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// The first option that neither the command nor facezip itself has; "" where there is none.
std::string unknownOption(const std::vector<std::string>& arguments, const std::vector<std::string>& names) {
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    if (!argument.starts_with("--")) continue;
    const std::string name = argument.substr(0, argument.find('='));
    if (std::ranges::find(names, name) == names.end()) return name;
  }
  return "";
}

}  // namespace

std::string usageFault(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const auto word = std::ranges::find_if(arguments, [](const std::string& a) { return !a.starts_with('-'); });
  if (word == arguments.end()) return "a command is required";
  const std::vector<std::string> commands = commandNames(app);
  if (std::ranges::find(commands, *word) == commands.end()) {
    return fmt::format("there is no command \"{}\"{}", *word, question(*word, commands));
  }
  const CLI::App* command = app.get_subcommand(*word);
  std::vector<std::string> options = optionNames(*command);
  for (const std::string& name : optionNames(app)) options.push_back(name);
  const std::string unknown = unknownOption(arguments, options);
  if (!unknown.empty()) return fmt::format("{} has no option {}{}", *word, unknown, question(unknown, options));
  const bool excludes = dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr;
  return error.what() + std::string(excludes ? ": leave one of them out" : "");
}

}  // namespace facezip::cli
