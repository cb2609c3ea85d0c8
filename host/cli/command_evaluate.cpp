#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

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

void addEvaluateCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string capture;
    std::string package;
    std::vector<std::string> baselines = {"pca4", "pca8", "no-permutation", "paper", "limit"};
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
                   "What to compare with: pca4, pca8, limit (best components of every block), no-permutation, paper, "
                   "closed-loop, refined, weights-per-map, compress-stretch (each compresses once more), or none")
      ->delimiter(',')
      ->check(CLI::IsMember({"pca4", "pca8", "limit", "no-permutation", "paper", "closed-loop", "refined",
                             "weights-per-map", "compress-stretch", "none"}))
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
  command->add_option("--report", arguments->report, "Also write the figures as JSON (docs/reports.md)")
      ->type_name("FILE");
  command->callback([arguments, &common] {
    const auto wanted = [&](const char* name) {
      return std::find(arguments->baselines.begin(), arguments->baselines.end(), name) != arguments->baselines.end();
    };
    if (!arguments->picture.empty() && std::filesystem::path(arguments->picture).extension() != ".png") {
      throw InputError({"--picture", "", "a file name that ends in .png", arguments->picture, ""});
    }
    EvaluateOptions options;
    options.pca4 = wanted("pca4");
    options.pca8 = wanted("pca8");
    options.no_permutation = wanted("no-permutation");
    options.paper = wanted("paper");
    options.compress_stretch = wanted("compress-stretch");
    options.closed_loop = wanted("closed-loop");
    options.refined = wanted("refined");
    options.weights_per_map = wanted("weights-per-map");
    options.limit = wanted("limit");
    options.ablation = arguments->ablation;
    options.shapes = arguments->shapes;
    options.blends = arguments->blends;
    options.pictures = !arguments->picture.empty();
    options.picture_map = arguments->picture_map;
    options.memory_bytes = parseBytes("--memory", arguments->memory);
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const Package package = Package::open(arguments->package);
    const Capture capture = openCapture(arguments->capture);
    const ProtectedPaths inputs = inputsOf(capture).add(inputsOf(package));
    requireReportPlace(arguments->report, inputs);
    requireReportPlace(arguments->picture, ProtectedPaths(inputs).add(arguments->report, "the report that is written"),
                       "--picture");
    const Evaluation evaluation =
        evaluatePackage(capture, package, options, openDevice(arguments->device, &progress), progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(evaluation), &progress);
    if (!arguments->picture.empty()) writeErrorSheet(arguments->picture, evaluation);
    printEvaluation(evaluation);
  });
}

}  // namespace facezip::cli
