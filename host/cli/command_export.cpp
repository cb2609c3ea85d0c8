#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/export.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addExportCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string package;
    std::string target;
    std::string output;
    std::string memory = "2GiB";
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("export", "Writes a package for another tool: mesh, textures and the blend");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  command->add_option("--target", arguments->target, "Tool to write for")
      ->required()
      ->check(CLI::IsMember(exportTargets()))
      ->type_name("NAME");
  command->add_option("-o,--output", arguments->output, "Folder to write")->required()->type_name("DIR");
  addMemoryOption(*command, arguments->memory);
  command->callback([arguments, &common] {
    const std::uint64_t memory_bytes = parseBytes("--memory", arguments->memory);
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    withPackage(arguments->package, [&](const Package& package) {
      const std::vector<std::string> losses =
          exportPackage(package, arguments->target, arguments->output, progress, memory_bytes);
      for (const std::string& loss : losses) progress.note(loss);
    });
    say("Read {}\n", (std::filesystem::path(arguments->output) / "README.md").string());
  });
}

}  // namespace facezip::cli
