#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/convert.hpp"
#include "facezip/report.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addConvertCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string package;
    std::string texture_format;
    std::string difference_format;
    std::string output;
    std::string memory = "2GiB";
    std::string device = "auto";
    std::string report;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "convert", "Writes a package with its textures in blocks, fitted to its own frames, or as images again");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  CLI::Option* format =
      command
          ->add_option("--texture-format", arguments->texture_format,
                       "png, or a block format that textures of 8 bits are fitted to: " + blockFormatNames())
          ->required()
          ->type_name("FORMAT");
  command
      ->add_option("--difference-format", arguments->difference_format,
                   "Block format of the difference textures, where it is to be another")
      ->type_name("FORMAT")
      ->needs(format);
  addPackageOutputOption(*command, arguments->output);
  addMemoryOption(*command, arguments->memory);
  addDeviceOption(*command, arguments->device);
  addReportOption(*command, arguments->report, "what was done");
  command->callback([arguments, &common] {
    ConvertOptions options;
    options.texture_format = parseBlockFormat(arguments->texture_format);
    if (!arguments->difference_format.empty()) {
      if (!options.texture_format) {
        throw InputError({"--difference-format", "", "a block --texture-format beside it", "png", "leave it out"});
      }
      options.difference_format = blockFormatOf(arguments->difference_format, "--difference-format");
    }
    options.memory_bytes = parseBytes("--memory", arguments->memory);
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    withPackage(arguments->package, [&](const Package& package) {
      requireReportPlace(arguments->report, inputsOf(package).add(arguments->output, "the package that is written"));
      const Device device = openDevice(arguments->device, &progress);
      const ConvertReport report = convertPackage(package, arguments->output, options, device, progress);
      if (!arguments->report.empty()) writeReport(arguments->report, toJson(report), &progress);
      printConvertReport(report);
    });
  });
}

}  // namespace facezip::cli
