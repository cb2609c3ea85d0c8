#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/blend.hpp"
#include "facezip/frame_file.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {

struct Arguments {
  std::string package;
  std::string weights;
  std::string animation;
  std::string output;
  std::string gain;
  std::string device = "auto";
  std::string memory = "2GiB";
};

/// Frames to blend: one from --weights, or those of --animation.
AnimationClip readFrames(const Arguments& arguments, const Package& package, Progress& progress) {
  if (!arguments.animation.empty()) return readAnimation(arguments.animation, package, &progress);
  const auto weights = parseWeights(arguments.weights);
  for (const auto& [name, weight] : weights) {
    if (std::abs(weight) > kUsualWeight) progress.note(fmt::format("{} = {}: 1 is the whole expression", name, weight));
  }
  return {static_cast<int>(package.expressions().size()), weightsByName(package, weights)};
}

void blendFrames(const Arguments& arguments, const Package& package, std::uint64_t memory_bytes, Progress& progress) {
  const AnimationClip clip = readFrames(arguments, package, progress);
  const FramePattern pattern(arguments.output, !arguments.animation.empty(), package.maps().size());
  pattern.requireFits(package, clip.frames(),
                      ProtectedPaths()
                          .addFile(arguments.animation, "the clip that is read")
                          .addFile(arguments.gain, "the gains that are read"));
  const Gain gain = arguments.gain.empty() ? unitGain(package) : readGain(arguments.gain, package);
  writeFrames(package, clip, gain, pattern, openDevice(arguments.device, &progress), progress, memory_bytes);
}

}  // namespace

void addBlendCommand(CLI::App& app, const CommonOptions& common) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("blend", "Blends the textures of a package with blendshape weights (Eq. 8)");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  CLI::Option* weights = command->add_option("--weights", arguments->weights, "One frame: smile=0.7,jawOpen=0.2")
                             ->type_name("NAME=VALUE,...");
  CLI::Option* animation =
      command
          ->add_option("--animation", arguments->animation, "A table (CSV): a row per frame, a column per expression")
          ->type_name("FILE")
          ->excludes(weights);
  command
      ->add_option("-o,--output", arguments->output,
                   "Image file; %04d stands for the frame's number (from 0), {map} for the map's name (several maps "
                   "without it: FILE.MAP.EXT)")
      ->required()
      ->type_name("FILE");
  command->add_option("--gain", arguments->gain, "Gains of expressions and regions, a preset that `facezip view` saved")
      ->type_name("FILE.json");
  addDeviceOption(*command, arguments->device);
  addMemoryOption(*command, arguments->memory);
  command->callback([arguments, weights, animation, &common] {
    if (weights->empty() && animation->empty()) {
      throw CLI::RequiredError("what to blend, --weights NAME=VALUE,... or --animation FILE.csv,");
    }
    const std::uint64_t memory_bytes = parseBytes("--memory", arguments->memory);
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    withPackage(arguments->package,
                [&](const Package& package) { blendFrames(*arguments, package, memory_bytes, progress); });
  });
}

}  // namespace facezip::cli
