#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/html_report.hpp"
#include "facezip/report.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {

struct Arguments {
  std::string capture;
  std::string package;
  std::string output;
  std::string map;
  std::string compress_report;
  std::string registration_report;
  std::vector<int> mask_sweep;
  std::string device = "auto";
  std::string memory = "2GiB";
};

/// Pixels of the pictures: as many as keep the page below 30 MB or so.
int pictureSide(std::size_t pictures) {
  constexpr std::size_t kMostPixels = 48 * 384 * 384;
  for (const int side : {512, 384, 256, 192}) {
    if (pictures * static_cast<std::size_t>(side * side) <= kMostPixels) return side;
  }
  return 128;
}

void report(const Arguments& arguments, Progress& progress) {
  if (std::filesystem::path(arguments.output).extension() != ".html") {
    throw InputError({"--output", "", "a file name that ends in .html", arguments.output, ""});
  }
  for (const int masks : arguments.mask_sweep) {
    if (masks < 1) throw InputError({"--mask-sweep", "", "numbers of at least 1", fmt::format("{}", masks), ""});
  }
  std::string compressed;
  if (!arguments.compress_report.empty()) compressed = readCompressReport(arguments.compress_report);
  std::string registered;
  if (!arguments.registration_report.empty()) registered = readRegistrationReport(arguments.registration_report);
  EvaluateOptions options;
  options.blends = 0;
  options.mask_sweep = arguments.mask_sweep;
  options.memory_bytes = parseBytes("--memory", arguments.memory);
  const Package package = Package::open(arguments.package);
  const Capture capture = openCapture(arguments.capture, mapNames(package));
  requireReportPlace(arguments.output,
                     inputsOf(capture)
                         .add(inputsOf(package))
                         .addFile(arguments.compress_report, "the report that is read")
                         .addFile(arguments.registration_report, "the report that is read"),
                     "--output");
  const std::size_t pictures = package.expressions().size() * (arguments.map.empty() ? package.maps().size() : 1);
  options.pictures =
      PictureOptions{.map = arguments.map, .all_maps = true, .paper_and_pca = false, .side = pictureSide(pictures)};
  const Device device = openDevice(arguments.device, &progress);
  const Evaluation evaluation = evaluatePackage(capture, package, options, device, progress);
  writeHtmlReport(arguments.output, package, evaluation,
                  {device.info().name, compressed, registered, capture.directory}, &progress);
  say("Look at {}\n", arguments.output);
}

}  // namespace

void addReportCommand(CLI::App& app, const CommonOptions& common) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("report", "Evaluates a package and writes a page: tables, plots, and captured beside decoded");
  command->add_option("capture", arguments->capture, "Directory of the capture")->required()->type_name("CAPTURE");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  command->add_option("-o,--output", arguments->output, "File of the page")->required()->type_name("FILE.html");
  command->add_option("--map", arguments->map, "Map of the pictures (default: all)")->type_name("NAME");
  command
      ->add_option("--mask-sweep", arguments->mask_sweep,
                   "Numbers of masks to compress with and to plot: 8,16,32,64. Two compressions each")
      ->transform(wholeNumber())
      ->delimiter(',')
      ->type_name("K,...");
  command->add_option("--compress-report", arguments->compress_report, "What `facezip compress --report` wrote")
      ->type_name("FILE.json");
  command
      ->add_option("--registration-report", arguments->registration_report,
                   "What `facezip register --report` wrote of the capture: shown with its pictures")
      ->type_name("FILE.json");
  addDeviceOption(*command, arguments->device);
  addMemoryOption(*command, arguments->memory);
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    report(*arguments, progress);
  });
}

}  // namespace facezip::cli
