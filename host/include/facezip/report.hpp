// report.hpp - what a compression or an evaluation found, as JSON (docs/reports.md has the schema).
#pragma once

#include <filesystem>
#include <string>

#include "facezip/alignment.hpp"
#include "facezip/compress.hpp"
#include "facezip/convert.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/learn.hpp"
#include "facezip/registration.hpp"
#include "facezip/rig.hpp"

namespace facezip {

/// JSON text of a report, ending in a line end.
std::string toJson(const CompressReport& report);
std::string toJson(const ConvertReport& report);
std::string toJson(const Evaluation& evaluation);
std::string toJson(const RegistrationReport& report);
std::string toJson(const AlignmentReport& report);
std::string toJson(const RigReport& report);
std::string toJson(const SolvedClip& clip);
std::string toJson(const TrainReport& report);
std::string toJson(const GenerateReport& report);

/// Throws OutputError if a report could not be written to `file`, as far as can be told: to be asked before the work
/// that it is to tell of. Nothing for an empty name.
/// taken   what the command reads, and where it writes besides: a report may be none of it, nor lie in it
/// option  that names the file
void requireReportPlace(const std::filesystem::path& file, const ProtectedPaths& taken = {},
                        const std::string& option = "--report");

/// Writes a report so that a reader sees all of it or none; makes the directories above it. Throws OutputError.
/// progress  may be null
void writeReport(const std::filesystem::path& file, const std::string& json_text, Progress* progress = nullptr);

}  // namespace facezip
