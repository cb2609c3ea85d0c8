#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/view.hpp"
#include "option_types.hpp"
#include "serve.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {

struct Arguments {
  std::string package;
  std::optional<std::string> output;
  int port = 8080;
};

void view(const Arguments& arguments, const Package& package, Progress& progress) {
  if (arguments.output) {
    writeViewer(package, *arguments.output, progress);
    say("Look at {}\n", (std::filesystem::path(*arguments.output) / "index.html").string());
    return;
  }
  const auto started = [](int port) {
    say("Look at http://127.0.0.1:{}/ (Ctrl-C ends)\n", port);
    std::fflush(stdout);  // for those who read a pipe
  };
  serveViewer(package, arguments.port, started, progress);
}

}  // namespace

void addViewCommand(CLI::App& app, const CommonOptions& common) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("view", "Shows a package in a browser: a head with sliders, gains, debug views");
  command->add_option("package", arguments->package, "Directory of the package")->required()->type_name("PACKAGE");
  CLI::Option* output =
      command->add_option("-o,--output", arguments->output, "Write the page into a folder instead of serving it")
          ->type_name("DIR");
  command->add_option("--port", arguments->port, "Port to serve on, of this machine alone; 0: any that is free")
      ->transform(wholeNumber())
      ->check(CLI::Range(0, 65535))
      ->excludes(output)
      ->capture_default_str();
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    withPackage(arguments->package, [&](const Package& package) { view(*arguments, package, progress); });
  });
}

}  // namespace facezip::cli
