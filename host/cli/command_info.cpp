#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "facezip/block_size.hpp"
#include "facezip/check.hpp"
#include "facezip/package.hpp"
#include "facezip/printable.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {

const char* sampleName(SampleType type) {
  return type == SampleType::kUint8 ? "8-bit" : type == SampleType::kUint16 ? "16-bit" : "float";
}

/// The set that all maps share needs no name; others are known by the maps that use them.
void printWeights(const Package& package, std::size_t set) {
  const PackageWeights& weights = package.weightSets()[set];
  std::vector<std::string> users;
  for (const PackageMap& map : package.maps()) {
    if (static_cast<std::size_t>(map.weight_set) == set) users.push_back(map.name);
  }
  const std::string of = package.weightSets().size() == 1 ? "" : fmt::format(" of {}", fmt::join(users, ", "));
  say("  weights{}: {} x {} for each expression, {} x {} tiles in {}\n", of, weights.tile_width, weights.tile_height,
      weights.columns, weights.rows, fmt::join(weights.files, ", "));
}

/// What the textures of a map are stored as: "8-bit, ..., differences in 8 bits", or the blocks of either.
std::string storage(const PackageMap& map) {
  const auto blocks = [](const std::optional<BlockFormat>& format) {
    return format ? fmt::format("{} blocks", blockFormatName(*format)) : "";
  };
  const std::string neutral = blocks(map.neutral_format);
  const std::string difference = blocks(map.differences.front().format);
  return fmt::format("{}{}, differences in {}", neutral.empty() ? "" : ", neutral in ", neutral,
                     difference.empty() ? fmt::format("{} bits", map.difference_bits) : difference);
}

/// What a GPU gets of a map's textures in blocks; nothing of images.
void printBlocks(const PackageMap& map) {
  const auto print = [&](const std::string& textures, const std::optional<BlockFormat>& format) {
    if (!format) return;
    const BlockSize block = blockSize(*format);
    say("    {}: {}, {} x {} texels in {} bytes, {} without mip levels\n", textures, blockFormatName(*format),
        block.width, block.height, block.bytes, formatMegabytes(blockTextureBytes(*format, map.width, map.height)));
  };
  print(map.neutral_file, map.neutral_format);
  for (const PackageDifference& difference : map.differences) print(difference.file, difference.format);
}

void printPackage(const Package& package) {
  const auto plural = [](std::size_t count) { return count == 1 ? "" : "s"; };
  const std::size_t expressions = package.expressions().size();
  const auto differences = static_cast<std::size_t>(package.differences());
  say("{}: {} expression{}, {} difference texture{} a map, made by {}\n", printable(package.name()), expressions,
      plural(expressions), differences, plural(differences), printable(package.description().generator));
  for (const PackageMap& map : package.maps()) {
    say("  map {}: {} x {}, {} channel{}, {}{}{}{}, {} texels to a weight texel\n", map.name, map.width, map.height,
        map.channels, map.channels == 1 ? "" : "s", sampleName(map.sample_type), map.colour_space.empty() ? "" : ", ",
        map.colour_space, storage(map), map.weight_scale);
    printBlocks(map);
  }
  for (std::size_t set = 0; set < package.weightSets().size(); ++set) printWeights(package, set);
  say("  memory: {} at run time, {} on disk\n", formatMegabytes(package.bytesInMemory()),
      formatMegabytes(package.bytesOnDisk()));
  say("  expressions: {}\n", fmt::join(package.expressions(), ", "));
  say("  method: {}\n", package.methodJson());
}

}  // namespace

void addInfoCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string package;
    std::string memory = "2GiB";
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("info", "Checks a package and says what it holds");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  addMemoryOption(*command, arguments->memory);
  command->callback([arguments, &common] {
    const std::uint64_t memory_bytes = parseBytes("--memory", arguments->memory);
    TerminalProgress progress(common.quiet);
    withPackage(arguments->package, [&](const Package& package) {
      checkTexels(package, progress, memory_bytes);
      printPackage(package);
    });
  });
}

}  // namespace facezip::cli
