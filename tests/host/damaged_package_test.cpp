// Packages that are not as facezip writes them: refused by file and field.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "facezip/check.hpp"
#include "facezip/package.hpp"
#include "file_contents.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "package/package_json.hpp"
#include "refine/texture_encoding.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using test::contentsOf;
using test::makeSample;
using test::SamplePackage;
using testing::HasSubstr;

/// Opens a package that is damaged; returns the message. Anything but an InputError fails the test.
std::string messageOfOpening(const fs::path& directory) {
  try {
    Package::open(directory);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "expected an InputError";
  return "";
}

TEST(Package, MissingDirectoryAndDescriptionAreNamed) {
  const test::TemporaryDirectory folder;
  EXPECT_THAT(messageOfOpening(folder / "none"), HasSubstr("none/package.json"));
  EXPECT_THAT(messageOfOpening(folder.path()), HasSubstr("package.json"));
  fs::create_directory(folder / "package.json");
  EXPECT_THAT(messageOfOpening(folder.path()), HasSubstr("package.json"));
}

TEST(Package, UnreadableFolderIsNotCalledMissing) {
  if (::geteuid() == 0) GTEST_SKIP() << "root reads every folder";
  const test::TemporaryDirectory folder;
  SamplePackage sample = makeSample({{}}, 2, 1);
  test::writeSample(sample, folder / "package");
  fs::permissions(folder / "package", fs::perms::none);
  EXPECT_THAT(messageOfOpening(folder / "package"), HasSubstr("Permission denied"));
  EXPECT_THAT(messageOfOpening(folder / "package/package.json"), HasSubstr("Permission denied"));
  fs::permissions(folder / "package", fs::perms::owner_all);
}

TEST(Package, APipeIsNotWaitedFor) {
  const test::TemporaryDirectory folder;
  ASSERT_EQ(::mkfifo((folder / "package.json").c_str(), 0600), 0);
  EXPECT_THAT(messageOfOpening(folder.path()), HasSubstr("a pipe"));
}

TEST(Package, DamagedImagesAreNotExportedAgain) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = makeSample({{}}, 2, 1);
  test::writeSample(sample, folder.path());
  io::writeTextFile(folder / sample.description.maps[0].neutral_file, "something else");
  EXPECT_THAT(messageOfOpening(folder.path()),
              testing::AllOf(HasSubstr("write it again"), testing::Not(HasSubstr("export"))));
}

/// Damage inside an image that keeps its length passes Package::open().
TEST(Package, EveryImageIsReadByTheCheckOfTexels) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = makeSample({{}}, 2, 1);
  test::writeSample(sample, folder.path());
  const PackageDescription& description = sample.description;
  Progress progress;
  EXPECT_NO_THROW(checkTexels(Package::open(folder.path()), progress));
  for (const std::string& name :
       {description.weights[0].files[0], description.maps[0].neutral_file, description.maps[0].differences[0].file}) {
    const std::string whole = contentsOf(folder / name);
    std::string damaged = whole;
    const std::size_t data = damaged.find("IDAT") + 8;
    damaged[data] = static_cast<char>(damaged[data] ^ 0x10);
    io::writeTextFile(folder / name, damaged);
    try {
      checkTexels(Package::open(folder.path()), progress);
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
    io::writeTextFile(folder / name, whole);
  }
}

TEST(PackageJson, TruncatedAtEveryLengthIsRefused) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = makeSample({{}}, 2, 1);
  test::writeSample(sample, folder.path());
  const std::string text = contentsOf(folder / "package.json");
  for (std::size_t length = 0; length + 2 <= text.size(); ++length) {
    EXPECT_THROW(package::parsePackageJson(text.substr(0, length), "package.json"), InputError) << length;
  }
  EXPECT_NO_THROW(package::parsePackageJson(text, "package.json"));
}

/// Texts of a few megabytes that take a reader gigabytes, or hours, where it lets them; messages that hold them whole.
TEST(PackageJson, LargeTextsAreRefusedAtOnce) {
  const auto repeated = [](const std::string& begin, const std::string& part, int times) {
    std::string text = begin;
    for (int i = 0; i < times; ++i) text += part;
    return text;
  };
  for (const std::string& text :
       {repeated("[", "{},", 5000000), repeated("[", "[],", 5000000), repeated("{\"a\":", "{\"a\":", 1000000),
        repeated("", "[", 5000000), "{\"a\": \"" + std::string(20000000, 'x'), std::string(20000000, '1'),
        "[" + std::string(20000000, ' ') + "1e999", "{\"" + std::string(20000000, '\x1f')}) {
    try {
      package::parsePackageJson(text, "package.json");
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_LT(std::string(error.what()).size(), 2000u);
    }
  }
}

/// What compress writes is accepted as it comes back from JSON, though the check of zero has no tolerance.
TEST(PackageJson, EveryEncodingKeepsItsZeroThroughText) {
  std::mt19937 random(9);
  std::normal_distribution<float> end(0.0f, 60.0f);
  for (const int bits : {8, 16}) {
    PackageDescription description;
    {
      const test::TemporaryDirectory folder;
      SamplePackage sample = makeSample({{"albedo", 8, 8, 4, SampleType::kUint8, 8, 0, bits}}, 1, 8);
      test::writeSample(sample, folder.path());
      description = sample.description;
    }
    for (int round = 0; round < 200; ++round) {
      for (PackageDifference& difference : description.maps[0].differences) {
        for (std::size_t c = 0; c < 4; ++c) {
          const float a = end(random), b = end(random);
          const compress::TextureEncoding encoding = compress::encodingFor({std::min(a, b), std::max(a, b)}, bits);
          difference.scale[c] = static_cast<double>(encoding.scale);
          difference.offset[c] = static_cast<double>(encoding.offset);
        }
      }
      const PackageDescription read =
          package::parsePackageJson(package::packageJson(description), "package.json");  // throws where zero is lost
      for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(read.maps[0].differences[i].scale, description.maps[0].differences[i].scale);
        EXPECT_EQ(read.maps[0].differences[i].offset, description.maps[0].differences[i].offset);
      }
    }
  }
}

struct Corruption {
  const char* name;
  std::function<void(json&)> apply;
  const char* expected;  // part of the message
};

class CorruptJson : public testing::TestWithParam<Corruption> {};

TEST_P(CorruptJson, IsRefusedByFileAndField) {
  const test::TemporaryDirectory folder;
  SamplePackage sample =
      makeSample({{"albedo", 40, 24, 3, SampleType::kUint8, 8}, {"normal", 40, 24, 3, SampleType::kUint8, 8, 0, 16}});
  test::writeSample(sample, folder.path());
  json document = json::parse(contentsOf(folder / "package.json"));
  GetParam().apply(document);
  io::writeTextFile(folder / "package.json", document.dump());
  const std::string message = messageOfOpening(folder.path());
  EXPECT_THAT(message, HasSubstr((folder / "package.json").string()));
  EXPECT_THAT(message, HasSubstr(GetParam().expected));
}

INSTANTIATE_TEST_SUITE_P(
    Fields, CorruptJson,
    testing::Values(
        Corruption{"format", [](json& j) { j["format"] = "zip"; }, "format: expected \"facezip-package\""},
        Corruption{"no_format", [](json& j) { j.erase("format"); }, "format: got no such field"},
        Corruption{"newer", [](json& j) { j["version"] = 4; },
                   "version: expected 2 or 3, the versions that this facezip reads, got 4; update facezip"},
        Corruption{"older", [](json& j) { j["version"] = 1; },
                   "version: expected 2 or 3, the versions that this facezip reads, got 1; write the package again"},
        Corruption{"version_text", [](json& j) { j["version"] = "2"; }, "version: expected an integer"},
        Corruption{"version_real", [](json& j) { j["version"] = 2.0; }, "version: expected an integer"},
        Corruption{"array", [](json& j) { j = json::array(); }, "expected an object, got an array"},
        Corruption{"generator", [](json& j) { j["generator"] = 3; }, "generator: expected a string"},
        Corruption{"name", [](json& j) { j["name"] = nullptr; }, "name: expected a string"},
        Corruption{"no_expressions", [](json& j) { j["expressions"] = json::array(); },
                   "expressions: expected an array of 1"},
        Corruption{"expressions_text", [](json& j) { j["expressions"] = "a"; }, "expressions: expected an array"},
        Corruption{"twice", [](json& j) { j["expressions"][1] = "expression_0"; },
                   "expressions[1]: expected unique expression names"},
        Corruption{"empty_name", [](json& j) { j["expressions"][0] = ""; }, "expressions[0]"},
        Corruption{"slash", [](json& j) { j["expressions"][2] = "a/b"; }, "expressions[2]"},
        Corruption{"dots", [](json& j) { j["expressions"][2] = ".."; }, "expressions[2]"},
        Corruption{"backslash", [](json& j) { j["expressions"][2] = "a\\b"; }, "expressions[2]"},
        Corruption{"nul", [](json& j) { j["expressions"][2] = std::string("a\0b", 3); }, "a\\x00b"},
        Corruption{"long_name", [](json& j) { j["expressions"][2] = std::string(201, 'a'); }, "at most 200 bytes"},
        Corruption{"differences", [](json& j) { j["differences"] = 9; },
                   "differences: expected an integer from 1 to 8"},
        Corruption{"no_differences", [](json& j) { j["differences"] = 0; }, "differences: expected"},
        Corruption{"fewer_differences", [](json& j) { j["differences"] = 3; },
                   "weights[0].scale: expected an array of 3"},
        Corruption{"weights", [](json& j) { j["weights"] = j["weights"][0]; },
                   "weights: expected an array of 1 to 256, got an object"},
        Corruption{"no_weights", [](json& j) { j["weights"] = json::array(); },
                   "weights: expected an array of 1 to 256, got 0 elements"},
        Corruption{"weight_set", [](json& j) { j["weights"][0] = 1; }, "weights[0]: expected an object"},
        Corruption{"unused_weights", [](json& j) { j["weights"].push_back(j["weights"][0]); },
                   "weights[1]: expected weights that a map uses (maps[].weights), got no map that does"},
        Corruption{"map_weights", [](json& j) { j["maps"][1]["weights"] = 1; },
                   "maps[1].weights: expected an integer from 0 to 0, got 1"},
        Corruption{"map_weights_text", [](json& j) { j["maps"][1]["weights"] = "weights.png"; },
                   "maps[1].weights: expected an integer"},
        Corruption{"no_map_weights", [](json& j) { j["maps"][0].erase("weights"); },
                   "maps[0].weights: got no such field"},
        Corruption{"weight_files", [](json& j) { j["weights"][0]["files"].push_back("w.png"); },
                   "weights[0].files: expected an array of 1"},
        Corruption{"columns", [](json& j) { j["weights"][0]["columns"] = 4294967297; },
                   "weights[0].columns: expected an integer"},
        Corruption{"negative", [](json& j) { j["weights"][0]["rows"] = -1; }, "weights[0].rows: expected an integer"},
        Corruption{"too_few_tiles", [](json& j) { j["weights"][0]["rows"] = 1; }, "tiles for 5 expressions"},
        Corruption{"wide_atlas", [](json& j) { j["weights"][0]["columns"] = 16000; }, "16384"},
        Corruption{"high_atlas", [](json& j) { j["weights"][0]["rows"] = 16000; }, "16384"},
        Corruption{"tile", [](json& j) { j["weights"][0]["tile_width"] = 6; },
                   "maps[0]: expected 40 x 24 texels to need 6 x 3 cells (tile_width, tile_height of weights[0])"},
        Corruption{"tile_huge", [](json& j) { j["weights"][0]["tile_width"] = 2147483647; }, "weights[0].tile_width"},
        Corruption{"border", [](json& j) { j["weights"][0]["border"] = 0; }, "weights[0].border"},
        Corruption{"weight_scale_nan",
                   [](json& j) { j["weights"][0]["scale"][0] = std::numeric_limits<double>::quiet_NaN(); },
                   "weights[0].scale[0]: expected a number"},
        Corruption{"weight_offset", [](json& j) { j["weights"][0]["offset"][3] = 1e300; }, "weights[0].offset[3]"},
        Corruption{"weights_outside", [](json& j) { j["weights"][0]["files"][0] = "../weights.png"; },
                   "weights[0].files[0]: expected a path inside the package"},
        Corruption{"no_maps", [](json& j) { j["maps"] = json::array(); }, "maps: expected an array of 1"},
        Corruption{"same_maps", [](json& j) { j["maps"][1]["name"] = "albedo"; },
                   "maps[1].name: expected unique map names"},
        Corruption{"map_name", [](json& j) { j["maps"][0]["name"] = "../albedo"; }, "maps[0].name"},
        Corruption{"width_text", [](json& j) { j["maps"][0]["width"] = "wide"; },
                   "maps[0].width: expected an integer from 1 to 65536, got \"wide\""},
        Corruption{"width_zero", [](json& j) { j["maps"][0]["width"] = 0; }, "maps[0].width"},
        Corruption{"huge_area",
                   [](json& j) {
                     j["maps"][0]["width"] = 2147483647;
                     j["maps"][0]["height"] = 2147483647;
                   },
                   "maps[0].width"},
        Corruption{"channels", [](json& j) { j["maps"][0]["channels"] = 5; }, "maps[0].channels"},
        Corruption{"sample_type", [](json& j) { j["maps"][1]["sample_type"] = "12-bit"; },
                   "maps[1].sample_type: expected \"8-bit\""},
        Corruption{"colour_space", [](json& j) { j["maps"][1]["colour_space"] = "ACES"; }, "maps[1].colour_space"},
        Corruption{"scale_zero", [](json& j) { j["maps"][0]["weight_scale"] = 0; }, "maps[0].weight_scale"},
        Corruption{"other_grid", [](json& j) { j["maps"][1]["weight_scale"] = 4; }, "maps[1]: expected"},
        Corruption{"metric", [](json& j) { j["maps"][0]["metric_weight"] = -1; }, "maps[0].metric_weight"},
        Corruption{"neutral", [](json& j) { j["maps"][0]["neutral"] = "n.png"; },
                   "maps[0].neutral: expected an object"},
        Corruption{"absolute", [](json& j) { j["maps"][0]["neutral"]["file"] = "/etc/x.png"; }, "maps[0].neutral.file"},
        Corruption{"climbing", [](json& j) { j["maps"][0]["neutral"]["file"] = "albedo/../../x.png"; },
                   "maps[0].neutral.file"},
        Corruption{"windows", [](json& j) { j["maps"][0]["neutral"]["file"] = "c:\\x.png"; }, "maps[0].neutral.file"},
        Corruption{"no_file", [](json& j) { j["maps"][0]["neutral"]["file"] = ""; }, "maps[0].neutral.file"},
        Corruption{"other_format", [](json& j) { j["maps"][0]["neutral"]["file"] = "albedo/neutral.tif"; },
                   "a .png file"},
        Corruption{"difference_count", [](json& j) { j["maps"][0]["differences"].erase(0); },
                   "maps[0].differences: expected an array of 4"},
        Corruption{"difference_scale", [](json& j) { j["maps"][0]["differences"][2]["scale"].push_back(1); },
                   "maps[0].differences[2].scale: expected an array of 3"},
        Corruption{"no_zero", [](json& j) { j["maps"][0]["differences"][2]["offset"][1] = -7.03; },
                   "maps[0].differences[2].offset: expected -scale times an integer from 0 to 255, so that zero has a "
                   "code, got offset -7.03 at scale "},
        Corruption{"nearly_zero",
                   [](json& j) {
                     json& offset = j["maps"][0]["differences"][2]["offset"][1];
                     offset = std::nextafter(offset.get<double>(), 0.0);
                   },
                   "maps[0].differences[2].offset: expected -scale times an integer"},
        Corruption{"zero_beyond_8_bits", [](json& j) { j["maps"][1]["difference_bits"] = 8; },
                   "maps[1].differences[0].offset: expected -scale times an integer from 0 to 255"},
        Corruption{"zero_beyond_16_bits",
                   [](json& j) {
                     j["maps"][1]["differences"][0]["scale"][0] = 0.5;
                     j["maps"][1]["differences"][0]["offset"][0] = -32768.0;
                   },
                   "maps[1].differences[0].offset: expected -scale times an integer from 0 to 65535"},
        Corruption{"bits", [](json& j) { j["maps"][0]["difference_bits"] = 12; },
                   "maps[0].difference_bits: expected 8 or 16, got 12"},
        Corruption{"bits_text", [](json& j) { j["maps"][0]["difference_bits"] = "8"; },
                   "maps[0].difference_bits: expected 8 or 16, got \"8\""},
        Corruption{"bits_real", [](json& j) { j["maps"][0]["difference_bits"] = 8.0; },
                   "maps[0].difference_bits: expected 8 or 16, got 8.0"},
        Corruption{"no_bits", [](json& j) { j["maps"][0].erase("difference_bits"); },
                   "maps[0].difference_bits: got no such field"},
        Corruption{"no_scale", [](json& j) { j["maps"][0]["differences"][2]["scale"][1] = 0; },
                   "maps[0].differences[2].offset"},
        Corruption{"method", [](json& j) { j["method"] = json::array(); }, "method: expected an object"}),
    [](const auto& corruption) { return std::string(corruption.param.name); });

TEST(PackageJson, HugeNumbersDeepNestingAndBadTextAreRefused) {
  const std::string file = "p/package.json";
  const auto message = [&](const std::string& text) -> std::string {
    try {
      package::parsePackageJson(text, file);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "expected an InputError";
    return "";
  };
  EXPECT_THAT(message(R"({"format":"facezip-package","version":2e999})"), HasSubstr(file));
  EXPECT_THAT(message(R"({"method":)" + std::string(100000, '[')), HasSubstr("nested"));
  EXPECT_THAT(message("{\"name\":\"\xff\"}"), HasSubstr("byte"));
  EXPECT_THAT(message("{\"version\":NaN}"), HasSubstr("byte"));
}

class CorruptImage : public testing::Test {
 protected:
  CorruptImage() {
    sample_ = makeSample({{"albedo", 40, 24, 3, SampleType::kUint8, 8},
                          {"detail", 80, 48, 1, SampleType::kUint16, 16, 0, 16},
                          {"height", 40, 24, 3, SampleType::kFloat32, 4, 1}},
                         5, 5);
    test::writeSample(sample_, folder_.path());
  }
  /// Runs `damage` on each image in turn, checks that opening names that image, and puts it back.
  void forEachImage(const std::function<void(const fs::path&)>& damage) {
    for (const std::string& name : test::imagesOf(sample_.description)) {
      const fs::path file = folder_ / name, kept = folder_ / "kept";
      fs::copy_file(file, kept);
      damage(file);
      EXPECT_THAT(messageOfOpening(folder_.path()), HasSubstr(file.string()));
      fs::remove_all(file);
      fs::rename(kept, file);
    }
    EXPECT_NO_THROW(Package::open(folder_.path()));
  }
  test::TemporaryDirectory folder_;
  SamplePackage sample_;
};

TEST_F(CorruptImage, MissingIsNamed) {
  forEachImage([](const fs::path& file) { fs::remove(file); });
}

TEST_F(CorruptImage, TruncatedIsNamed) {
  for (const double share : {0.0, 0.01, 0.1, 0.5, 0.9, 0.99}) {
    forEachImage([share](const fs::path& file) {
      fs::resize_file(file, static_cast<std::uintmax_t>(share * static_cast<double>(fs::file_size(file))));
    });
  }
  for (const std::uintmax_t cut : {1u, 4u, 11u, 12u, 13u}) {
    forEachImage([cut](const fs::path& file) { fs::resize_file(file, fs::file_size(file) - cut); });
  }
}

/// Codes of 8 bits cannot stand for those of 16: the image is checked against difference_bits.
TEST_F(CorruptImage, OfOtherBitsThanPackageJsonSaysIsNamed) {
  json document = json::parse(contentsOf(folder_ / "package.json"));
  document["maps"][0]["difference_bits"] = 16;
  io::writeTextFile(folder_ / "package.json", document.dump());
  EXPECT_THAT(messageOfOpening(folder_.path()),
              testing::AllOf(HasSubstr("albedo/difference_0.png: expected 40 x 24 texels, 3 channels, 16-bit"),
                             HasSubstr("got 40 x 24 texels, 3 channels, 8-bit")));
}

TEST_F(CorruptImage, OfAnotherSizeChannelCountOrTypeIsNamed) {
  const auto rewrite = [](const fs::path& file, const std::function<void(image::ImageShape&)>& change) {
    image::Image image = image::readImage(file);
    change(image.shape);
    image.samples.assign(static_cast<std::size_t>(image.shape.height) * image.shape.rowBytes(), std::byte{0});
    image::writeImage(file, image);
  };
  forEachImage([&](const fs::path& file) { rewrite(file, [](image::ImageShape& shape) { ++shape.width; }); });
  forEachImage([&](const fs::path& file) { rewrite(file, [](image::ImageShape& shape) { --shape.height; }); });
  forEachImage([&](const fs::path& file) {
    rewrite(file, [](image::ImageShape& shape) { shape.channels = shape.channels == 3 ? 4 : 3; });
  });
  forEachImage([&](const fs::path& file) {
    if (file.extension() == ".exr") return fs::resize_file(file, 0);  // an EXR holds no integers of 8 or 16 bits
    rewrite(file, [](image::ImageShape& shape) {
      shape.type = shape.type == image::SampleType::kUint8 ? image::SampleType::kUint16 : image::SampleType::kUint8;
    });
  });
}

TEST_F(CorruptImage, TextOrDirectoryInItsPlaceIsNamed) {
  forEachImage([](const fs::path& file) {
    io::writeTextFile(file, "not an image, but long enough to be looked into by any reader");
  });
  forEachImage([](const fs::path& file) { fs::remove(file), fs::create_directory(file); });
}

}  // namespace
}  // namespace facezip
