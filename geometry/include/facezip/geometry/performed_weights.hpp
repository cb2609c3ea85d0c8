// performed_weights.hpp - how strongly people performed what they were asked for.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace facezip::geometry {

/// Weights of one subject's expressions, N by M, at least 0. An expression is asked for by whole shapes; how far a
/// person then goes is partly the performance and partly how far that person's shape goes at all, which the meshes
/// cannot tell apart. So of what a bounded fit says of an asked shape beside what was asked, `performance` is taken for
/// the performance, and the rest is left to the shape. What was not asked for is held near 0.
/// shapes       M displacements, #V by 3: what is known of the subject's
/// examples     N displacements, #V by 3
/// asked        N by M in [0, 1]
/// performance  in [0, 1]
/// Throws SolverError.
Eigen::MatrixXd performedWeights(const std::vector<Eigen::MatrixX3f>& shapes,
                                 const std::vector<Eigen::MatrixX3f>& examples, const Eigen::MatrixXd& asked,
                                 double performance);

}  // namespace facezip::geometry
