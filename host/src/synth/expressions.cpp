#include "synth/expressions.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "synth/noise.hpp"

namespace facezip::synth {
namespace {

struct Part {
  const char* action;  ///< a sided action's bare name means both sides
  double weight;
};

struct ClassicalExpression {
  const char* name;
  double flush;
  std::vector<Part> parts;
};

const std::vector<ClassicalExpression>& classicalExpressions() {
  static const std::vector<ClassicalExpression> table = {
      {"jaw_open_wide", 0.0, {{"jawOpen", 1.0}, {"mouthStretch", 0.15}}},
      {"smile_closed", 0.2, {{"mouthSmile", 0.9}, {"cheekSquint", 0.4}, {"eyeSquint", 0.2}}},
      {"smile_open",
       0.3,
       {{"mouthSmile", 1.0},
        {"jawOpen", 0.35},
        {"cheekSquint", 0.7},
        {"mouthUpperUp", 0.5},
        {"mouthLowerDown", 0.3},
        {"eyeSquint", 0.4}}},
      {"frown_brow", 0.0, {{"browDown", 1.0}}},
      {"brow_raise", 0.0, {{"browInnerUp", 1.0}, {"browOuterUp", 1.0}, {"eyeWide", 0.4}}},
      {"disgust_nose_sneer",
       0.3,
       {{"noseSneer", 1.0}, {"browDown", 0.5}, {"mouthUpperUp", 0.7}, {"eyeSquint", 0.4}, {"cheekSquint", 0.4}}},
      {"eyes_closed_tight",
       0.4,
       {{"eyeBlink", 1.0}, {"eyeSquint", 1.0}, {"cheekSquint", 0.8}, {"browDown", 0.5}, {"noseSneer", 0.2}}},
      {"mouth_pucker", 0.0, {{"mouthPucker", 1.0}}},
      {"mouth_funnel", 0.0, {{"mouthFunnel", 1.0}, {"jawOpen", 0.2}}},
      {"cheek_puff", 0.5, {{"cheekPuff", 1.0}, {"mouthPress", 0.3}}},
      {"mouth_left", 0.0, {{"mouthLeft", 1.0}}},
      {"mouth_right", 0.0, {{"mouthRight", 1.0}}},
      {"lip_press",
       0.1,
       {{"mouthPress", 1.0}, {"mouthRollLower", 0.5}, {"mouthRollUpper", 0.5}, {"mouthShrugLower", 0.3}}},
      {"sad", -0.2, {{"browInnerUp", 0.8}, {"mouthFrown", 0.8}, {"mouthShrugLower", 0.4}, {"browDown", 0.2}}},
      {"anger",
       0.8,
       {{"browDown", 1.0}, {"eyeSquint", 0.4}, {"noseSneer", 0.5}, {"mouthPress", 0.5}, {"mouthStretch", 0.2}}},
      {"surprise", -0.2, {{"browInnerUp", 1.0}, {"browOuterUp", 1.0}, {"eyeWide", 1.0}, {"jawOpen", 0.55}}},
      {"fear",
       -0.8,
       {{"browInnerUp", 0.9}, {"browOuterUp", 0.4}, {"eyeWide", 1.0}, {"mouthStretch", 0.9}, {"jawOpen", 0.2}}},
      {"wink_left",
       0.0,
       {{"eyeBlinkLeft", 1.0}, {"cheekSquintLeft", 0.9}, {"mouthSmileLeft", 0.4}, {"browDownLeft", 0.3}}},
      {"blow", 0.3, {{"cheekPuff", 0.6}, {"mouthPucker", 0.8}}},
      {"jaw_forward_chin_raise", 0.0, {{"jawForward", 1.0}, {"mouthShrugLower", 1.0}}},
  };
  return table;
}

constexpr std::array kUpperActions = {"browDown", "browInnerUp", "browOuterUp", "cheekSquint",
                                      "eyeBlink", "eyeSquint",   "eyeWide"};
constexpr std::array kLowerActions = {"cheekPuff",    "jawOpen",      "mouthDimple",     "mouthFrown",
                                      "mouthFunnel",  "mouthLeft",    "mouthLowerDown",  "mouthPress",
                                      "mouthPucker",  "mouthRight",   "mouthShrugLower", "mouthSmile",
                                      "mouthStretch", "mouthUpperUp", "noseSneer"};

/// Adds the action of that name, or both sides of it.
void addPart(const Part& part, std::vector<WeightedAction>& actions) {
  const std::string name = part.action;
  for (const Action& action : actionBasis()) {
    if (action.name == name || action.name == name + "Left" || action.name == name + "Right") {
      actions.push_back({&action, part.weight});
    }
  }
}

Expression makeExpression(std::string name, double flush, const std::vector<Part>& parts, std::uint64_t seed) {
  Expression expression{std::move(name), {}, flush, 0};
  for (const Part& part : parts) addPart(part, expression.actions);
  assert(!expression.actions.empty());
  expression.take = deriveSeed(seed, expression.name);
  // Nobody performs at full strength or alike on both sides.
  Random random(deriveSeed(expression.take, "strength"));
  const double strength = random.between(0.82, 1.08);
  for (WeightedAction& action : expression.actions) action.weight *= strength * random.between(0.88, 1.12);
  expression.flush += random.between(-0.15, 0.15);
  return expression;
}

/// The i-th of all pairs of an upper-face and a lower-face action, in an order drawn from the seed.
Expression makePair(std::size_t i, std::uint64_t seed) {
  std::vector<std::size_t> order(kUpperActions.size() * kLowerActions.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  Random random(deriveSeed(seed, "pairs"));
  for (std::size_t k = order.size() - 1; k > 0; --k) std::swap(order[k], order[random.bits() % (k + 1)]);
  const char* upper = kUpperActions[order[i] % kUpperActions.size()];
  const char* lower = kLowerActions[order[i] / kUpperActions.size()];
  return makeExpression(std::string(upper) + "_" + lower, 0.0, {{upper, 0.9}, {lower, 0.9}}, seed);
}

}  // namespace

std::vector<Expression> makeExpressions(int count, std::uint64_t seed) {
  assert(count >= 1 && count <= 100);
  const auto wanted = static_cast<std::size_t>(count);
  std::vector<Expression> expressions;
  for (const ClassicalExpression& classical : classicalExpressions()) {
    expressions.push_back(makeExpression(classical.name, classical.flush, classical.parts, seed));
  }
  for (const Action& action : actionBasis()) {
    expressions.push_back(makeExpression(action.name, 0.0, {{action.name.c_str(), 1.0}}, seed));
  }
  for (std::size_t i = 0; expressions.size() < wanted; ++i) expressions.push_back(makePair(i, seed));
  expressions.resize(wanted);
  return expressions;
}

}  // namespace facezip::synth
