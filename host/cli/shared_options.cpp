#include "shared_options.hpp"

#include <fmt/ranges.h>

#include "facezip/rig.hpp"
#include "option_types.hpp"

namespace facezip::cli {
namespace {

/// Formats of one kind, for a target or budget to choose from. ASTC's square blocks: others lie between them.
std::vector<BlockFormat> formatChoice(const std::string& name) {
  if (name == "bc") return {BlockFormat::kBc7, BlockFormat::kBc1};
  if (name != "astc") return {};
  return {BlockFormat::kAstc4x4, BlockFormat::kAstc5x5,   BlockFormat::kAstc6x6,
          BlockFormat::kAstc8x8, BlockFormat::kAstc10x10, BlockFormat::kAstc12x12};
}

void parseTextureFormat(const std::string& name, CompressOptions& options) {
  options.format_choice = formatChoice(name);
  if (!options.format_choice.empty()) return;
  options.texture_format = parseBlockFormat(name, "bc or astc with a budget or target, or ");
}

}  // namespace

std::optional<BlockFormat> parseBlockFormat(const std::string& name, const std::string& also) {
  if (name == "png") return std::nullopt;
  try {
    return blockFormatOf(name, "--texture-format");
  } catch (const InputError& error) {
    InputError::Parts parts = error.parts();
    parts.expected = "png, or " + also + parts.expected;
    throw InputError(parts);
  }
}

void addPackageOutputOption(CLI::App& command, std::string& output) {
  command.add_option("-o,--output", output, "Directory of the package; an earlier package there is replaced")
      ->required()
      ->type_name("PACKAGE");
}

void addReportOption(CLI::App& command, std::string& report, const std::string& what) {
  command.add_option("--report", report, "Also write " + what + " as JSON (docs/reports.md)")->type_name("FILE");
}

void addDeviceOption(CLI::App& command, std::string& selector) {
  command
      .add_option("--device", selector,
                  "OpenCL device: auto, gpu, cpu, PLATFORM:DEVICE or part of a name (see `facezip devices`)")
      ->type_name("SELECTOR")
      ->capture_default_str();
}

void addMemoryOption(CLI::App& command, std::string& memory) {
  command.add_option("--memory", memory, "What the process may keep resident, such as 2GiB")
      ->type_name("SIZE")
      ->capture_default_str();
}

void addSeedOption(CLI::App& command, std::uint64_t& seed, const std::string& description) {
  // As text: CLI11 takes -1 for 2^64 - 1, and what is larger for the same.
  command
      .add_option_function<std::string>(
          "--seed", [&seed](const std::string& text) { seed = parseSeed("--seed", text); }, description)
      ->type_name("UINT")
      ->default_str(std::to_string(seed));
}

void addMapsOption(CLI::App& command, std::vector<std::string>& maps, const std::string& description) {
  command.add_option("--maps", maps, description)->type_name("NAME,...")->delimiter(',');
}

void addEyesOption(CLI::App& command, std::string& eyes) {
  command
      .add_option("--eyes", eyes,
                  fmt::format("Irises of the template's eyes: {}, or #rrggbb for the nearest of these (default: the "
                              "template's own, or brown)",
                              fmt::join(irisNames(), ", ")))
      ->type_name("NAME");
}

std::vector<std::string> mapNames(const Package& package) {
  std::vector<std::string> names;
  for (const PackageMap& map : package.maps()) names.push_back(map.name);
  return names;
}

void addCompressOptions(CLI::App& command, CompressArguments& arguments) {
  CompressOptions& options = arguments.options;
  command
      .add_option("--method", arguments.method,
                  "refined; closed-loop: the paper's weights, textures fitted to them; paper: the FaceZip method; "
                  "no-permutation: its ablation; compress-stretch: the two maps of Li et al. 2020 (needs every mesh)")
      ->check(CLI::IsMember(allNames<Method>()))
      ->capture_default_str();
  CLI::Option* differences = command
                                 .add_option("--differences", options.differences,
                                             "Difference textures of a map, and weights of a cell: 1 to 8")
                                 ->transform(wholeNumber())
                                 ->capture_default_str();
  CLI::Option* scale = command
                           .add_option("--weight-scale", options.weight_scale,
                                       "Texels of the largest map per weight texel, along each axis")
                           ->transform(wholeNumber())
                           ->capture_default_str();
  command
      .add_option("--target-rmse", arguments.target_rmse,
                  "Find the smallest package of at most this error (0..255), instead of the two above")
      ->transform(decimalNumber())
      ->type_name("RMSE")
      ->excludes(differences)
      ->excludes(scale);
  command.add_option("--budget", arguments.budget, "Find the best package within this run-time memory, such as 40MiB")
      ->type_name("SIZE")
      ->excludes(differences)
      ->excludes(scale);
  CLI::Option* format =
      command
          .add_option("--texture-format", arguments.texture_format,
                      "png, or a block format that textures of 8 bits are fitted to: " + blockFormatNames() +
                          "; bc or astc to let a target or budget choose one of that kind")
          ->type_name("FORMAT")
          ->capture_default_str();
  command
      .add_option("--difference-format", arguments.difference_format,
                  "Block format of the difference textures, where it is to be another")
      ->type_name("FORMAT")
      ->needs(format);
  CLI::Option* sets =
      command
          .add_option(
              "--weight-sets", arguments.weight_sets,
              "shared: one set of weights for all maps; per-map: one for each; auto: what errs less by the byte")
          ->check(CLI::IsMember(allNames<WeightSets>()))
          ->capture_default_str();
  command
      .add_flag_callback(
          "--weights-per-map", [&arguments] { arguments.weight_sets = nameOf(WeightSets::kPerMap); },
          "The same as --weight-sets per-map")
      ->excludes(sets);
  CLI::Option* radius =
      command
          .add_option("--mask-radius", arguments.mask_radius,
                      "Distance between mask samples: 3cm, 0.03m; a bare number is in the mesh's unit")
          ->type_name("LENGTH")
          ->capture_default_str();
  command.add_option("--masks", arguments.masks, "Number of masks, instead of their distance")
      ->transform(wholeNumber())
      ->excludes(radius);
  command.add_option("--mask-cutoff", options.mask_cutoff, "Mask weights below this are cut")
      ->transform(decimalNumber())
      ->capture_default_str();
  command
      .add_option("--permutation-solver", arguments.permutation_solver,
                  "descent: the paper's, from random starts; message-passing: with its bound; best: the better of both")
      ->check(CLI::IsMember(allNames<PermutationSolver>()))
      ->capture_default_str();
  command.add_option("--restarts", options.restarts, "Random starts of the permutation search by descent")
      ->transform(wholeNumber())
      ->capture_default_str();
  command.add_option("--cluster-restarts", options.cluster_restarts, "Random starts of the clustering of each mask")
      ->transform(wholeNumber())
      ->capture_default_str();
  addSeedOption(command, options.seed, "Seed of every random choice");
  command.add_option("--unit", arguments.unit, "Unit of the meshes (mm, cm, m, in, ...), over what the capture states")
      ->type_name("UNIT");
  command
      .add_option("--region", options.region,
                  "Part of the face that changes: a file of triangle indices (.txt), a painted image, or whole")
      ->type_name("FILE");
  command
      .add_option("--importance", options.importance,
                  "Painted image of where errors matter more (default: the capture's importance.png), or none")
      ->type_name("FILE");
  command
      .add_option("--gutter", arguments.gutter,
                  "Texels around UV islands that get masks too (default: 1/64 of the side, at least 16)")
      ->transform(wholeNumber());
  command
      .add_option(
          "--feather", arguments.feather,
          "Texels over which differences fade out beyond the region's border (default: 1/32 of the side where an "
          "expression changes tone there, else 0)")
      ->transform(wholeNumber());
  command.add_flag("!--no-mesh", options.mesh, "Leave the meshes out of the package: no viewer, no exports");
  addMemoryOption(command, arguments.memory);
}

CompressOptions parseCompressOptions(const CompressArguments& arguments) {
  CompressOptions options = arguments.options;
  options.method = *findNamed<Method>(arguments.method);  // CLI11 has checked it
  options.weight_sets = *findNamed<WeightSets>(arguments.weight_sets);
  options.permutation_solver = *findNamed<PermutationSolver>(arguments.permutation_solver);
  try {
    options.mask_radius = geometry::parseLength(arguments.mask_radius);
  } catch (const InputError& error) {
    throw error.in("--mask-radius " + arguments.mask_radius);
  }
  parseTextureFormat(arguments.texture_format, options);
  if (!arguments.difference_format.empty()) {
    options.difference_format = blockFormatOf(arguments.difference_format, "--difference-format");
  }
  options.target_rmse = arguments.target_rmse;
  if (!arguments.budget.empty()) options.budget_bytes = parseBytes("--budget", arguments.budget);
  options.masks = arguments.masks;
  options.gutter = arguments.gutter;
  options.feather = arguments.feather;
  if (!arguments.unit.empty()) {
    try {
      geometry::parseUnit(arguments.unit);
    } catch (const InputError& error) {
      throw error.in("--unit");
    }
    options.unit = arguments.unit;
  }
  options.memory_bytes = parseBytes("--memory", arguments.memory);
  return options;
}

}  // namespace facezip::cli
