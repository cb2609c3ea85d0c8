#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/export.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addExportCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string package;
    std::string target;
    std::string output;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("export", "Writes a package for another tool: mesh, textures and the blend");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  command->add_option("--target", arguments->target, "Tool to write for")
      ->required()
      ->check(CLI::IsMember(exportTargets()))
      ->type_name("NAME");
  command->add_option("-o,--output", arguments->output, "Folder to write")->required()->type_name("DIR");
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const std::vector<std::string> losses =
        exportPackage(Package::open(arguments->package), arguments->target, arguments->output, progress);
    for (const std::string& loss : losses) progress.note(loss);
    say("Read {}\n", (std::filesystem::path(arguments->output) / "README.md").string());
  });
}

}  // namespace facezip::cli
