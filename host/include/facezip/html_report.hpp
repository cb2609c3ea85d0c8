// html_report.hpp - an evaluation as one page to look at: tables, plots, sliders between captured and decoded.
#pragma once

#include <filesystem>
#include <string>

#include "facezip/evaluate.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

struct HtmlReportOptions {
  std::string device;         ///< name of the device that evaluated
  std::string compress_json;  ///< of readCompressReport(), for its times; "" where it is not at hand
  /// Of readRegistrationReport(): what was found of each scan, shown with the pictures that registration left in the
  /// capture's folder `registration`; "" where it is not at hand.
  std::string registration_json;
  std::filesystem::path capture;
};

/// Reads what `compress --report` wrote. Throws InputError where it is not there or something else.
std::string readCompressReport(const std::filesystem::path& file);

/// Reads what `register --report` wrote. Throws InputError where it is not there or something else.
std::string readRegistrationReport(const std::filesystem::path& file);

/// Writes a page that holds all it shows: no network, no files beside it. It appears whole or not at all.
/// evaluation  with pictures (EvaluateOptions::pictures)
/// progress  may be null
/// Throws InputError for damaged images of the package or of the registration, OutputError.
void writeHtmlReport(const std::filesystem::path& file, const Package& package, const Evaluation& evaluation,
                     const HtmlReportOptions& options, Progress* progress = nullptr);

}  // namespace facezip
