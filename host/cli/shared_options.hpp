// shared_options.hpp - options that several commands take, declared once.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "facezip/compress.hpp"
#include "facezip/package.hpp"

namespace facezip::cli {

/// --device
void addDeviceOption(CLI::App& command, std::string& selector);
/// --memory, as text for parseBytes()
void addMemoryOption(CLI::App& command, std::string& memory);
/// --seed; `seed` must outlive the parsing
void addSeedOption(CLI::App& command, std::uint64_t& seed, const std::string& description);
/// -o, --output of a package
void addPackageOutputOption(CLI::App& command, std::string& output);
/// --report FILE. what  the report holds: "what was done"
void addReportOption(CLI::App& command, std::string& report, const std::string& what);
/// --maps a,b
void addMapsOption(CLI::App& command, std::vector<std::string>& maps, const std::string& description);
/// --eyes NAME, of commands that put a template's eyes into a head.
void addEyesOption(CLI::App& command, std::string& eyes);

/// The maps of a package, to open its capture with: other folders of that do not matter then.
std::vector<std::string> mapNames(const Package& package);

/// The value of --texture-format: none for "png". Throws InputError. also  further names, for the message
std::optional<BlockFormat> parseBlockFormat(const std::string& name, const std::string& also = "");

/// The texts behind CompressOptions, before they are parsed.
struct CompressArguments {
  std::string method = "refined";
  std::string permutation_solver = "best";
  std::string weight_sets = "auto";
  std::string texture_format = "png";
  std::string difference_format;
  std::string mask_radius = "3cm";
  std::optional<int> masks;
  std::optional<double> target_rmse;
  std::string budget;
  std::string unit;
  std::string memory = "2GiB";
  std::optional<int> gutter;
  std::optional<int> feather;
  CompressOptions options;
};
void addCompressOptions(CLI::App& command, CompressArguments& arguments);
/// Throws InputError naming the option.
CompressOptions parseCompressOptions(const CompressArguments& arguments);

}  // namespace facezip::cli
