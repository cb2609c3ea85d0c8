#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/learn.hpp"
#include "facezip/report.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addGenerateCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string neutral;
    std::string model;
    std::string output;
    std::vector<std::string> maps;
    std::string device = "auto";
    std::string report;
    std::string eyes;
    CompressArguments compress;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("generate", "Makes an animatable face of one neutral scan, with a model that `train` learned");
  command
      ->add_option("neutral", arguments->neutral,
                   "Directory of a capture of a neutral alone: neutral.obj, MAP/neutral.png (docs/capture_format.md)")
      ->required()
      ->type_name("NEUTRAL");
  command->add_option("--model", arguments->model, "The model that `facezip train` wrote, of the neutral's topology")
      ->type_name("MODEL");
  addPackageOutputOption(*command, arguments->output);
  addEyesOption(*command, arguments->eyes);
  addMapsOption(*command, arguments->maps, "Maps to take (default: all)");
  addCompressOptions(*command, arguments->compress);
  addDeviceOption(*command, arguments->device);
  addReportOption(*command, arguments->report, "what was done");
  command->callback([arguments, &common] {
    if (arguments->model.empty()) {
      throw InputError({"--model", "", "a model that `facezip train` learned from captures of many people", "none",
                        "facezip brings none: train one (docs/learning.md), or give the neutral the shapes of a "
                        "template with `facezip rig NEUTRAL --template DIR`"});
    }
    const GenerateOptions options{parseCompressOptions(arguments->compress), arguments->eyes};
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const Capture neutral = openCapture(arguments->neutral, arguments->maps, &progress, NeutralAlone::kAllowed);
    requireReportPlace(
        arguments->report,
        generateInputs(neutral, arguments->model, options).add(arguments->output, "the package that is written"));
    const Device device = openDevice(arguments->device, &progress);
    const GenerateReport report = generateFace(neutral, arguments->model, arguments->output, options, device, progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(report), &progress);
    printGenerateReport(report);
  });
}

}  // namespace facezip::cli
