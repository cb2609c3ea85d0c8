#include "facezip/capture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "face/face.hpp"
#include "facezip/printable.hpp"
#include "io/staged_directory.hpp"
#include "notes.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::Notes;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// The message of the InputError that opening `folder` throws.
std::string failure(const fs::path& folder) {
  try {
    openCapture(folder);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Capture, IsFoundByNames) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "bob", {.expressions = 3, .width = 8, .height = 8, .maps = {"normal", "albedo"}});
  io::writeTextFile(folder / "bob/face_region.txt", "0 1 2");
  const Capture capture = openCapture(folder / "bob");
  EXPECT_EQ(capture.name, "bob");
  EXPECT_THAT(capture.expressions, ElementsAre("e00", "e01", "e02"));
  ASSERT_EQ(capture.maps.size(), 2u);
  EXPECT_EQ(capture.maps[0].name, "albedo");
  EXPECT_EQ(capture.maps[1].expressions[2], folder / "bob/normal/e02.png");
  EXPECT_TRUE(capture.face_region.has_value());
  EXPECT_EQ(capture.unit, "");
}

TEST(Capture, DescriptionDecidesOrderFilesAndWeights) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3, .width = 8, .height = 8});
  fs::create_directory(folder / "c/renders");
  fs::copy_file(folder / "c/albedo/e00.png", folder / "c/renders/beauty.png");
  io::writeTextFile(folder / "c/capture.json", R"({"name": "Bob", "unit": "m", "expressions": ["e02", "smile"],
      "maps": {"albedo": {"colour_space": "sRGB", "weight": 0.5, "expressions": {"smile": "albedo/e00.png"}}}})");
  const Capture capture = openCapture(folder / "c");
  EXPECT_EQ(capture.name, "Bob");
  EXPECT_EQ(capture.unit, "m");
  EXPECT_THAT(capture.expressions, ElementsAre("e02", "smile"));
  ASSERT_EQ(capture.maps.size(), 1u);
  EXPECT_EQ(capture.maps[0].metric_weight, 0.5);
  EXPECT_EQ(capture.maps[0].expressions[1].filename(), "e00.png");
}

TEST(Capture, TexturesOfOneTileAreThoseOfItsUvs) {
  const test::TemporaryDirectory folder;
  const fs::path face = folder / "c";
  test::writeSmallCapture(face, {.expressions = 2, .width = 16, .height = 16});
  for (const char* name : {"neutral", "e00", "e01"}) {
    fs::rename(face / "albedo" / (std::string(name) + ".png"), face / "albedo" / (std::string(name) + ".1012.png"));
  }
  geometry::TriangleMesh mesh = geometry::readObj(face / "neutral.obj");
  const Eigen::MatrixX2d uvs = mesh.uvs;
  mesh.uvs.rowwise() += Eigen::RowVector2d(1, 1);
  const Eigen::Index last = mesh.uv_triangles.rows() - 1;
  mesh.uvs.conservativeResize(mesh.uvs.rows() + 1, 2);  // a triangle of another tile: no texture of ours
  mesh.uvs.bottomRows(1) << 4.5, 0.5;
  mesh.uv_triangles.row(last).setConstant(static_cast<int>(mesh.uvs.rows()) - 1);
  geometry::writeObj(face / "neutral.obj", mesh);
  const Capture capture = openCapture(face);
  EXPECT_EQ(capture.tile, 1012);
  EXPECT_THAT(capture.expressions, ElementsAre("e00", "e01"));
  EXPECT_EQ(capture.maps[0].expressions[1].filename(), "e01.1012.png");
  const compress::Face read = compress::readFace(capture, "whole");
  EXPECT_LT((read.mesh.uvs.topRows(uvs.rows()) - uvs).norm(), 1e-9);
  EXPECT_EQ(std::ssize(read.region), last);
  EXPECT_EQ(read.region_description, "whole mesh, tile 1012");
}

TEST(Capture, OfSeveralTilesOneIsChosen) {
  const test::TemporaryDirectory folder;
  const fs::path face = folder / "c";
  test::writeSmallCapture(face, {.expressions = 2, .width = 16, .height = 16});
  for (const char* name : {"neutral", "e00", "e01"}) {
    const std::string file = (face / "albedo" / name).string();
    fs::copy_file(file + ".png", file + ".1002.png");
    fs::rename(file + ".png", file + ".1001.png");
  }
  EXPECT_THAT(failure(face), AllOf(HasSubstr("1001, 1002"), HasSubstr("\"tile\" in capture.json")));
  io::writeTextFile(face / "capture.json", R"({"tile": 1003})");
  EXPECT_THAT(failure(face), HasSubstr("1001, 1002"));
  io::writeTextFile(face / "capture.json", R"({"tile": 1002})");
  EXPECT_EQ(openCapture(face).maps[0].neutral.filename(), "neutral.1002.png");
  EXPECT_THROW(compress::readFace(openCapture(face), "whole"), InputError) << "UVs lie in tile 1001";
  io::writeTextFile(face / "capture.json", R"({"tile": 1001})");
  EXPECT_NO_THROW(compress::readFace(openCapture(face), "whole"));
}

TEST(Capture, ImportanceIsFoundOrNamed) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8});
  EXPECT_FALSE(openCapture(folder / "c").importance.has_value());
  fs::copy_file(folder / "c/albedo/e00.png", folder / "c/importance.png");
  EXPECT_EQ(openCapture(folder / "c").importance, folder / "c/importance.png");
  EXPECT_EQ(openCapture(folder / "c").maps.size(), 1u) << "the painted image is no map";
  io::writeTextFile(folder / "c/capture.json", R"({"importance": "albedo/e01.png"})");
  EXPECT_EQ(openCapture(folder / "c").importance, folder / "c/albedo/e01.png");
  io::writeTextFile(folder / "c/capture.json", R"({"importance": 1})");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("importance: expected a string"));
}

TEST(Capture, MeshesAreFoundWhateverTheCaseOfTheirExtension) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8});
  fs::rename(folder / "c/neutral.obj", folder / "c/neutral.OBJ");
  fs::create_directory(folder / "c/expressions");
  fs::copy_file(folder / "c/neutral.OBJ", folder / "c/expressions/e00.OBJ");
  fs::copy_file(folder / "c/neutral.OBJ", folder / "c/expressions/e01.obj");
  Notes notes;
  const Capture capture = openCapture(folder / "c", {}, &notes);
  EXPECT_EQ(capture.neutral_mesh, folder / "c/neutral.OBJ");
  EXPECT_THAT(capture.expression_meshes,
              ElementsAre(folder / "c/expressions/e00.OBJ", folder / "c/expressions/e01.obj"));
  EXPECT_THAT(notes.all, testing::IsEmpty());
  fs::copy_file(folder / "c/neutral.OBJ", folder / "c/expressions/e01.OBJ");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("e01.OBJ and e01.obj"));
}

TEST(Capture, MeshesThatMatchNoExpressionAreNoted) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3, .width = 8, .height = 8});
  const auto notesWith = [&](const std::vector<std::string>& meshes) {
    fs::remove_all(folder / "c/expressions");
    fs::create_directory(folder / "c/expressions");
    for (const std::string& mesh : meshes) fs::copy_file(folder / "c/neutral.obj", folder / "c/expressions" / mesh);
    Notes notes;
    openCapture(folder / "c", {}, &notes);
    return notes.all;
  };
  EXPECT_THAT(notesWith({}), ElementsAre(HasSubstr("no meshes of expressions: textures will change")));
  EXPECT_THAT(notesWith({"e00.obj", "e01.obj", "e02.obj", "neutral.obj", "notes.txt"}), testing::IsEmpty());
  EXPECT_THAT(notesWith({"e00.obj", "e01.obj"}), ElementsAre(HasSubstr("expressions: no mesh for e02 (")));
  EXPECT_THAT(notesWith({"E00.obj", "e01.obj", "e02.obj"}),
              ElementsAre(HasSubstr("expressions: E00.obj matches no expression; no mesh for e00 (")));
  EXPECT_THAT(notesWith({"a0.obj", "a1.obj", "a2.obj", "a3.obj", "a4.obj", "a5.obj", "a6.obj", "a7.obj", "a8.obj",
                         "a9.obj", "e00.obj", "e01.obj", "e02.obj"}),
              ElementsAre(HasSubstr("a6.obj, a7.obj and 2 more match no expression (")));
}

TEST(Capture, MeshesInAnotherPlaceAreFoundOrNamed) {
  const test::TemporaryDirectory folder;
  const fs::path c = folder / "c";
  test::writeSmallCapture(c, {.expressions = 2, .width = 8, .height = 8});
  const auto put = [&](const fs::path& file) {
    fs::create_directories((c / file).parent_path());
    fs::copy_file(c / "neutral.obj", c / file);
  };
  Notes notes;
  const auto open = [&] {
    notes.all.clear();
    return openCapture(c, {}, &notes).expression_meshes;
  };
  for (const fs::path place : {"Expressions", "meshes", ""}) {
    put(place / "e00.obj");
    put(place / "other.obj");
    EXPECT_THAT(open(), ElementsAre(c / place / "e00.obj", fs::path())) << place;
    ASSERT_FALSE(notes.all.empty());
    EXPECT_THAT(notes.all.front(), testing::AllOf(HasSubstr((place.empty() ? c : c / place).string() + ": taken for")));
    EXPECT_THAT(notes.all.back(), HasSubstr("no mesh for e01"));
    fs::remove(c / place / "other.obj");
    if (place.empty())
      fs::remove(c / "e00.obj");
    else
      fs::rename(c / place, folder / place);
  }
  // expressions/ goes first, and several others are a question.
  fs::rename(folder / "meshes", c / "meshes");
  fs::rename(folder / "Expressions", c / "more");
  EXPECT_THAT(open(), ElementsAre(fs::path(), fs::path()));
  EXPECT_THAT(notes.all, ElementsAre(HasSubstr("meshes/ and more/ hold some, and none is taken; meshes belong in")));
  put("expressions/e01.obj");
  EXPECT_THAT(open(), ElementsAre(fs::path(), c / "expressions/e01.obj"));
  // A template has a neutral of its own.
  fs::remove_all(c / "expressions");
  fs::remove_all(c / "more");
  put("meshes/neutral.obj");
  EXPECT_THAT(open(), ElementsAre(fs::path(), fs::path()));
  EXPECT_THAT(notes.all, ElementsAre(HasSubstr("meshes/ holds OBJ files that are not taken; meshes belong in")));
  // As FaceScape calls them, whatever else lies there.
  put("models_reg/2_smile.obj");
  io::writeTextFile(c / "capture.json", R"({"expression_meshes": {"e00": "models_reg/2_smile.obj"}})");
  EXPECT_THAT(open(), ElementsAre(c / "models_reg/2_smile.obj", fs::path()));
  io::writeTextFile(c / "capture.json", R"({"expression_meshes": {"e0O": "models_reg/2_smile.obj"}})");
  EXPECT_THAT(failure(c), testing::AllOf(HasSubstr("expression_meshes"), HasSubstr("e0O")));
  io::writeTextFile(c / "capture.json", R"({"expression_meshes": {"e00": 3}})");
  EXPECT_THAT(failure(c), HasSubstr("expression_meshes.e00: expected a string"));
}

// "e" and an accent, as macOS names files, is the letter that keyboards give.
TEST(Capture, NamesAreComparedAsTheyLook) {
  const test::TemporaryDirectory folder;
  const fs::path c = folder / "cafe\u0301";
  test::writeSmallCapture(c, {.expressions = 2, .width = 8, .height = 8, .maps = {"albedo", "normal"}});
  fs::rename(c / "albedo/e00.png", c / "albedo/e\u0301.png");
  fs::rename(c / "normal/e00.png", c / "normal/\u00e9.png");
  fs::create_directory(c / "expressions");
  for (const char* mesh : {"e\u0301.obj", "e01.obj"}) fs::copy_file(c / "neutral.obj", c / "expressions" / mesh);
  Notes notes;
  const Capture capture = openCapture(c, {}, &notes);
  EXPECT_EQ(capture.name, "caf\u00e9");
  EXPECT_THAT(capture.expressions, ElementsAre("e01", "\u00e9"));
  EXPECT_EQ(capture.maps[0].expressions[1], c / "albedo/e\u0301.png") << "files keep theirs";
  EXPECT_THAT(capture.expression_meshes, ElementsAre(c / "expressions/e01.obj", c / "expressions/e\u0301.obj"));
  EXPECT_THAT(notes.all, testing::IsEmpty());

  fs::rename(c / "normal", c / "no\u0308rmal");
  EXPECT_EQ(openCapture(c, {"n\u00f6rmal"}).maps.at(0).name, "n\u00f6rmal");
  io::writeTextFile(c / "capture.json", R"({"expressions": ["\u00e9", "e01"], "maps": {"n\u00f6rmal": {}},
                                            "expression_meshes": {"e\u0301": "neutral.obj"}})");
  EXPECT_THAT(openCapture(c).expression_meshes, ElementsAre(c / "neutral.obj", c / "expressions/e01.obj"));
  io::writeTextFile(c / "capture.json",
                    R"({"expression_meshes": {"e\u0301": "neutral.obj", "\u00e9": "neutral.obj"}})");
  EXPECT_THAT(failure(c), HasSubstr("expression_meshes: expected each name once"));
  fs::remove(c / "capture.json");
  fs::copy_file(c / "albedo/e01.png", c / "albedo/\u00e9.png");
  EXPECT_THAT(failure(c), HasSubstr("expected one texture"));
  fs::remove(c / "albedo/\u00e9.png");
  fs::copy_file(c / "neutral.obj", c / "expressions/\u00e9.obj");
  EXPECT_THAT(failure(c), HasSubstr("expected one file, got two, whose names"));
}

TEST(Capture, FoldersOfPreviewsAndReferencesAreNoMaps) {
  const test::TemporaryDirectory folder;
  const fs::path c = folder / "c";
  test::writeSmallCapture(c, {.expressions = 2, .width = 8, .height = 8});
  fs::create_directory(c / "expressions");
  for (const char* name : {"e00", "e01"}) {
    fs::copy_file(c / "neutral.obj", c / "expressions" / (std::string(name) + ".obj"));
    fs::copy_file(c / "albedo/e00.png", c / "expressions" / (std::string(name) + ".png"));
  }
  fs::create_directory(c / "reference");
  for (const char* name : {"left.png", "left.tif", "right.png"}) {
    fs::copy_file(c / "albedo/e00.png", c / "reference" / name);
  }
  Notes notes;
  const Capture capture = openCapture(c, {}, &notes);
  ASSERT_EQ(capture.maps.size(), 1u);
  EXPECT_THAT(capture.expressions, ElementsAre("e00", "e01"));
  EXPECT_THAT(notes.all, ElementsAre(HasSubstr("expressions: its images are no map's, since meshes are there"),
                                     HasSubstr("reference: its images are no map's, since none is the neutral's")));
  fs::copy_file(c / "albedo/e00.png", c / "expressions/neutral.png");
  EXPECT_EQ(openCapture(c).maps.size(), 1u);
  EXPECT_EQ(openCapture(c, {"expressions"}).maps.size(), 1u) << "by its name it is one";
  // What lacks its neutral, or an expression, is a map to be mended: nothing of it is dropped silently.
  fs::rename(c / "reference/left.png", c / "reference/e00.png");
  EXPECT_THAT(failure(c), testing::AllOf(HasSubstr("reference/neutral.png: map \"reference\""),
                                         HasSubstr("leave reference/ out with --maps albedo, or list")));
  // So is the one that is in the way: fewer maps have what it has.
  fs::copy(c / "albedo", c / "normal");
  fs::copy(c / "albedo", c / "specular");
  fs::copy_file(c / "albedo/e00.png", c / "normal/grin.png");
  fs::rename(c / "reference", folder / "reference");
  EXPECT_THAT(failure(c), testing::AllOf(HasSubstr("albedo/grin.png: map \"albedo\""),
                                         HasSubstr("leave normal/ out with --maps albedo,specular, or")));
  fs::remove_all(c / "normal");
  fs::remove_all(c / "specular");
  // Where nothing else is a map, the images beside the meshes are.
  fs::rename(c / "albedo", folder / "albedo");
  EXPECT_EQ(openCapture(c).maps.at(0).name, "expressions");
}

TEST(Capture, OfFaceScapeIsDescribedNotRenamed) {
  const test::TemporaryDirectory folder;
  const fs::path c = folder / "122";
  test::writeSmallCapture(folder / "small", {.expressions = 2, .width = 8, .height = 8});
  for (const char* name : {"1_neutral", "2_smile", "3_mouth_stretch"}) {
    for (const char* to : {"models_reg/NAME.obj", "models_reg/NAME.jpg", "dpmap/NAME.png"}) {
      const fs::path file = c / std::string(to).replace(std::string(to).find("NAME"), 4, name);
      fs::create_directories(file.parent_path());
      fs::copy_file(folder / (file.extension() == ".obj" ? "small/neutral.obj" : "small/albedo/e00.png"), file);
    }
  }
  io::writeTextFile(c / "capture.json", R"({"neutral": "1_neutral", "meshes": "models_reg",
      "maps": {"albedo": {"folder": "models_reg", "colour_space": "sRGB"}, "displacement": {"folder": "dpmap"}}})");
  Notes notes;
  const Capture capture = openCapture(c, {}, &notes);
  EXPECT_THAT(notes.all, testing::IsEmpty());
  EXPECT_EQ(capture.neutral_mesh, c / "models_reg/1_neutral.obj");
  EXPECT_THAT(capture.expressions, ElementsAre("2_smile", "3_mouth_stretch"));
  EXPECT_EQ(capture.expression_meshes[0], c / "models_reg/2_smile.obj");
  ASSERT_EQ(capture.maps.size(), 2u);
  EXPECT_EQ(capture.maps[0].neutral, c / "models_reg/1_neutral.jpg");
  EXPECT_EQ(capture.maps[1].expressions[1], c / "dpmap/3_mouth_stretch.png");
  io::writeTextFile(c / "capture.json", R"({"neutral": "1_neutral", "neutral_mesh": "models_reg/1_neutral.obj",
      "meshes": "model_reg", "maps": {"albedo": {"folder": "models_reg"}}})");
  EXPECT_THAT(failure(c), testing::AllOf(HasSubstr("capture.json: meshes: expected a folder of OBJ files"),
                                         HasSubstr("model_reg, which is not there")));
}

TEST(Capture, NeutralsOfTheIctFaceKitAreFound) {
  const test::TemporaryDirectory folder;
  const fs::path c = folder / "c";
  test::writeSmallCapture(c, {.expressions = 2, .width = 8, .height = 8});
  fs::rename(c / "neutral.obj", c / "generic_neutral_mesh.obj");
  for (const char* name : {"identity000.obj", "e00.obj", "e01.obj"}) {
    fs::copy_file(c / "generic_neutral_mesh.obj", c / name);
  }
  Notes notes;
  const Capture capture = openCapture(c, {}, &notes);
  EXPECT_EQ(capture.neutral_mesh, c / "generic_neutral_mesh.obj");
  EXPECT_THAT(capture.expression_meshes, ElementsAre(c / "e00.obj", c / "e01.obj"));
  EXPECT_THAT(notes.all, ElementsAre(HasSubstr("taken for the meshes")));
  fs::copy_file(c / "generic_neutral_mesh.obj", c / "neutral.obj");
  EXPECT_EQ(openCapture(c).neutral_mesh, c / "neutral.obj");
}

TEST(Capture, HasTheNameOfItsDirectoryHoweverThatIsWritten) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "bob", {.expressions = 1, .width = 8, .height = 8});
  for (const char* path : {"bob", "bob/", "bob//", "bob/.", "bob/albedo/.."}) {
    EXPECT_EQ(openCapture(folder / path).name, "bob") << path;
  }
}

TEST(Capture, FoldersThatCannotBeReadAreRefused) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 1, .width = 8, .height = 8});
  fs::create_directory(folder / "c/expressions");
  if (::geteuid() == 0) GTEST_SKIP() << "root reads every folder";
  for (const char* name : {"c/expressions", "c/albedo", "c"}) {
    fs::permissions(folder / name, fs::perms::none);
    EXPECT_THAT(failure(folder / "c"), HasSubstr("Permission denied")) << name;
    fs::permissions(folder / name, fs::perms::owner_all);
  }
}

TEST(Capture, MapsCanBeChosen) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8, .maps = {"albedo", "normal"}});
  EXPECT_EQ(openCapture(folder / "c", {"normal"}).maps.size(), 1u);
  EXPECT_THROW(openCapture(folder / "c", {"roughness"}), InputError);
}

TEST(Capture, SaysWhatIsMissing) {
  const test::TemporaryDirectory folder;
  EXPECT_THAT(failure(folder / "none"), HasSubstr("no such directory"));
  EXPECT_THAT(failure("/proc/self/cmdline"), HasSubstr("a file"));
  fs::create_directory(folder / "empty");
  EXPECT_THAT(failure(folder / "empty"), HasSubstr("neutral.obj"));

  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8, .maps = {"albedo", "normal"}});
  fs::remove(folder / "c/normal/e01.png");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("e01"));
  fs::remove(folder / "c/albedo/neutral.png");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("neutral.png"));
}

TEST(Capture, RefusesTwoExpressionsOfOneName) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8});
  fs::copy_file(folder / "c/albedo/e00.png", folder / "c/albedo/e00.tif");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("e00.png and e00.tif"));
  fs::remove(folder / "c/albedo/e00.tif");
  io::writeTextFile(folder / "c/capture.json", R"({"expressions": ["e00", "e00"]})");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("the same name twice"));
}

TEST(Capture, MalformedDescriptionNamesTheField) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8});
  const auto with = [&](const std::string& text) {
    io::writeTextFile(folder / "c/capture.json", text);
    return failure(folder / "c");
  };
  EXPECT_THAT(with("{"), HasSubstr("expected JSON"));
  EXPECT_THAT(with("[]"), HasSubstr("an object"));
  EXPECT_THAT(with(R"({"unit": 3})"), HasSubstr("unit: expected a string"));
  EXPECT_THAT(with(R"({"maps": {"albedo": {"weight": -1}}})"), HasSubstr("maps.albedo.weight"));
  EXPECT_THAT(with(R"({"maps": {"albedo": 3}})"), HasSubstr("maps.albedo: "));
  EXPECT_THAT(with(R"({"maps": {"foo": {}}})"),
              testing::AllOf(HasSubstr("c/foo: map \"foo\""), HasSubstr("no such folder")));
  EXPECT_THAT(with(R"({"expressions": "e00"})"), HasSubstr("expressions: expected an array"));
  EXPECT_THAT(with(R"({"expressions": [3]})"), HasSubstr("expressions[0]: expected a string"));
  EXPECT_THAT(with(R"({"maps": {"albedo": {"expressions": {"e00": 3}}}})"),
              HasSubstr("maps.albedo.expressions.e00: expected a string"));
  EXPECT_THAT(with(R"({"expressions": ["e00"], "maps": {"albedo": {"expressions": {"e0O": "albedo/e01.png"}}}})"),
              testing::AllOf(HasSubstr("maps.albedo.expressions"), HasSubstr("e0O")));
  EXPECT_THAT(with(R"({"maps": {"albedo": {"weight": 1e999}}})"), HasSubstr("capture.json: expected"));
  EXPECT_THAT(with(std::string(1000, '[')), HasSubstr("nested"));
  fs::remove(folder / "c/capture.json");
  fs::create_directory(folder / "c/capture.json");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("capture.json: expected the description of a capture, got a folder"));
}

// What a package cannot hold is found before the work, and blamed on the capture.
TEST(Capture, RefusesWhatAPackageCannotHold) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8});
  const auto with = [&](const std::string& text) {
    io::writeTextFile(folder / "c/capture.json", text);
    const std::string message = failure(folder / "c");
    EXPECT_THAT(message, HasSubstr((folder / "c/capture.json").string()));
    return message;
  };
  EXPECT_THAT(with(R"({"maps": {"albedo": {"colour_space": "srgb"}}})"),
              HasSubstr("maps.albedo.colour_space: expected \"sRGB\", \"linear\" or \"\", got \"srgb\"; see"));
  EXPECT_THAT(with(R"({"maps": {"albedo": {"weight": 1.1e9}}})"),
              HasSubstr("maps.albedo.weight: expected a number from 0 to 1000000000, got 1100000000.0; see"));
  for (const std::string name : {"a..b", "a/b", ".a", "a\\\\b", "a\\u0001b"}) {
    EXPECT_THAT(with("{\"maps\": {\"" + name + "\": {}}}"), HasSubstr("map: expected a name without"));
    EXPECT_THAT(with("{\"expressions\": [\"" + name + "\"]}"), HasSubstr("expression: expected a name without"));
  }
  const std::string longest(200, 'a');
  EXPECT_THAT(with("{\"maps\": {\"" + longest + "a\": {}}}"), HasSubstr("map: expected a name of at most 200 bytes"));
  EXPECT_THAT(with("{\"expressions\": [\"" + longest + "a\"]}"), HasSubstr("expression: expected a name of at most"));
  EXPECT_THAT(with(R"({"expressions": ["a,b"]})"), HasSubstr("without '/', '\\', ',', '=', '..'"));
}

TEST(Capture, TakesNamesOf200Bytes) {
  const test::TemporaryDirectory folder;
  const std::string longest(200, 'a');
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8, .maps = {longest}});
  for (const char* name : {"neutral", "e00", "e01"}) {
    const std::string to = std::string(name) == "e01" ? longest : name;
    fs::rename(folder / "c" / longest / (std::string(name) + ".png"), folder / "c" / longest / (to + ".png"));
  }
  EXPECT_THAT(openCapture(folder / "c").expressions, ElementsAre(longest, "e00"));
}

TEST(Capture, RefusesFilesWhoseNamesAPackageCannotHold) {
  const test::TemporaryDirectory folder;
  const fs::path capture = folder / "c";
  test::writeSmallCapture(capture, {.expressions = 2, .width = 8, .height = 8, .maps = {"albedo", "normal"}});
  for (const std::string& name :
       {std::string("a..b"), std::string(201, 'a'), std::string("a\xff"), std::string("a\t")}) {
    fs::rename(capture / "normal", capture / name);
    EXPECT_THAT(failure(capture), HasSubstr(printable((capture / name).string()) + ": map: expected a name "));
    EXPECT_EQ(openCapture(capture, {"albedo"}).maps.size(), 1u) << "what is not taken does not matter";
    fs::rename(capture / name, capture / "normal");
    for (const char* map : {"albedo", "normal"}) fs::rename(capture / map / "e01.png", capture / map / (name + ".png"));
    EXPECT_THAT(failure(capture),
                HasSubstr(printable((capture / "albedo" / (name + ".png")).string()) + ": expression: expected"));
    for (const char* map : {"albedo", "normal"}) fs::rename(capture / map / (name + ".png"), capture / map / "e01.png");
  }
  fs::rename(capture, folder / "c\xff");
  EXPECT_THAT(failure(folder / "c\xff"), HasSubstr("name: expected a name in UTF-8"));
  io::writeTextFile(folder / "c\xff/capture.json", R"({"name": "Bob"})");
  EXPECT_EQ(openCapture(folder / "c\xff").name, "Bob");
}

TEST(Capture, AMapIsTakenOnce) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder.path(), {.expressions = 2});
  EXPECT_THROW(openCapture(folder.path(), {"albedo", "albedo"}), InputError);
}

}  // namespace
}  // namespace facezip
