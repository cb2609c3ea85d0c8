// method_record.hpp - how a package was made, as package.json keeps it: enough to make it again.
#pragma once

#include <string>

#include "facezip/compress.hpp"

namespace facezip::compress {

/// Name of a method on the command line and in records: "refined", "closed-loop", "paper", "no-permutation".
const char* methodName(CompressOptions::Method method);

/// The options and results as the JSON text of package.json's "method". Holds nothing that differs from run to run.
std::string methodJson(const CompressOptions& options, const CompressReport& report, const std::string& region);

/// The options that methodJson() recorded; memory_bytes is not among them.
/// file  package.json, for the message. Throws InputError when the record is not one of ours.
CompressOptions optionsFromMethodJson(const std::string& json_text, const std::string& file);

}  // namespace facezip::compress
