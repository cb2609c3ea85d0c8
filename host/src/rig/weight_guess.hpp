// weight_guess.hpp - the weights that captured expressions are thought to have, from a file that people write.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace facezip::rig {

/// Reads a guess: N by M, weights from 0 to 1; 0 where the file says nothing.
///   .csv   a header of shapes after a first column of any name, then a row for each expression: its name, its weights
///   .json  {"EXPRESSION": {"SHAPE": weight, ...}, ...}
/// Expressions that the file leaves out have a row of 0s, as neutral ones would: refused, since that would mislead.
/// Throws InputError naming file, line or field: an unknown or repeated name, a missing expression, a weight that is no
/// number from 0 to 1.
Eigen::MatrixXd readGuess(const std::filesystem::path& file, const std::vector<std::string>& expressions,
                          const std::vector<std::string>& shapes);

}  // namespace facezip::rig
