#include <fmt/format.h>

#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "contact_sheet.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/reconstruct.hpp"
#include "facezip/report.hpp"
#include "facezip/synth.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {
namespace fs = std::filesystem;

struct Arguments {
  std::string output = "facezip-demo";
  std::string device = "auto";
  SynthOptions synth;
};

void runDemo(const Arguments& arguments, Progress& progress) {
  const fs::path output = arguments.output;
  if (output.empty()) throw InputError({"--output", "", "a name", "an empty one", ""});
  const Device device = openDevice(arguments.device, &progress);
  say("1. facezip synth --output {}\n", (output / "capture").string());
  synthesizeCapture(output / "capture", arguments.synth, progress);
  const Capture capture = openCapture(output / "capture");

  say("2. facezip compress {} --output {}\n\n", (output / "capture").string(), (output / "package").string());
  const CompressReport report = compressCapture(capture, output / "package", {}, device, progress);
  printCompressReport(report);
  writeReport(output / "compress.json", toJson(report), &progress);

  say("\n3. facezip evaluate {} {}\n", (output / "capture").string(), (output / "package").string());
  const Package package = Package::open(output / "package");
  const Evaluation evaluation = evaluatePackage(capture, package, {}, device, progress);
  printEvaluation(evaluation);
  writeReport(output / "evaluate.json", toJson(evaluation), &progress);

  reconstruct(package, output / "reconstructed", {}, device, progress);
  writeContactSheet(output / "contact_sheet.png", capture, package, output / "reconstructed");
  say("\nLook at {}\n", (output / "contact_sheet.png").string());
}

}  // namespace

void addDemoCommand(CLI::App& app, const CommonOptions& common) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "demo", "Makes the built-in capture, compresses it, evaluates the package and draws a contact sheet");
  command->add_option("-o,--output", arguments->output, "Directory for all of it")
      ->type_name("DIR")
      ->capture_default_str();
  command->add_option("--resolution", arguments->synth.resolution, "Side of the textures in texels")
      ->transform(wholeNumber())
      ->capture_default_str();
  addSeedOption(*command, arguments->synth.seed, "Seed of the face");
  addDeviceOption(*command, arguments->device);
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    runDemo(*arguments, progress);
  });
}

}  // namespace facezip::cli
