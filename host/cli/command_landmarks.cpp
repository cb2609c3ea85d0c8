#include <cstdio>
#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/landmarks.hpp"
#include "option_types.hpp"
#include "serve.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addLandmarksCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string scans;
    std::string registration_template;
    std::string landmarks;
    int port = 8080;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("landmarks", "A page to place the landmarks of scans on, for `register`: the template beside");
  command
      ->add_option("scans", arguments->scans,
                   "Directory of scans, as `register` takes it; landmarks.json may be missing")
      ->required()
      ->type_name("SCANS");
  command
      ->add_option("--template", arguments->registration_template,
                   "Directory of neutral.obj and landmarks.json, which says what the landmarks are")
      ->required()
      ->type_name("DIR");
  command->add_option("--landmarks", arguments->landmarks, "File that is saved to (default: SCANS/landmarks.json)")
      ->type_name("FILE");
  command->add_option("--port", arguments->port, "Port to serve on, of this machine alone; 0: any that is free")
      ->transform(wholeNumber())
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    const LandmarkSession session(arguments->scans, arguments->registration_template, arguments->landmarks, progress);
    const auto started = [&session](int port) {
      say("Place landmarks at http://127.0.0.1:{}/ (Ctrl-C ends). They are saved to {}\n", port,
          session.landmarkFile().string());
      std::fflush(stdout);  // for those who read a pipe
    };
    serveLandmarks(session, arguments->port, started, progress);
  });
}

}  // namespace facezip::cli
