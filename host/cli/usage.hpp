// usage.hpp - what to say of a command line that is wrong.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace facezip::cli {

/// What is wrong, and what was meant or what to do: CLI11 says of a misspelt command that one is required.
std::string usageFault(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv);

}  // namespace facezip::cli
