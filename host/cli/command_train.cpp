#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/learn.hpp"
#include "facezip/report.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addTrainCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string library;
    std::string rig_template;
    std::string facs;
    std::string output;
    std::string method = nameOf(LearningMethod::kLinear);
    std::string report;
    TrainOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "train", "Learns from captures of many people how a face moves, for `generate` to make faces of one neutral");
  command
      ->add_option("library", arguments->library,
                   "Directory of captures, one a person, all with the same expressions in one topology and layout")
      ->required()
      ->type_name("LIBRARY");
  command
      ->add_option("--template", arguments->rig_template,
                   "Directory of neutral.obj and an OBJ file for each shape, of the captures' topology")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--facs", arguments->facs,
                   "Which shapes each expression was asked to be, from 0 to 1 (.json or .csv, docs/learning.md)")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", arguments->output, "The model; an earlier file there is replaced")
      ->required()
      ->type_name("MODEL");
  command->add_option("--method", arguments->method, "How the model predicts: linear, regressions in closed form")
      ->check(CLI::IsMember(allNames<LearningMethod>()))
      ->capture_default_str();
  command->add_option("--resolution", arguments->options.resolution, "Side of the textures that are learned from")
      ->transform(wholeNumber())
      ->capture_default_str();
  command->add_option("--rounds", arguments->options.rounds, "Turns of performed weights and regression of shapes")
      ->transform(wholeNumber())
      ->capture_default_str();
  addMapsOption(*command, arguments->options.maps, "Maps to learn (default: those that every subject has)");
  addReportOption(*command, arguments->report, "what was found");
  command->callback([arguments, &common] {
    arguments->options.method = *findNamed<LearningMethod>(arguments->method);  // CLI11 has checked it
    TerminalProgress progress(common.quiet);
    const CancelOnSignal cancel(progress);
    requireReportPlace(arguments->report, trainInputs(arguments->library, arguments->rig_template, arguments->facs)
                                              .add(arguments->output, "the model that is written"));
    const TrainReport report = trainModel(arguments->library, arguments->rig_template, arguments->facs,
                                          arguments->output, arguments->options, progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(report), &progress);
    printTrainReport(report);
  });
}

}  // namespace facezip::cli
