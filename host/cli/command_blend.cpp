#include <fmt/format.h>

#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/blend.hpp"
#include "facezip/frame_file.hpp"
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
};

/// Frames to blend: one from --weights, or those of --animation.
AnimationClip readFrames(const Arguments& arguments, const Package& package) {
  if (!arguments.animation.empty()) return readAnimation(arguments.animation, package);
  return {static_cast<int>(package.expressions().size()), weightsByName(package, parseWeights(arguments.weights))};
}

void blendFrames(const Arguments& arguments, Progress& progress) {
  const Package package = Package::open(arguments.package);
  const AnimationClip clip = readFrames(arguments, package);
  const FramePattern pattern(arguments.output, !arguments.animation.empty(), package.maps().size());
  pattern.requireFits(package, clip.frames(),
                      ProtectedPaths()
                          .addFile(arguments.animation, "the clip that is read")
                          .addFile(arguments.gain, "the gains that are read"));
  Blender blender(package, openDevice(arguments.device, &progress));
  if (!arguments.gain.empty()) blender.setGain(readGain(arguments.gain, package));
  std::vector<std::byte> frame;
  progress.stage("blending", static_cast<std::size_t>(clip.frames()));
  for (int f = 0; f < clip.frames(); ++f) {
    progress.checkCancelled();
    blender.setWeights(clip.frame(f));
    for (std::size_t m = 0; m < package.maps().size(); ++m) {
      const PackageMap& map = package.maps()[m];
      frame.resize(map.frameBytes());
      blender.blend(static_cast<int>(m), frame);
      writeFrame(pattern.file(f, map.name), map, frame, &progress);
    }
    progress.advance(static_cast<std::size_t>(f) + 1);
  }
}

}  // namespace

void addBlendCommand(CLI::App& app, const CommonOptions& common) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("blend", "Blends the textures of a package with blendshape weights (Eq. 8)");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  CLI::Option_group* what = command->add_option_group("frames", "What to blend");
  what->add_option("--weights", arguments->weights, "One frame: smile=0.7,jawOpen=0.2")->type_name("NAME=VALUE,...");
  what->add_option("--animation", arguments->animation, "A table (CSV): a row per frame, a column per expression")
      ->type_name("FILE");
  what->require_option(1);
  command
      ->add_option("-o,--output", arguments->output,
                   "Image file; %04d stands for the frame's number (from 0), {map} for the map's name (several maps "
                   "without it: FILE.MAP.EXT)")
      ->required()
      ->type_name("FILE");
  command->add_option("--gain", arguments->gain, "Gains of expressions and regions, a preset that `facezip view` saved")
      ->type_name("FILE.json");
  addDeviceOption(*command, arguments->device);
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    blendFrames(*arguments, progress);
  });
}

}  // namespace facezip::cli
