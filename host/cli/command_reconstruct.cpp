#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/reconstruct.hpp"
#include "shared_options.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addReconstructCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string package;
    std::string output;
    std::vector<std::string> expressions;
    std::string device = "auto";
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("reconstruct", "Writes the textures of expressions as a package holds them: DIR/MAP/NAME.png");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  command->add_option("-o,--output", arguments->output, "Directory for the textures")->required()->type_name("DIR");
  command->add_option("--expression", arguments->expressions, "Expressions to write (default: all)")
      ->type_name("NAME")
      ->delimiter(',');
  addDeviceOption(*command, arguments->device);
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const Package package = Package::open(arguments->package);
    reconstruct(package, arguments->output, arguments->expressions, openDevice(arguments->device, &progress), progress);
  });
}

}  // namespace facezip::cli
