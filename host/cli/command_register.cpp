#include <memory>

#include "cancel_on_signal.hpp"
#include "commands.hpp"
#include "facezip/registration.hpp"
#include "facezip/report.hpp"
#include "option_types.hpp"
#include "shared_options.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace facezip::cli {

void addRegisterCommand(CLI::App& app, const CommonOptions& common) {
  struct Arguments {
    std::string scans;
    std::string registration_template;
    std::string output;
    std::string landmarks;
    std::string device = "auto";
    std::string report;
    std::string last_step = nameOf(RegistrationStep::kFlow);
    RegistrationOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("register", "Makes a capture of raw scans: a template bent onto each, textures in its layout");
  command
      ->add_option("scans", arguments->scans,
                   "Directory of scans: a mesh called neutral and one for each expression (.obj, .ply, .glb, .fbx), "
                   "textures, landmarks.json")
      ->required()
      ->type_name("SCANS");
  command
      ->add_option("--template", arguments->registration_template,
                   "Directory of neutral.obj with UVs and landmarks.json; shapes and identity/ where there are any")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("-o,--output", arguments->output,
                   "Directory of the capture; an earlier one that this command made is replaced")
      ->required()
      ->type_name("CAPTURE");
  command->add_option("--resolution", arguments->options.resolution, "Side of the capture's textures in texels")
      ->transform(wholeNumber())
      ->capture_default_str();
  command->add_option("--landmarks", arguments->landmarks, "Landmarks of the scans (default: SCANS/landmarks.json)")
      ->type_name("FILE");
  command
      ->add_option("--unit", arguments->options.unit,
                   "Unit of the scans (default: guessed from the size of the neutral)")
      ->type_name("UNIT");
  command
      ->add_option("--stop-after", arguments->last_step,
                   "The last step of landmarks, model, bending, flow: to see what each does")
      ->check(CLI::IsMember(allNames<RegistrationStep>()))
      ->capture_default_str();
  addMapsOption(*command, arguments->options.maps,
                "albedo, and what the scans' shape has beyond the template's: normal, displacement (default: albedo)");
  command->add_flag("--keep-colour", arguments->options.keep_colour,
                    "Leave what the light changed between scans in the textures");
  addDeviceOption(*command, arguments->device);
  addReportOption(*command, arguments->report, "what was found");
  command->callback([arguments, &common] {
    TerminalProgress progress(common.quiet);
    arguments->options.landmarks = arguments->landmarks;
    arguments->options.last_step = *findNamed<RegistrationStep>(arguments->last_step);
    requireReportPlace(arguments->report,
                       inputsOf(arguments->scans, arguments->registration_template, arguments->options)
                           .add(arguments->output, "the capture that is written"));
    const CancelOnSignal cancel(progress);
    const Device device = openDevice(arguments->device, &progress);
    const RegistrationReport report = registerScans(arguments->scans, arguments->registration_template,
                                                    arguments->output, arguments->options, device, progress);
    if (!arguments->report.empty()) writeReport(arguments->report, toJson(report), &progress);
    printRegistrationReport(report);
  });
}

}  // namespace facezip::cli
