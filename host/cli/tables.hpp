// tables.hpp - results as tables for the terminal.
#pragma once

#include "facezip/compress.hpp"
#include "facezip/evaluate.hpp"

namespace facezip::cli {

void printCompressReport(const CompressReport& report);
/// RMSE by expression and method of every map, then memory, then times.
void printEvaluation(const Evaluation& evaluation);

}  // namespace facezip::cli
