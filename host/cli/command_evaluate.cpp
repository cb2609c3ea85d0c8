#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "error_sheet.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/report.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {

std::vector<std::string> baselineNames() {
  std::vector<std::string> names = allNames<Baseline>();
  for (const std::string& method : allNames<Method>()) names.push_back(method);
  names.insert(names.end(), {"bc1", "bc7", "astc-4x4", "astc-5x5", "astc-6x6", "astc-8x8", "astc-10x10", "none"});
  return names;
}

/// Those of the names that are names of a `Value`.
template <typename Value>
std::set<Value> chosen(const std::vector<std::string>& names) {
  std::set<Value> values;
  for (const std::string& name : names) {
    if (const std::optional<Value> value = findNamed<Value>(name)) values.insert(*value);
  }
  return values;
}

/// Those of the names that are block formats.
std::set<BlockFormat> chosenFormats(const std::vector<std::string>& names) {
  std::set<BlockFormat> formats;
  for (const std::string& name : names) {
    if (name.starts_with("bc") || name.starts_with("astc")) formats.insert(blockFormatOf(name, "--baselines"));
  }
  return formats;
}

/// Of the methods of the first pictures; the package is known by its method.
std::vector<std::string> pictureTitles(const Evaluation& evaluation) {
  std::vector<std::string> titles;
  for (const std::string& method : evaluation.pictures.front().methods) {
    titles.push_back(evaluationTitle(method == "package" ? evaluation.method : method));
  }
  return titles;
}

}  // namespace

void addEvaluateCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string capture;
    std::string package;
    std::vector<std::string> baselines = {"bc7", "astc-6x6", "pca4", "pca8", "no-permutation", "paper", "limit"};
    bool ablation = false;
    bool shapes = false;
    int blends = EvaluateOptions().blends;
    std::string picture;
    std::string picture_map;
    std::string device = "auto";
    std::string memory = "2GiB";
    std::string report;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Compares a package, decoded from disk, with the capture it was made of");
  command->add_option("capture", arguments->capture, "Directory of the capture")->required()->type_name("CAPTURE");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  command
      ->add_option("--baselines", arguments->baselines,
                   "What to compare with: every texture in bc1, bc7, astc-4x4, -5x5, -6x6, -8x8 or -10x10; pca4, pca8, "
                   "limit (best components of every block), no-permutation, paper, "
                   "closed-loop, refined, weights-per-map, compress-stretch (each compresses once more), or none")
      ->delimiter(',')
      ->check(CLI::IsMember(baselineNames()))
      ->capture_default_str();
  command->add_flag("--shapes", arguments->shapes,
                    "The capture's expressions are single shapes of the package's rig, by name");
  command->add_flag("--ablation", arguments->ablation,
                    "Also every method at C = 1, 2, 3, 4: compresses up to 16 times more");
  command->add_option("--blends", arguments->blends, "Random blends of one to five expressions to measure; 0: none")
      ->transform(wholeNumber())
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command
      ->add_option("--picture", arguments->picture,
                   "Also write an image of every expression: captured, decoded, and errors in false colours")
      ->type_name("FILE.png");
  command->add_option("--picture-map", arguments->picture_map, "Map of the picture (default: the first)")
      ->needs(command->get_option("--picture"))
      ->type_name("NAME");
  addDeviceOption(*command, arguments->device);
  addMemoryOption(*command, arguments->memory);
  addReportOption(*command, arguments->report, "the figures");
  command->callback([arguments, &common] {
    if (!arguments->picture.empty() && std::filesystem::path(arguments->picture).extension() != ".png") {
      throw InputError({"--picture", "", "a file name that ends in .png", arguments->picture, ""});
    }
    EvaluateOptions options;
    options.methods = chosen<Method>(arguments->baselines);
    options.baselines = chosen<Baseline>(arguments->baselines);
    options.every_texture = chosenFormats(arguments->baselines);
    options.ablation = arguments->ablation;
    options.shapes = arguments->shapes;
    options.blends = arguments->blends;
    if (!arguments->picture.empty()) options.pictures = PictureOptions{.map = arguments->picture_map};
    options.memory_bytes = parseBytes("--memory", arguments->memory);
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const Package package = Package::open(arguments->package);
    const Capture capture = openCapture(arguments->capture, mapNames(package));
    const ProtectedPaths inputs = inputsOf(capture).add(inputsOf(package));
    requireReportPlace(arguments->report, inputs);
    requireReportPlace(arguments->picture, ProtectedPaths(inputs).add(arguments->report, "the report that is written"),
                       "--picture");
    const Evaluation evaluation =
        evaluatePackage(capture, package, options, openDevice(arguments->device, &progress), progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(evaluation), &progress);
    if (!arguments->picture.empty()) writeErrorSheet(arguments->picture, evaluation, pictureTitles(evaluation));
    printEvaluation(evaluation);
  });
}

}  // namespace facezip::cli
