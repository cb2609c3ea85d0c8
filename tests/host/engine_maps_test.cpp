// What engines get of a package decodes to what the package does: the numbers in their shaders, the texels beside them.
#include "export/engine_maps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "export/godot_shader.hpp"
#include "export/hlsl_text.hpp"
#include "image/image_file.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
using exporting::EngineMap;
using mesh::MapRole;
using testing::HasSubstr;

/// Maps of every number of channels, of 8 and 16 bits, in two sets of weights, with names that no shader takes.
Package awkwardPackage(const std::filesystem::path& directory, int differences) {
  test::SamplePackage sample =
      test::makeSample({{.name = "Albedo 1"},
                        {.name = "albedo-1", .channels = 1, .difference_bits = 16},
                        {.name = "2 \"normals\"", .channels = 4, .type = SampleType::kUint16, .weight_set = 1},
                        {.name = "roughness", .channels = 2, .type = SampleType::kUint16, .difference_bits = 16},
                        {.name = "height", .channels = 1, .type = SampleType::kFloat32}},
                       5, differences);
  test::writeSample(sample, directory);
  return Package::open(directory);
}

TEST(EngineMaps, HaveRolesAndNamesThatShadersTake) {
  const test::TemporaryDirectory folder;
  const std::vector<EngineMap> maps = exporting::engineMaps(awkwardPackage(folder / "package", 4));
  ASSERT_EQ(maps.size(), 4u) << "floats are left out";
  EXPECT_EQ(maps[0].id, "Albedo_1");
  EXPECT_EQ(maps[1].id, "albedo_1_2") << "files whose names differ by more than case";
  EXPECT_EQ(maps[2].id, "map_2_normals");
  EXPECT_EQ(maps[0].role, MapRole::kAlbedo);
  EXPECT_EQ(maps[1].role, MapRole::kOther) << "the first has the role";
  EXPECT_EQ(maps[2].role, MapRole::kNormal);
  EXPECT_EQ(maps[3].role, MapRole::kRoughness);
}

TEST(MapRoles, NamesOfTheTradeAreKnown) {
  const std::pair<const char*, MapRole> kNames[] = {{"albedo", MapRole::kAlbedo},
                                                    {"BaseColor", MapRole::kAlbedo},
                                                    {"T_Face_base_colour", MapRole::kAlbedo},
                                                    {"Diffuse", MapRole::kAlbedo},
                                                    {"faceAlbedomap2", MapRole::kAlbedo},
                                                    {"Color", MapRole::kAlbedo},
                                                    {"AO", MapRole::kOcclusion},
                                                    {"AOMap", MapRole::kOcclusion},
                                                    {"Ambient Occlusion", MapRole::kOcclusion},
                                                    {"Normal_OpenGL", MapRole::kNormal},
                                                    {"diffuse_normal", MapRole::kNormal},
                                                    {"Face-NRM", MapRole::kNormal},
                                                    {"Roughness", MapRole::kRoughness},
                                                    {"SkinRough", MapRole::kRoughness},
                                                    {"Normal_DirectX", MapRole::kOther},
                                                    {"NormalDX", MapRole::kOther},
                                                    {"specular_albedo", MapRole::kOther},
                                                    {"chaos", MapRole::kOther},
                                                    {"protocol", MapRole::kOther},
                                                    {"displacement", MapRole::kOther},
                                                    {"", MapRole::kOther}};
  for (const auto& [name, role] : kNames) EXPECT_EQ(mesh::roleOf(name), role) << name;
}

TEST(MapRoles, WhatNoMaterialShowsIsSaid) {
  const auto named = [](const std::vector<std::string>& names) {
    std::vector<PackageMap> maps;
    for (const std::string& name : names) maps.emplace_back().name = name;
    return maps;
  };
  const std::vector<MapRole> traced = {MapRole::kAlbedo, MapRole::kNormal};
  EXPECT_THAT(mesh::notesOfRoles(named({"BaseColor", "Normal_OpenGL"}), traced), testing::IsEmpty());
  EXPECT_THAT(mesh::notesOfRoles(named({"albedo", "diffuse", "gloss", "AO"}), traced),
              testing::ElementsAre(HasSubstr("diffuse: not in the material, where albedo is the albedo"),
                                   HasSubstr("gloss: not in the material"), HasSubstr("AO: not in the material")));
  EXPECT_THAT(mesh::notesOfRoles(named({"skin"}), traced),
              testing::ElementsAre(HasSubstr("skin: not in"), HasSubstr("the face is gray")));
}

TEST(EngineMaps, TexturesOfEightBitsDecodeToTheDifferences) {
  const test::TemporaryDirectory folder;
  const Package package = awkwardPackage(folder / "package", 5);
  for (const EngineMap& map : exporting::engineMaps(package)) {
    Progress progress;
    std::filesystem::create_directories(folder / "textures");
    exporting::writeNeutral(package, map, folder / "textures", progress);
    exporting::writeStack(package, map, folder / "textures", progress);
    const image::Image neutral = image::readImage(folder / "textures" / (map.id + "_neutral.png"));
    EXPECT_EQ(neutral.shape.type, SampleType::kUint8);
    EXPECT_EQ(neutral.shape.channels, map.map.channels);
    const image::Image stack = image::readImage(folder / "textures" / (map.id + "_differences.png"));
    ASSERT_EQ(stack.shape.height, 5 * map.map.height);
    for (std::size_t i = 0; i < 5; ++i) {
      const PackageDifference& difference = map.map.differences[i];
      const image::Image codes = image::readImage(package.directory() / difference.file);
      const bool wide = codes.shape.type == SampleType::kUint16;
      const auto channels = static_cast<std::size_t>(map.map.channels);
      const std::size_t count = codes.samples.size() / (wide ? 2 : 1);
      for (std::size_t s = 0; s < count; ++s) {
        const std::size_t c = s % channels;
        std::uint16_t code = std::to_integer<std::uint16_t>(codes.samples[wide ? 2 * s : s]);
        if (wide) std::memcpy(&code, codes.samples.data() + 2 * s, 2);
        const double exact = (difference.scale[c] * code + difference.offset[c]) / 255.0;
        const double sampled = std::to_integer<int>(stack.samples[i * count + s]) / 255.0;
        const double got = map.differences[i].scale[c] * (sampled - map.differences[i].zero[c]);
        // One step of 8 bits, half of it in zero and half in the code; nothing is lost where codes have 8 bits.
        ASSERT_NEAR(got, exact, wide ? 257.0 * difference.scale[c] / 255.0 : 1e-12) << map.id << ' ' << i << ' ' << s;
        if (exact == 0.0) {
          ASSERT_NEAR(got, 0.0, 1e-12);
        }
      }
    }
  }
}

TEST(EngineMaps, ShadersReadGrayAndAlphaWhereImportersPutThem) {
  const test::TemporaryDirectory folder;
  const Package package = awkwardPackage(folder / "package", 6);  // the second file of weights is gray and alpha
  const std::vector<EngineMap> maps = exporting::engineMaps(package);
  const std::string godot = exporting::godotShader(package, maps);
  EXPECT_THAT(godot, HasSubstr("vec4(codes.ra, 0.0, 0.0)"));
  EXPECT_THAT(godot, HasSubstr("value = vec4(value.ra, 0.0, 0.0)"));
  EXPECT_THAT(godot, HasSubstr("value = vec4(value.r, 0.0, 0.0, 0.0)"));
  const std::string hlsl = exporting::hlslFunctions(package, maps, exporting::Rows::kFromTop, "", exporting::noBlocks);
  EXPECT_THAT(hlsl, HasSubstr(".xwyz;"));
}

TEST(EngineMaps, StacksThatFitNowhereAreRefused) {
  const test::TemporaryDirectory folder;
  const Package package = awkwardPackage(folder / "package", 4);
  EngineMap map = exporting::engineMaps(package)[0];
  map.map.width = map.map.height = 8192;
  EXPECT_EQ(exporting::stackLayout(package, map).columns, 2);
  map.map.height = 16384;
  EXPECT_THROW(exporting::stackLayout(package, map), InputError);
}

TEST(Literals, AlwaysHaveAPointAndNoExponent) {
  EXPECT_EQ(exporting::literal(0.0), "0.0");
  EXPECT_EQ(exporting::literal(-2.0), "-2.0");
  EXPECT_EQ(exporting::literal(0.5), "0.5");
  EXPECT_EQ(exporting::literal(1.5e-7), "0.00000015");
  EXPECT_EQ(exporting::literal(123456.25), "123456.25");
}

}  // namespace
}  // namespace facezip
