// tables.hpp - results as tables for the terminal.
#pragma once

#include "facezip/alignment.hpp"
#include "facezip/compress.hpp"
#include "facezip/convert.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/learn.hpp"
#include "facezip/registration.hpp"
#include "facezip/rig.hpp"

namespace facezip::cli {

void printCompressReport(const CompressReport& report);
/// Formats, bytes and distance of the frames of every map; memory, times.
void printConvertReport(const ConvertReport& report);
/// RMSE by expression and method of every map, texel errors, angles of normals, blends and the ablation where there is
/// one; then memory, then times.
void printEvaluation(const Evaluation& evaluation);
/// Residuals, coverage and head motion of each scan, times.
void printRegistrationReport(const RegistrationReport& report);
void printAlignmentReport(const AlignmentReport& report);
/// Residuals of each expression beside the template's, convergence, textures, times.
void printRigReport(const RigReport& report);
/// What was chosen for the regression, how well shapes and textures are predicted, times.
void printTrainReport(const TrainReport& report);
/// How usual the neutral is, which maps were generated, times.
void printGenerateReport(const GenerateReport& report);
/// Residuals over the frames, and frames a second.
void printSolvedClip(const SolvedClip& clip);

}  // namespace facezip::cli
