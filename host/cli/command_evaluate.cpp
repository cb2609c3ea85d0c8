#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "commands.hpp"
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
    std::vector<std::string> baselines = {"pca4", "pca8", "no-permutation"};
    std::string device = "auto";
    std::string memory = "2GiB";
    std::string report;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Compares a package, decoded from disk, with the capture it was made of");
  command->add_option("capture", arguments->capture, "Directory of the capture")->required()->type_name("CAPTURE");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  command->add_option("--baselines", arguments->baselines, "What to compare with: pca4, pca8, no-permutation, or none")
      ->delimiter(',')
      ->check(CLI::IsMember({"pca4", "pca8", "no-permutation", "none"}))
      ->capture_default_str();
  addDeviceOption(*command, arguments->device);
  addMemoryOption(*command, arguments->memory);
  command->add_option("--report", arguments->report, "Also write the figures as JSON (docs/reports.md)")
      ->type_name("FILE");
  command->callback([arguments, &common] {
    const auto wanted = [&](const char* name) {
      return std::find(arguments->baselines.begin(), arguments->baselines.end(), name) != arguments->baselines.end();
    };
    EvaluateOptions options;
    options.pca4 = wanted("pca4");
    options.pca8 = wanted("pca8");
    options.no_permutation = wanted("no-permutation");
    options.memory_bytes = parseBytes("--memory", arguments->memory);
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const Package package = Package::open(arguments->package);
    const Evaluation evaluation =
        evaluatePackage(openCapture(arguments->capture), package, options, openDevice(arguments->device), progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(evaluation));
    printEvaluation(evaluation);
  });
}

}  // namespace facezip::cli
