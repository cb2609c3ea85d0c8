#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/error.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/report.hpp"
#include "facezip/rig.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {
namespace fs = std::filesystem;

/// Files as given; of a directory its OBJ files by name.
std::vector<fs::path> framesOf(const std::vector<std::string>& arguments) {
  std::vector<fs::path> frames;
  for (const std::string& argument : arguments) {
    std::error_code error;
    if (!fs::is_directory(argument, error)) {
      frames.emplace_back(argument);
      continue;
    }
    const std::vector<fs::path> files = geometry::objFiles(argument);
    if (files.empty()) throw InputError({argument, "", "OBJ files, one for each frame", "none", ""});
    frames.insert(frames.end(), files.begin(), files.end());
  }
  return frames;
}

}  // namespace

void addSolveWeightsCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string package;
    std::vector<std::string> meshes;
    std::string output;
    std::string report;
    SolveWeightsOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "solve-weights", "Finds the weights that pose a rig like tracked meshes, for blend --animation");
  command->add_option("package", arguments->package, "Directory of a package that `facezip rig` made")
      ->required()
      ->type_name("PACKAGE");
  command
      ->add_option("meshes", arguments->meshes,
                   "OBJ files of the capture's topology, a frame each; or a directory of them, taken by name")
      ->required()
      ->type_name("MESHES");
  command->add_option("-o,--output", arguments->output, "Table (CSV): a row for each frame, a column for each shape")
      ->required()
      ->type_name("CLIP.csv");
  command
      ->add_option("--smoothing", arguments->options.smoothing,
                   "Pull between the weights of neighbouring frames, 0: none; 0.01 is light")
      ->transform(decimalNumber())
      ->capture_default_str();
  command->add_flag("--head-motion", arguments->options.head_motion,
                    "The head moves in the meshes: take its rigid motion out of each frame");
  addReportOption(*command, arguments->report, "residuals");
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    ProtectedPaths taken;
    taken.add(arguments->package, "the package that is read");
    for (const std::string& meshes : arguments->meshes) taken.add(meshes, "a mesh that is read");
    requireReportPlace(arguments->output, taken, "--output");
    requireReportPlace(arguments->report, taken.add(arguments->output, "the clip that is written"));
    const CancelOnSignal cancel(progress);
    const SolvedClip clip = solveWeights(arguments->package, framesOf(arguments->meshes), arguments->options, progress);
    writeClip(arguments->output, clip, &progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(clip), &progress);
    printSolvedClip(clip);
  });
}

}  // namespace facezip::cli
