#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/reconstruct.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addReconstructCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string package;
    std::string output;
    std::vector<std::string> expressions;
    std::string device = "auto";
    std::string memory = "2GiB";
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
  addMemoryOption(*command, arguments->memory);
  command->callback([arguments, &common] {
    const std::uint64_t memory_bytes = parseBytes("--memory", arguments->memory);
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    withPackage(arguments->package, [&](const Package& package) {
      reconstruct(package, arguments->output, arguments->expressions, openDevice(arguments->device, &progress),
                  progress, memory_bytes);
    });
  });
}

}  // namespace facezip::cli
