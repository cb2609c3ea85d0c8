// sheets_module.hpp - the entries of the module that draws pictures; loaded_sheets.cpp calls them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/package.hpp"

extern "C" {
void facezipWriteContactSheet(const std::filesystem::path& file, const facezip::Capture& capture,
                              const facezip::Package& package, const std::filesystem::path& decoded);
void facezipWriteErrorSheet(const std::filesystem::path& file, const facezip::Evaluation& evaluation,
                            const std::vector<std::string>& titles);
}
