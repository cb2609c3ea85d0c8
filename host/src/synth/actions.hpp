// actions.hpp - what single muscles and the jaw do to the skin: a basis of actions named as in ARKit.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "synth/head_mesh.hpp"

namespace facezip::synth {

/// Which skin a pull moves: all of it, or only one side of the line between the lips.
enum class Lip { kBoth, kUpper, kLower };

/// Skin around a point is displaced, fading like a Gaussian. Millimetres on the skin and in space.
struct Pull {
  double s, t;                ///< centre
  double radius_s, radius_t;  ///< where the displacement has fallen to 1/e
  double x, y, z;             ///< displacement
  Lip lip = Lip::kBoth;
};

/// One action at full strength.
struct Action {
  std::string name;
  std::vector<Pull> pulls;
  double jaw_angle = 0.0;                               ///< opening of the jaw, radians
  Eigen::Vector3d jaw_shift = Eigen::Vector3d::Zero();  ///< sliding of the jaw, metres
  Openings opening_change{};                            ///< added to the neutral's openings
};

/// Every action, sided ones as NAMELeft and NAMERight (the subject's sides). The order is part of the seeds' meaning.
const std::vector<Action>& actionBasis();

/// An action and how strongly it is performed.
struct WeightedAction {
  const Action* action = nullptr;
  double weight = 0.0;
};

/// Positions (#V by 3) of `head` while it performs `actions`.
/// performance  varies the motion smoothly by some per cent, as no two performances are alike; never moves still skin
Eigen::MatrixX3d deform(const HeadMesh& head, const HeadShape& shape, const std::vector<WeightedAction>& actions,
                        std::uint64_t performance);

}  // namespace facezip::synth
