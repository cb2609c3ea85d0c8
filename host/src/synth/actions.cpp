#include "synth/actions.hpp"

#include <cmath>

#include "synth/noise.hpp"

namespace facezip::synth {
namespace {

enum class Sides {
  kMirrored,   ///< two actions, Left as written and Right its mirror image
  kSymmetric,  ///< one action; every pull off the midline acts on both sides
  kSideways,   ///< two actions whose pulls act across the midline
};

struct ActionRecipe {
  const char* name;
  Sides sides;
  std::vector<Pull> pulls;
  double jaw_angle = 0.0;
  Eigen::Vector3d jaw_shift_mm = Eigen::Vector3d::Zero();
  Opening lids = {0.0, 0.0};  ///< change of the left eye's opening
};

// Coordinates are those of SkinPoint, in millimetres: corner of the mouth (25, 0), wing of the nose (13, 26), eye
// (31, 66), brow (12..48, 84), chin (0, -33).
const std::vector<ActionRecipe>& recipes() {
  static const std::vector<ActionRecipe> table = {
      {"browDown",
       Sides::kMirrored,
       {{13, 82, 11, 11, -4.5, -5.5, 1}, {34, 86, 17, 11, -2, -5, 0.5}},
       0,
       {0, 0, 0},
       {-0.12, 0}},
      {"browInnerUp", Sides::kSymmetric, {{12, 86, 13, 17, 1, 8, 0}, {8, 112, 20, 16, 0, 2.5, 0}}},
      {"browOuterUp", Sides::kMirrored, {{40, 88, 16, 17, 0, 7.5, 0}}, 0, {0, 0, 0}, {0.1, 0}},
      {"cheekPuff", Sides::kSymmetric, {{40, 2, 19, 20, 7, 0, 6}, {0, 10, 16, 6, 0, 0, 2.5, Lip::kUpper}}},
      {"cheekSquint", Sides::kMirrored, {{36, 42, 17, 13, 1, 5.5, 3}}, 0, {0, 0, 0}, {0, -0.25}},
      {"eyeBlink", Sides::kMirrored, {{32, 80, 16, 8, 0, -1.2, 0}}, 0, {0, 0, 0}, {-1.42, -0.2}},
      {"eyeSquint",
       Sides::kMirrored,
       {{33, 57, 17, 7, 0, 3, 1}, {53, 66, 10, 11, -4.5, 0, 0.5}},
       0,
       {0, 0, 0},
       {-0.2, -0.45}},
      {"eyeWide", Sides::kMirrored, {{32, 80, 15, 9, 0, 1.5, 0}}, 0, {0, 0, 0}, {0.38, 0.12}},
      {"jawForward", Sides::kSymmetric, {}, 0, {0, -0.5, 8}},
      {"jawLeft", Sides::kSideways, {}, 0.02, {8.5, 0, 0}},
      {"jawOpen", Sides::kSymmetric, {{24, -3, 13, 12, -2.5, 0, 0}}, 0.27},
      {"mouthDimple", Sides::kMirrored, {{28, 0, 9, 10, 4.5, 1, -4.5}}},
      {"mouthFrown", Sides::kMirrored, {{25, -2, 14, 14, 1, -7.5, -1}, {17, -28, 12, 10, 0, 2, 1}}},
      {"mouthFunnel",
       Sides::kSymmetric,
       {{25, 0, 16, 14, -6.5, 0, 5}, {0, 5, 15, 8, 0, 3, 5, Lip::kUpper}, {0, -5, 15, 8, 0, -4, 5, Lip::kLower}}},
      {"mouthLeft", Sides::kSideways, {{8, 0, 27, 18, 9.5, 1, -1}, {36, 12, 14, 16, 1, 2.5, 2}}},
      {"mouthLowerDown", Sides::kMirrored, {{13, -5, 12, 10, 1, -5.5, 0.5, Lip::kLower}}},
      {"mouthPress",
       Sides::kMirrored,
       {{14, 4, 14, 7, 0, -2, -2, Lip::kUpper}, {14, -5, 14, 7, 0, 2.5, -2, Lip::kLower}, {29, -1, 9, 9, 1.5, 0, -2}}},
      {"mouthPucker",
       Sides::kSymmetric,
       {{25, 0, 16, 14, -10, 0, 5}, {0, 5, 13, 8, 0, -0.5, 6}, {0, -6, 13, 8, 0, 0.5, 6}}},
      {"mouthRollLower",
       Sides::kSymmetric,
       {{0, -4, 21, 6, 0, 3, -5, Lip::kLower}, {0, -16, 18, 8, 0, 1.5, 1.5, Lip::kLower}}},
      {"mouthRollUpper", Sides::kSymmetric, {{0, 4, 21, 6, 0, -2.5, -5, Lip::kUpper}}},
      {"mouthShrugLower",
       Sides::kSymmetric,
       {{0, -31, 17, 12, 0, 7, 3.5}, {0, -6, 19, 8, 0, 3.5, 2.5, Lip::kLower}, {0, 5, 17, 7, 0, 2, 1.5, Lip::kUpper}}},
      {"mouthShrugUpper", Sides::kSymmetric, {{0, 6, 18, 9, 0, 3, 3.5, Lip::kUpper}}},
      {"mouthSmile", Sides::kMirrored, {{26, 1, 17, 16, 8, 7, -4}, {38, 32, 15, 13, 1, 4, 3}}},
      {"mouthStretch", Sides::kMirrored, {{27, -3, 18, 17, 8.5, -3.5, -3}, {34, -58, 18, 20, 1.5, 4, 1.5}}},
      {"mouthUpperUp", Sides::kMirrored, {{13, 6, 12, 11, 1, 5.5, 1, Lip::kUpper}}},
      {"noseSneer",
       Sides::kMirrored,
       {{13, 26, 9, 11, 1, 6.5, 1}, {24, 13, 12, 9, 1, 4.5, 2, Lip::kUpper}, {6, 70, 9, 9, -0.5, -3, 0.5}}},
  };
  return table;
}

std::vector<Pull> mirrored(std::vector<Pull> pulls) {
  for (Pull& pull : pulls) {
    pull.s = -pull.s;
    pull.x = -pull.x;
  }
  return pulls;
}

Action makeAction(const ActionRecipe& recipe, std::string name) {
  Action action{std::move(name), recipe.pulls, recipe.jaw_angle, 1e-3 * recipe.jaw_shift_mm, {}};
  action.opening_change.fill({0.0, 0.0});
  return action;
}

Action makeMirror(const ActionRecipe& recipe, std::string name) {
  Action action = makeAction(recipe, std::move(name));
  action.pulls = mirrored(action.pulls);
  action.jaw_shift.x() = -action.jaw_shift.x();
  return action;
}

Action makeSymmetric(const ActionRecipe& recipe) {
  Action action = makeAction(recipe, recipe.name);
  for (const Pull& pull : mirrored(recipe.pulls)) {
    if (pull.s != 0.0) action.pulls.push_back(pull);
  }
  return action;
}

std::vector<Action> makeActionBasis() {
  std::vector<Action> basis;
  for (const ActionRecipe& recipe : recipes()) {
    if (recipe.sides == Sides::kSymmetric) {
      basis.push_back(makeSymmetric(recipe));
      continue;
    }
    std::string name = recipe.name;
    if (recipe.sides == Sides::kSideways) name.resize(name.size() - std::string_view("Left").size());
    basis.push_back(makeAction(recipe, name + "Left"));
    basis.back().opening_change[kLeftEye] = recipe.lids;
    basis.push_back(makeMirror(recipe, name + "Right"));
    basis.back().opening_change[kRightEye] = recipe.lids;
  }
  return basis;
}

/// How much skin goes with the lower jaw, 0..1: all of the chin, less towards the hinge and down the neck.
double jawShare(const GridVertex& vertex) {
  const double back = smoothStep(0.112, 0.040, std::abs(vertex.s));
  const double neck = smoothStep(-0.112, -0.052, vertex.t);
  return vertex.lower_lip * mix(0.25, 1.0, back) * neck;
}

Eigen::Vector3d pullDisplacement(const Pull& pull, const GridVertex& vertex) {
  const double ds = (1e3 * vertex.s - pull.s) / pull.radius_s;
  const double dt = (1e3 * vertex.t - pull.t) / pull.radius_t;
  const double squared = ds * ds + dt * dt;
  // Cut off smoothly, so that far skin stays exactly still and differences stay local.
  if (squared >= 6.0) return Eigen::Vector3d::Zero();
  double share = std::exp(-squared) * smoothStep(6.0, 3.0, squared);
  if (pull.lip == Lip::kUpper) share *= 1.0 - vertex.lower_lip;
  if (pull.lip == Lip::kLower) share *= vertex.lower_lip;
  return 1e-3 * share * Eigen::Vector3d(pull.x, pull.y, pull.z);
}

/// The jaw turns around an axis through its two joints, in front of the ears.
Eigen::Vector3d jawDisplacement(const Eigen::Vector3d& position, double angle, const Eigen::Vector3d& shift) {
  const Eigen::Vector2d hinge(0.016, 0.008);  // y, z
  const double y = position.y() - hinge.x();
  const double z = position.z() - hinge.y();
  const double cosine = std::cos(angle);
  const double sine = std::sin(angle);
  return Eigen::Vector3d(0.0, y * (cosine - 1.0) - z * sine, z * (cosine - 1.0) + y * sine) + shift;
}

}  // namespace

const std::vector<Action>& actionBasis() {
  static const std::vector<Action> basis = makeActionBasis();
  return basis;
}

Eigen::MatrixX3d deform(const HeadMesh& head, const HeadShape& shape, const std::vector<WeightedAction>& actions,
                        std::uint64_t performance) {
  Openings openings;
  for (const auto& [action, weight] : actions) {
    for (std::size_t h = 0; h < kHoleCount; ++h) {
      openings[h].upper += weight * action->opening_change[h].upper;
      openings[h].lower += weight * action->opening_change[h].lower;
    }
  }
  Eigen::MatrixX3d positions(head.mesh.positions.rows(), 3);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const auto i = static_cast<std::size_t>(v);
    const GridVertex& vertex = head.grid[i];
    const Eigen::Vector3d base = shape.position(head.skinPoint(i, openings));
    Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
    double jaw_angle = 0.0;
    Eigen::Vector3d jaw_shift = Eigen::Vector3d::Zero();
    for (const auto& [action, weight] : actions) {
      for (const Pull& pull : action->pulls) displacement += weight * pullDisplacement(pull, vertex);
      jaw_angle += weight * action->jaw_angle;
      jaw_shift += weight * action->jaw_shift;
    }
    const double jaw = jawShare(vertex);
    displacement += jawDisplacement(base, jaw * jaw_angle, jaw * jaw_shift);
    const float variation =
        gradientNoise(static_cast<float>(vertex.s / 0.03), static_cast<float>(vertex.t / 0.03), performance);
    positions.row(v) = base + (1.0 + 0.2 * static_cast<double>(variation)) * displacement;
  }
  return positions;
}

}  // namespace facezip::synth
