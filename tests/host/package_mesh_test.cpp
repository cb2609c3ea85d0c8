// mesh.glb of strangers: refused where it leads out of the file, or is not what docs/package_format.md says.
#include "mesh/package_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <ostream>

#include "file_contents.hpp"
#include "mesh/gltf_scene.hpp"
#include "scene/glb.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
using nlohmann::json;
using testing::HasSubstr;

/// A mesh as facezip writes it: 25 vertices, two targets, one of which moves one vertex.
std::string goodFile() {
  const test::TemporaryDirectory folder;
  mesh::GltfScene scene;
  scene.name = "face";
  scene.neutral = test::gridMesh(5);
  Eigen::MatrixX3d raised = scene.neutral.positions;
  raised(7, 2) += 0.01;
  scene.targets = {{"smile", raised}, {"turned", scene.neutral.positions * 1.1}};
  mesh::writeGltf(folder / "mesh.glb", scene);
  return test::contentsOf(folder / "mesh.glb");
}

/// A file in parts, to be changed and put together again.
struct Parts {
  json document;
  std::string binary;

  static Parts of(const std::string& file) {
    const scene::GlbParts parts = scene::splitGlb(std::as_bytes(std::span(file)), "good");
    return {json::parse(parts.json),
            std::string(reinterpret_cast<const char*>(parts.binary.data()), parts.binary.size())};
  }
  std::string file() const { return scene::joinGlb(document.dump(), std::as_bytes(std::span(binary))); }

  json& primitive() { return document["meshes"][0]["primitives"][0]; }
  /// The accessor of an attribute.
  json& accessor(const char* attribute) {
    return document["accessors"][primitive()["attributes"][attribute].get<std::size_t>()];
  }
  json& target(std::size_t t) {
    return document["accessors"][primitive()["targets"][t]["POSITION"].get<std::size_t>()];
  }
  json& view(const json& accessor) { return document["bufferViews"][accessor["bufferView"].get<std::size_t>()]; }
  std::size_t offset(const json& accessor) { return view(accessor).value("byteOffset", std::size_t{0}); }
  template <typename Number>
  void put(std::size_t at, Number value) {
    std::memcpy(binary.data() + at, &value, sizeof(value));
  }
};

std::string messageOf(const std::string& file) {
  try {
    mesh::parsePackageMesh(file, "mesh.glb");
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("mesh.glb"));
    EXPECT_LT(std::strlen(error.what()), 1000u);
    return error.what();
  }
  return "";
}

TEST(PackageMesh, WhatFacezipWritesIsWholeAndComesBack) {
  const std::string file = goodFile();
  const mesh::PackageMesh found = mesh::parsePackageMesh(file, "mesh.glb");
  EXPECT_EQ(found.vertices, 25u);
  EXPECT_EQ(found.targets, 2u);
  const Parts before = Parts::of(file), after = Parts::of(mesh::packageMeshFile(found));
  EXPECT_EQ(after.binary, before.binary);
  EXPECT_EQ(after.document["meshes"], before.document["meshes"]);
  EXPECT_EQ(after.document["nodes"], before.document["nodes"]);
  EXPECT_EQ(after.document["accessors"].size(), before.document["accessors"].size());
  EXPECT_EQ(messageOf(mesh::packageMeshFile(found)), "");
}

TEST(PackageMesh, WhatIsNotKnownIsLeftOut) {
  Parts parts = Parts::of(goodFile());
  parts.document["animations"] = json::array({{{"name", "x"}}});
  parts.document["extensions"] = {{"KHR_lights", {{"uri", "../evil"}}}};
  parts.document["extensionsUsed"] = {"KHR_lights"};
  parts.document["nodes"].push_back({{"name", "\x1b[31m"}, {"extras", {{"script", "evil"}}}});
  parts.document["cameras"] = json::array({json::object()});
  parts.primitive()["extensions"] = {{"x", {{"uri", "../evil"}}}};
  parts.document["materials"][0]["extras"] = {{"uri", "../evil"}};
  const std::string text = mesh::parsePackageMesh(parts.file(), "mesh.glb").document.dump();
  EXPECT_THAT(text, testing::Not(HasSubstr("evil")));
  EXPECT_THAT(text, testing::Not(HasSubstr("extensions")));
}

TEST(PackageMesh, TruncatedAtEveryLengthIsRefused) {
  const std::string file = goodFile();
  for (std::size_t length = 0; length < file.size(); ++length) {
    EXPECT_NE(messageOf(file.substr(0, length)), "") << length;
    // With a header that says so.
    std::string named = file.substr(0, length);
    const auto bytes = static_cast<std::uint32_t>(length);
    if (length >= 12) std::memcpy(named.data() + 8, &bytes, 4);
    EXPECT_NE(messageOf(named), "") << length;
  }
  EXPECT_THAT(messageOf(file + "more"), HasSubstr("mesh.glb"));
}

TEST(PackageMesh, NestingAndNumbersOfValuesAreLimited) {
  const auto file = [](const std::string& text) { return scene::joinGlb(text, {}); };
  for (const char* open : {"[", "{\"a\":"}) {
    std::string deep;
    for (int i = 0; i < 200000; ++i) deep += open;
    EXPECT_THAT(messageOf(file(deep)), HasSubstr("at most 64 nested levels"));
  }
  std::string many = "[";
  for (int i = 0; i < 3000000; ++i) many += "[],";
  EXPECT_THAT(messageOf(file(many + "0]")), HasSubstr("values"));
  EXPECT_THAT(messageOf(file("\"" + std::string(5000000, 'a'))), HasSubstr("JSON"));
}

struct Fault {
  const char* name;
  std::function<void(Parts&)> make;
  const char* expected;  // part of the message
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class FaultyMesh : public testing::TestWithParam<Fault> {};

TEST_P(FaultyMesh, IsRefusedByField) {
  Parts parts = Parts::of(goodFile());
  GetParam().make(parts);
  EXPECT_THAT(messageOf(parts.file()), HasSubstr(GetParam().expected));
}

constexpr auto kHuge = std::uint64_t{1} << 40;

INSTANTIATE_TEST_SUITE_P(
    Documents, FaultyMesh,
    testing::Values(
        Fault{"no_asset", [](Parts& p) { p.document.erase("asset"); }, "asset"},
        Fault{"older", [](Parts& p) { p.document["asset"]["version"] = "1.0"; }, "asset.version"},
        Fault{"array", [](Parts& p) { p.document = json::array(); }, "expected an object"},
        Fault{"required", [](Parts& p) { p.document["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
              "extensionsRequired"},
        Fault{"image",
              [](Parts& p) {
                p.document["images"] = json::array({{{"uri", "../evil.sh"}}});
              },
              "images: expected an array of 0"},
        Fault{"image_within",
              [](Parts& p) {
                p.document["images"] = json::array({{{"bufferView", 0}, {"mimeType", "image/png"}}});
              },
              "images"},
        Fault{"texture", [](Parts& p) { p.document["textures"] = json::array({json::object()}); }, "textures"},
        Fault{"no_buffers", [](Parts& p) { p.document.erase("buffers"); }, "buffers"},
        Fault{"empty_buffers", [](Parts& p) { p.document["buffers"] = json::array(); },
              "buffers: expected an array of 1"},
        Fault{"two_buffers",
              [](Parts& p) {
                p.document["buffers"].push_back({{"uri", "../evil"}, {"byteLength", 4}});
              },
              "buffers: expected an array of 1"},
        Fault{"uri", [](Parts& p) { p.document["buffers"][0]["uri"] = "../evil.sh"; }, "buffers[0].uri"},
        Fault{"data_uri",
              [](Parts& p) { p.document["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAA"; },
              "buffers[0].uri"},
        Fault{"empty_uri", [](Parts& p) { p.document["buffers"][0]["uri"] = ""; }, "buffers[0].uri"},
        Fault{"long_buffer", [](Parts& p) { p.document["buffers"][0]["byteLength"] = p.binary.size() + 4; },
              "buffers[0].byteLength"},
        Fault{"huge_buffer", [](Parts& p) { p.document["buffers"][0]["byteLength"] = kHuge; }, "buffers[0].byteLength"},
        Fault{"no_bytes", [](Parts& p) { p.binary.clear(); }, "buffers[0].byteLength"},
        Fault{"view_of_another", [](Parts& p) { p.document["bufferViews"][0]["buffer"] = 1; }, "bufferViews[0].buffer"},
        Fault{"view_beyond", [](Parts& p) { p.document["bufferViews"][0]["byteOffset"] = p.binary.size() - 4; },
              "bufferViews[0].byteLength"},
        Fault{"view_negative", [](Parts& p) { p.document["bufferViews"][0]["byteOffset"] = -4; },
              "bufferViews[0].byteOffset"},
        Fault{"view_huge", [](Parts& p) { p.document["bufferViews"][0]["byteLength"] = kHuge; },
              "bufferViews[0].byteLength"},
        Fault{"stride", [](Parts& p) { p.view(p.accessor("POSITION"))["byteStride"] = 256; }, "byteStride"},
        Fault{"narrow_stride", [](Parts& p) { p.view(p.accessor("POSITION"))["byteStride"] = 8; },
              "elements of 12 bytes"},
        Fault{"wide_stride", [](Parts& p) { p.view(p.accessor("POSITION"))["byteStride"] = 16; },
              "25 elements, 16 bytes apart"},
        Fault{"no_views", [](Parts& p) { p.document.erase("bufferViews"); }, "bufferViews"},
        Fault{"count", [](Parts& p) { p.accessor("POSITION")["count"] = 26; }, "26 elements, 12 bytes apart"},
        Fault{"huge_count", [](Parts& p) { p.accessor("POSITION")["count"] = kHuge; }, "count: expected an integer"},
        Fault{"most_count", [](Parts& p) { p.accessor("POSITION")["count"] = 2147483647; }, "2147483647 elements"},
        Fault{"no_count", [](Parts& p) { p.accessor("POSITION")["count"] = 0; }, "count"},
        Fault{"zeros", [](Parts& p) { p.accessor("POSITION").erase("bufferView"); }, "positions that are stored"},
        Fault{"many_zeros", [](Parts& p) { p.target(0)["count"] = 2000000000; }, "25 vectors of 3 floats"},
        Fault{"unused_zeros",
              [](Parts& p) {
                p.document["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 2000000000}});
              },
              "count: expected 25, the number of vertices"},
        Fault{"type", [](Parts& p) { p.accessor("POSITION")["type"] = "MAT4"; }, "type: expected SCALAR"},
        Fault{"long_type", [](Parts& p) { p.accessor("POSITION")["type"] = std::string(100000, 'x'); },
              "type: expected SCALAR"},
        Fault{"scalars", [](Parts& p) { p.accessor("NORMAL")["type"] = "SCALAR"; }, "25 vectors of 3 floats"},
        Fault{"bytes", [](Parts& p) { p.accessor("POSITION")["componentType"] = 5120; }, "componentType"},
        Fault{"shorts", [](Parts& p) { p.accessor("NORMAL")["componentType"] = 5123; }, "25 vectors of 3 floats"},
        Fault{"unaligned", [](Parts& p) { p.accessor("POSITION")["byteOffset"] = 2; }, "aligned to 4"},
        Fault{"not_a_number",
              [](Parts& p) { p.put(p.offset(p.accessor("POSITION")), std::numeric_limits<float>::quiet_NaN()); },
              "finite numbers"},
        Fault{"infinite",
              [](Parts& p) { p.put(p.offset(p.accessor("TEXCOORD_0")), std::numeric_limits<float>::infinity()); },
              "finite numbers"},
        Fault{"index",
              [](Parts& p) {
                p.put(p.offset(p.document["accessors"][p.primitive()["indices"].get<std::size_t>()]),
                      std::uint32_t{25});
              },
              "indices: expected indices below 25, got 25 at 0"},
        Fault{"most_index",
              [](Parts& p) {
                p.put(p.offset(p.document["accessors"][p.primitive()["indices"].get<std::size_t>()]) + 8,
                      std::uint32_t{0xffffffff});
              },
              "4294967295 at 2"},
        Fault{"no_triangles",
              [](Parts& p) { p.document["accessors"][p.primitive()["indices"].get<std::size_t>()]["count"] = 95; },
              "three indices"},
        Fault{"no_indices", [](Parts& p) { p.primitive().erase("indices"); }, "indices"},
        Fault{"positions_for_indices",
              [](Parts& p) { p.primitive()["indices"] = p.primitive()["attributes"]["POSITION"]; }, "three indices"},
        Fault{"lines", [](Parts& p) { p.primitive()["mode"] = 1; }, "mode"},
        Fault{"reference_beyond", [](Parts& p) { p.primitive()["attributes"]["POSITION"] = 99; },
              "POSITION: expected an integer from 0 to"},
        Fault{"reference_negative", [](Parts& p) { p.primitive()["attributes"]["NORMAL"] = -1; },
              "NORMAL: expected an integer"},
        Fault{"sparse_count", [](Parts& p) { p.target(0)["sparse"]["count"] = 26; }, "sparse.count"},
        Fault{"sparse_more", [](Parts& p) { p.target(0)["sparse"]["count"] = 2; }, "sparse.indices.bufferView"},
        Fault{"sparse_index", [](Parts& p) { p.put(p.offset(p.target(0)["sparse"]["indices"]), std::uint32_t{25}); },
              "rising indices below 25"},
        Fault{"sparse_view", [](Parts& p) { p.target(0)["sparse"]["values"]["bufferView"] = 1000; },
              "sparse.values.bufferView"},
        Fault{
            "sparse_value",
            [](Parts& p) { p.put(p.offset(p.target(0)["sparse"]["values"]), -std::numeric_limits<float>::infinity()); },
            "finite numbers"},
        Fault{"same_bytes",
              [](Parts& p) {
                for (int i = 0; i < 5; ++i) p.document["accessors"].push_back(p.accessor("POSITION"));
              },
              "numbers that no other accessor has"},
        Fault{"no_meshes", [](Parts& p) { p.document["meshes"] = json::array(); }, "meshes: expected an array of 1"},
        Fault{"two_meshes", [](Parts& p) { p.document["meshes"].push_back(p.document["meshes"][0]); },
              "meshes: expected an array of 1"},
        Fault{"no_primitives", [](Parts& p) { p.document["meshes"][0]["primitives"] = json::array(); }, "primitives"},
        Fault{"no_position", [](Parts& p) { p.primitive()["attributes"].erase("POSITION"); }, "POSITION"},
        Fault{"still_target", [](Parts& p) { p.primitive()["targets"][1].erase("POSITION"); }, "targets[1]"},
        Fault{"many_targets",
              [](Parts& p) {
                for (int i = 0; i < 16384; ++i) p.primitive()["targets"].push_back(p.primitive()["targets"][0]);
              },
              "targets: expected an array of 0 to 16384"},
        Fault{"target_names", [](Parts& p) { p.document["meshes"][0]["extras"]["targetNames"] = {"smile"}; },
              "targetNames: expected an array of 2"},
        Fault{"no_target_names", [](Parts& p) { p.document["meshes"][0].erase("extras"); }, "extras"},
        Fault{"unsafe_name", [](Parts& p) { p.document["meshes"][0]["extras"]["targetNames"][0] = "../evil"; },
              "targetNames[0]"},
        Fault{"same_name", [](Parts& p) { p.document["meshes"][0]["extras"]["targetNames"][1] = "smile"; },
              "unique names"}),
    [](const auto& test) { return test.param.name; });

/// No change of a byte makes the reader do anything but refuse, or take it.
TEST(PackageMesh, ChangedBytesAreReadOrRefused) {
  const std::string file = goodFile();
  for (std::size_t i = 0; i < std::min<std::size_t>(file.size(), 4000); ++i) {
    for (const char change : {'\x01', '\x80', '\xff'}) {
      std::string changed = file;
      changed[i] = static_cast<char>(changed[i] ^ change);
      messageOf(changed);
    }
  }
}

}  // namespace
}  // namespace facezip
