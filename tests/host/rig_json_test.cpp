// rig.json of strangers: refused by field, and before it takes memory.
#include "rig/rig_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "facezip/error.hpp"

namespace facezip {
namespace {
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

json document() {
  return {{"format", "facezip-rig"},
          {"version", 1},
          {"millimetres_per_unit", 1000.0},
          {"skin_vertices", 25},
          {"shapes", {"jawOpen", "smile"}},
          {"expressions", json::array({{{"name", "e0"}, {"captured", "e0"}, {"weights", {{"smile", 0.5}}}}})}};
}

std::string messageOf(const json& rig_json) {
  try {
    rig::parseRig(rig_json.dump(), "rig.json");
  } catch (const InputError& error) {
    EXPECT_LT(std::strlen(error.what()), 1000u);
    return error.what();
  }
  return "";
}

TEST(RigJson, IsRead) {
  const Rig rig = rig::parseRig(document().dump(), "rig.json");
  EXPECT_THAT(rig.shapes, ElementsAre("jawOpen", "smile"));
  EXPECT_THAT(rig.weights, ElementsAre(ElementsAre(0.0, 0.5)));
}

TEST(RigJson, FaultsAreNamed) {
  const auto with = [](const char* pointer, const json& value) {
    json changed = document();
    changed[json::json_pointer(pointer)] = value;
    return messageOf(changed);
  };
  EXPECT_THAT(with("/format", "zip"), HasSubstr("format"));
  EXPECT_THAT(with("/version", 2), HasSubstr("version"));
  EXPECT_THAT(with("/skin_vertices", 0), HasSubstr("skin_vertices"));
  for (const char* name : {"", "../x", "a/b", "a\\b", ".x", "a..b", "\x1b[31m", "a\nb"}) {
    EXPECT_THAT(with("/shapes/0", name), HasSubstr("shapes[0]")) << name;
    EXPECT_THAT(with("/expressions/0/name", name), HasSubstr("expressions[0].name")) << name;
  }
  EXPECT_THAT(with("/shapes/1", "jawOpen"), HasSubstr("shapes[1]: expected unique names"));
  EXPECT_THAT(with("/expressions/0/weights/other", 0.5), HasSubstr("expressions[0].weights: expected names of shapes"));
  EXPECT_THAT(with("/expressions/0/weights/smile", 1.5), HasSubstr("expressions[0].weights.smile"));
  json long_name = document();
  long_name["expressions"][0]["weights"][std::string(1000000, 'x')] = 0.5;
  EXPECT_THAT(messageOf(long_name), HasSubstr("names of shapes"));
}

/// A megabyte of it once made tables of 65536 x 65536 weights.
TEST(RigJson, NumbersOfWeightsAreLimited) {
  json wide = document();
  for (int m = 0; m < 5000; ++m) wide["shapes"].push_back("s" + std::to_string(m));
  EXPECT_THAT(messageOf(wide), HasSubstr("shapes: expected an array of 1 to 4096"));
  json large = document();
  for (int m = 0; m < 2000; ++m) large["shapes"].push_back("s" + std::to_string(m));
  for (int n = 0; n < 1000; ++n) large["expressions"].push_back(large["expressions"][0]);
  EXPECT_THAT(messageOf(large), HasSubstr("shapes: expected at most 4096, and 1048576 weights of 1001 expressions"));
}

TEST(RigJson, DeepAndWideDocumentsAreRefused) {
  EXPECT_THROW(rig::parseRig(std::string(100000, '['), "rig.json"), InputError);
  std::string many = "[";
  for (int i = 0; i < 3000000; ++i) many += "{},";
  EXPECT_THROW(rig::parseRig(many + "0]", "rig.json"), InputError);
}

}  // namespace
}  // namespace facezip
