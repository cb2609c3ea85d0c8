#include <fmt/format.h>

#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/synth.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addSynthCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string output;
    SynthOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "synth", "Writes the built-in capture: a procedural head with textures that follow its deformation");
  command->add_option("-o,--output", arguments->output, "Directory of the capture")->required()->type_name("DIR");
  command->add_option("--resolution", arguments->options.resolution, "Side of the textures in texels")
      ->transform(wholeNumber())
      ->capture_default_str();
  command->add_option("--expressions", arguments->options.expressions, "Number of expressions")
      ->transform(wholeNumber())
      ->capture_default_str();
  addMapsOption(*command, arguments->options.maps, "Maps to make: albedo, normal, specular, roughness, displacement");
  addSeedOption(*command, arguments->options.seed, "Seed of the face");
  command->add_flag("--template", arguments->options.rig_template,
                    "Also DIR/template, the single actions of another head, and DIR/weights.json, for facezip rig");
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    synthesizeCapture(arguments->output, arguments->options, progress);
    say("{}\n", arguments->output);
  });
}

}  // namespace facezip::cli
