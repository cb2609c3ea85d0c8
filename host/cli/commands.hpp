// commands.hpp - the verbs of the command. Each adds its sub-command and the options that it takes to the application.
#pragma once

#include <CLI/CLI.hpp>

namespace facezip::cli {

/// Options that every command takes.
struct CommonOptions {
  bool quiet = false;  ///< --quiet: no progress, no notes
};

void addSynthCommand(CLI::App& app, const CommonOptions& common);
void addCompressCommand(CLI::App& app, const CommonOptions& common);
void addConvertCommand(CLI::App& app, const CommonOptions& common);
void addReconstructCommand(CLI::App& app, const CommonOptions& common);
void addBlendCommand(CLI::App& app, const CommonOptions& common);
void addEvaluateCommand(CLI::App& app, const CommonOptions& common);
void addExportCommand(CLI::App& app, const CommonOptions& common);
void addReportCommand(CLI::App& app, const CommonOptions& common);
void addViewCommand(CLI::App& app, const CommonOptions& common);
void addAlignCommand(CLI::App& app, const CommonOptions& common);
void addRegisterCommand(CLI::App& app, const CommonOptions& common);
void addLandmarksCommand(CLI::App& app, const CommonOptions& common);
void addRigCommand(CLI::App& app, const CommonOptions& common);
void addTrainCommand(CLI::App& app, const CommonOptions& common);
void addGenerateCommand(CLI::App& app, const CommonOptions& common);
void addSolveWeightsCommand(CLI::App& app, const CommonOptions& common);
void addInfoCommand(CLI::App& app, const CommonOptions& common);
void addDevicesCommand(CLI::App& app, const CommonOptions& common);
void addDemoCommand(CLI::App& app, const CommonOptions& common);

}  // namespace facezip::cli
