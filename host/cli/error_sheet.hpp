// error_sheet.hpp - a picture of what methods leave of every expression.
#pragma once

#include <filesystem>

#include "facezip/evaluate.hpp"

namespace facezip::cli {

/// Writes an image: a row for each expression with the captured texture, each method's and each method's errors, all in
/// one false colour scale whose colour bar stands above. evaluation  with pictures. Throws OutputError.
void writeErrorSheet(const std::filesystem::path& file, const Evaluation& evaluation);

}  // namespace facezip::cli
