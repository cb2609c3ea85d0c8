#include <fmt/format.h>

#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/report.hpp"
#include "facezip/rig.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addRigCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string capture;
    std::string rig_template;
    std::string guess;
    std::string output;
    std::vector<std::string> maps;
    int iterations = geometry::ExampleRigOptions{}.iterations;
    std::string transfer = "best";
    std::string texture_solve;
    bool head_motion = false;
    double texture_damping = 0.0;
    std::string eyes;
    std::string device = "auto";
    std::string report;
    CompressArguments compress;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "rig", "Makes an animatable face of a capture: a template's shapes fitted to it, with their textures");
  command->add_option("capture", arguments->capture, "Directory of the capture (docs/capture_format.md)")
      ->required()
      ->type_name("CAPTURE");
  command
      ->add_option("--template", arguments->rig_template,
                   "Directory of neutral.obj and an OBJ file for each shape, of the capture's topology")
      ->required()
      ->type_name("DIR");
  addPackageOutputOption(*command, arguments->output);
  command
      ->add_option("--weights", arguments->guess,
                   "Weights of the shapes that the expressions are thought to have (.csv or .json, docs/rig.md)")
      ->type_name("GUESS");
  command->add_option("--iterations", arguments->iterations, "Turns of fitting shapes and weights")
      ->transform(wholeNumber())
      ->capture_default_str();
  command
      ->add_option("--transfer", arguments->transfer,
                   "How the template comes onto the subject: gradients (deformation transfer), displacements, or best: "
                   "what poses the expressions better")
      ->check(CLI::IsMember({"best", "gradients", "displacements"}))
      ->capture_default_str();
  command
      ->add_option("--texture-solve", arguments->texture_solve,
                   "Textures of the shapes: local (a wrinkle belongs to shapes that strain the skin there), damped, "
                   "pseudo-inverse (the FaceZip paper's) or strain (compress and stretch maps'); default: what belongs "
                   "to the method, local with refined and closed-loop")
      ->check(CLI::IsMember(allNames<TextureSolve>()));
  command->add_flag("--head-motion", arguments->head_motion,
                    "Take the rigid motion of the head out of every expression's mesh");
  CLI::Option* damping =
      command
          ->add_option("--texture-damping", arguments->texture_damping,
                       "lambda of local and damped (default: local: what predicts each expression best from the "
                       "others; damped: 0.3)")
          ->transform(decimalNumber())
          ->type_name("NUMBER");
  addEyesOption(*command, arguments->eyes);
  addMapsOption(*command, arguments->maps, "Maps to take (default: all)");
  addCompressOptions(*command, arguments->compress);
  addDeviceOption(*command, arguments->device);
  addReportOption(*command, arguments->report, "what was done");
  command->callback([arguments, damping, &common] {
    RigOptions options;
    options.compress = parseCompressOptions(arguments->compress);
    options.fit.iterations = arguments->iterations;
    options.fit.transfer = arguments->transfer == "gradients"       ? geometry::ShapeTransfer::kGradients
                           : arguments->transfer == "displacements" ? geometry::ShapeTransfer::kDisplacements
                                                                    : geometry::ShapeTransfer::kBest;
    options.fit.head_motion = arguments->head_motion;
    options.guess = arguments->guess;
    options.eyes = arguments->eyes;
    options.texture_solve = findNamed<TextureSolve>(arguments->texture_solve);  // CLI11 has checked it
    if (damping->count() > 0) options.texture_damping = arguments->texture_damping;
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const Capture capture = openCapture(arguments->capture, arguments->maps, &progress, NeutralAlone::kAllowed);
    requireReportPlace(
        arguments->report,
        inputsOf(capture, arguments->rig_template, options).add(arguments->output, "the package that is written"));
    const Device device = openDevice(arguments->device, &progress);
    const RigReport report = rigCapture(capture, arguments->rig_template, arguments->output, options, device, progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(report), &progress);
    printRigReport(report);
  });
}

}  // namespace facezip::cli
