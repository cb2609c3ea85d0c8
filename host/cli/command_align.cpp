#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/alignment.hpp"
#include "facezip/report.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addAlignCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string capture;
    std::string output;
    std::vector<std::string> maps;
    std::string device = "auto";
    std::string report;
    AlignmentOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("align", "Lays the textures of a capture's expressions on the neutral's, where they slide");
  command->add_option("capture", arguments->capture, "Directory of the capture")->required()->type_name("CAPTURE");
  command
      ->add_option("-o,--output", arguments->output,
                   "Directory of the aligned capture; an earlier one that this command made is replaced")
      ->required()
      ->type_name("CAPTURE2");
  command
      ->add_option("--map", arguments->options.map, "Map whose textures are compared (default: albedo, else the first)")
      ->type_name("MAP");
  addMapsOption(*command, arguments->maps, "Maps of the aligned capture (default: all)");
  command->add_option("--region", arguments->options.region, "File of the region, or `whole` (default: the capture's)")
      ->type_name("FILE");
  command->add_flag("--keep-meshes", arguments->options.keep_meshes,
                    "Leave the meshes as they are: they are right where the textures are not");
  addDeviceOption(*command, arguments->device);
  addReportOption(*command, arguments->report, "what was found");
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const Capture capture = openCapture(arguments->capture, arguments->maps, &progress);
    requireReportPlace(arguments->report,
                       inputsOf(capture, arguments->options).add(arguments->output, "the capture that is written"));
    const CancelOnSignal cancel(progress);
    const AlignmentReport report = alignCapture(capture, arguments->output, arguments->options,
                                                openDevice(arguments->device, &progress), progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(report), &progress);
    printAlignmentReport(report);
  });
}

}  // namespace facezip::cli
