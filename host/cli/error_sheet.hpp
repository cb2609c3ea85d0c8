// error_sheet.hpp - a picture of what methods leave of every expression.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "facezip/evaluate.hpp"

namespace facezip::cli {

/// Writes an image: a row for each expression with the captured texture, each method's and each method's errors, all in
/// one false colour scale whose colour bar stands above. Throws OutputError.
/// evaluation  with pictures
/// titles      of the methods of its first pictures
void writeErrorSheet(const std::filesystem::path& file, const Evaluation& evaluation,
                     const std::vector<std::string>& titles);

}  // namespace facezip::cli
