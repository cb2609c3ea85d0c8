#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "contact_sheet.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/learn.hpp"
#include "facezip/reconstruct.hpp"
#include "facezip/report.hpp"
#include "facezip/synth.hpp"
#include "facezip/view.hpp"
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
  bool single_scan = false;
};

fs::path outputOf(const Arguments& arguments) {
  if (arguments.output.empty()) throw InputError({"--output", "", "a name", "an empty one", ""});
  return arguments.output;
}

void runDemo(const Arguments& arguments, Progress& progress) {
  const fs::path output = outputOf(arguments);
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

/// A library of made-up people for `train`: its first has the template and says what all were asked to do.
fs::path synthesizeLibrary(const fs::path& library, SynthOptions synth, Progress& progress) {
  constexpr int kPeople = 12;
  constexpr int kResolution = 256;  // that train learns from
  synth.resolution = std::min(synth.resolution, kResolution);
  for (int person = 0; person < kPeople; ++person, ++synth.seed) {
    const fs::path folder = library / "subjects" / fmt::format("person_{:02}", person + 1);
    synth.rig_template = person == 0;
    say("   facezip synth --output {} --resolution {} --seed {}{}\n", folder.string(), synth.resolution, synth.seed,
        person == 0 ? " --template" : "");
    synthesizeCapture(folder, synth, progress);
  }
  return library / "subjects/person_01";
}

void runSingleScan(const Arguments& arguments, Progress& progress) {
  constexpr std::uint64_t kFar = 1000;  // from the seeds of the library
  const fs::path output = outputOf(arguments);
  const Device device = openDevice(arguments.device, &progress);
  const fs::path library = output / "library", model = output / "heads.model", stranger = output / "stranger",
                 package = output / "stranger.facezip", page = output / "viewer";
  say("1. A library of made-up people\n");
  const fs::path first = synthesizeLibrary(library, arguments.synth, progress);

  say("\n2. facezip train {} --template {} --facs {} --output {}\n\n", library.string(), (first / "template").string(),
      (first / "weights.json").string(), model.string());
  printTrainReport(trainModel(library, first / "template", first / "weights.json", model, {}, progress));

  SynthOptions synth = arguments.synth;
  synth.seed += kFar;
  say("\n3. Somebody else: facezip synth --output {} --resolution {} --seed {}\n", stranger.string(), synth.resolution,
      synth.seed);
  synthesizeCapture(stranger, synth, progress);

  say("\n4. Her neutral alone: facezip generate {} --model {} --output {}\n\n", stranger.string(), model.string(),
      package.string());
  const Capture neutral = openCapture(stranger, {}, &progress, NeutralAlone::kAllowed);
  printGenerateReport(generateFace(neutral, model, package, {}, device, progress));

  withPackage(package, [&](const Package& opened) { writeViewer(opened, page, progress); });
  say("\nOpen {} in a browser, or: facezip view {}\n", (page / "index.html").string(), package.string());
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
  command->add_flag(
      "--single-scan", arguments->single_scan,
      "Learns from a library of made-up people instead, and makes a moving face of another one's neutral");
  addDeviceOption(*command, arguments->device);
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    arguments->single_scan ? runSingleScan(*arguments, progress) : runDemo(*arguments, progress);
  });
}

}  // namespace facezip::cli
