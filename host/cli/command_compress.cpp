#include <fmt/format.h>

#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/compress.hpp"
#include "facezip/report.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addCompressCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string capture;
    std::string output;
    std::vector<std::string> maps;
    std::string device = "auto";
    std::string report;
    CompressArguments compress;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("compress", "Compresses a capture into a package");
  command->add_option("capture", arguments->capture, "Directory of the capture (docs/capture_format.md)")
      ->required()
      ->type_name("CAPTURE");
  addPackageOutputOption(*command, arguments->output);
  addMapsOption(*command, arguments->maps, "Maps to take (default: all)");
  addCompressOptions(*command, arguments->compress);
  addDeviceOption(*command, arguments->device);
  addReportOption(*command, arguments->report, "what was done");
  command->callback([arguments, &common] {
    const CompressOptions options = parseCompressOptions(arguments->compress);
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const Capture capture = openCapture(arguments->capture, arguments->maps, &progress);
    requireReportPlace(arguments->report,
                       inputsOf(capture, options).add(arguments->output, "the package that is written"));
    const Device device = openDevice(arguments->device, &progress);
    const CompressReport report = compressCapture(capture, arguments->output, options, device, progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(report), &progress);
    printCompressReport(report);
  });
}

}  // namespace facezip::cli
