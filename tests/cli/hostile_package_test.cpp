// Packages of strangers: whatever they hold, no command reads or writes beyond their folder, or takes more memory than
// it was given.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "exit_codes.hpp"
#include "file_contents.hpp"
#include "io/staged_directory.hpp"
#include "package/package_writer.hpp"
#include "run_command.hpp"
#include "scene/glb.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using test::contentsOf;
using test::quoted;
using test::runFacezip;
using testing::AnyOf;
using testing::HasSubstr;

/// A good package, compressed once, and a copy of it to spoil.
class HostilePackage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new test::TemporaryDirectory;
    test::writeSmallCapture(*made_ / "capture", {.expressions = 4, .width = 48, .height = 48});
    const test::CommandResult result =
        runFacezip("compress " + quoted(*made_ / "capture") + " --output " + quoted(*made_ / "package") +
                   " --unit m --mask-radius 5cm --differences 2 --restarts 3");
    ASSERT_EQ(result.exit_code, 0) << result.error;
  }
  static void TearDownTestSuite() { delete made_; }
  void SetUp() override { fs::copy(*made_ / "package", package(), fs::copy_options::recursive); }

  fs::path package() const { return folder_ / "package"; }

  /// Every command that reads packages, each into a folder of its own.
  std::vector<std::string> commands() const {
    const std::string p = quoted(package()), out = quoted(folder_ / "out" / "x");
    return {"info " + p,
            "blend " + p + " --weights e00=1 --output " + quoted(folder_ / "out" / "x.png"),
            "reconstruct " + p + " --output " + out,
            "export " + p + " --target gltf --output " + out,
            "export " + p + " --target unity --output " + out,
            "export " + p + " --target godot --output " + out,
            "view " + p + " --output " + out,
            "convert " + p + " --texture-format bc7 --output " + out,
            "evaluate " + quoted(*made_ / "capture") + " " + p + " --baselines none --blends 0"};
  }

  /// Each command says what is wrong, and writes nothing.
  void expectRefused(const std::string& part, const std::vector<std::string>& by) const {
    const auto before = test::filesOf(folder_.path());
    for (const std::string& command : by) {
      const test::CommandResult result = runFacezip(command);
      EXPECT_EQ(result.exit_code, cli::kExitInput) << command << "\n" << result.error;
      EXPECT_THAT(result.error, HasSubstr(part)) << command;
      EXPECT_LT(result.error.size(), 2000u);
      fs::remove_all(folder_ / "out");
      EXPECT_EQ(test::filesOf(folder_.path()), before) << command;
    }
  }

  /// Takes mesh.glb apart, changes it and puts it together again.
  template <typename Change>
  void changeMesh(const Change& change) const {
    const std::string file = contentsOf(package() / "mesh.glb");
    const scene::GlbParts parts = scene::splitGlb(std::as_bytes(std::span(file)), "mesh.glb");
    json document = json::parse(parts.json);
    change(document);
    io::writeTextFile(package() / "mesh.glb", scene::joinGlb(document.dump(), parts.binary));
  }

  const test::TemporaryDirectory folder_;
  static test::TemporaryDirectory* made_;
};
test::TemporaryDirectory* HostilePackage::made_ = nullptr;

const std::vector<std::string> kOfMeshes = {"info", "export", "view", "convert"};

std::vector<std::string> thoseOf(const std::vector<std::string>& commands, const std::vector<std::string>& names) {
  std::vector<std::string> chosen;
  for (const std::string& command : commands) {
    for (const std::string& name : names) {
      if (command.starts_with(name + " ")) chosen.push_back(command);
    }
  }
  return chosen;
}

TEST_F(HostilePackage, TheGoodOneIsTaken) {
  for (const std::string& command : commands()) {
    const test::CommandResult result = runFacezip(command);
    EXPECT_EQ(result.exit_code, 0) << command << "\n" << result.error;
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(HostilePackage, MeshesReferToNothing) {
  io::writeTextFile(folder_ / "secret.bin", std::string(1 << 20, 's'));
  io::writeTextFile(package() / "inside.bin", std::string(1 << 20, 'i'));
  for (const char* uri : {"../evil.sh", "../secret.bin", "inside.bin", "/etc/passwd", "file:///etc/passwd",
                          "%2e%2e/secret.bin", "data:application/octet-stream;base64,AAAA"}) {
    changeMesh([&](json& mesh) { mesh["buffers"][0]["uri"] = uri; });
    expectRefused("buffers[0].uri", thoseOf(commands(), kOfMeshes));
    changeMesh([&](json& mesh) {
      mesh["buffers"][0].erase("uri");
      mesh["images"] = json::array({{{"uri", uri}}});
    });
    expectRefused("images", thoseOf(commands(), kOfMeshes));
    changeMesh([&](json& mesh) { mesh.erase("images"); });
  }
}

TEST_F(HostilePackage, MeshesAreCheckedWhole) {
  changeMesh([](json& mesh) { mesh.erase("buffers"); });
  expectRefused("buffers", thoseOf(commands(), kOfMeshes));
  std::string deep;
  for (int i = 0; i < 200000; ++i) deep += "[";
  io::writeTextFile(package() / "mesh.glb", scene::joinGlb(deep, {}));
  expectRefused("nested levels", thoseOf(commands(), kOfMeshes));
  // The server of the page checks it, too, before it serves.
  EXPECT_EQ(runFacezip("view " + quoted(package()) + " --port 0", "timeout 20").exit_code, cli::kExitInput);
}

/// A link in a package may lead to any file that the user can read.
TEST_F(HostilePackage, LinksAreNotFollowed) {
  const json description = json::parse(contentsOf(package() / "package.json"));
  const std::string map = description["maps"][0]["name"];
  for (const std::string& name : {std::string("package.json"), std::string("weights.png"), std::string("mesh.glb"),
                                  std::string("masks.png"), map + "/neutral.png", map + "/difference_1.png"}) {
    fs::rename(package() / name, folder_ / "elsewhere");
    fs::create_symlink(folder_ / "elsewhere", package() / name);
    expectRefused("a link", commands());
    fs::remove(package() / name);
    fs::rename(folder_ / "elsewhere", package() / name);
  }
  fs::rename(package() / map, folder_ / "elsewhere");
  fs::create_directory_symlink(folder_ / "elsewhere", package() / map);
  expectRefused("a link", commands());
  // The package itself may be named by one.
  fs::remove(package() / map);
  fs::rename(folder_ / "elsewhere", package() / map);
  fs::create_directory_symlink(package(), folder_ / "link");
  EXPECT_EQ(runFacezip("info " + quoted(folder_ / "link")).exit_code, 0);
}

std::string pngChunk(const std::string& type, const std::string& data) {
  const auto word = [](std::uint32_t value) {
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xff);
    return text;
  };
  const std::string named = type + data;
  const auto crc = ::crc32(0, reinterpret_cast<const Bytef*>(named.data()), static_cast<uInt>(named.size()));
  return word(static_cast<std::uint32_t>(data.size())) + named + word(static_cast<std::uint32_t>(crc));
}

std::string deflated(const std::string& data) {
  uLongf size = ::compressBound(static_cast<uLong>(data.size()));
  std::string out(size, '\0');
  EXPECT_EQ(::compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(data.data()),
                       static_cast<uLong>(data.size())),
            Z_OK);
  out.resize(size);
  return out;
}

/// A PNG file of 48 x 48 texels from its parts.
std::string png(char bits, char colour_type, char interlaced, const std::string& before, std::size_t row_bytes) {
  std::string rows;
  for (int y = 0; y < 48; ++y) rows += std::string(1 + row_bytes, '\0');
  const std::string size("\0\0\0\x30\0\0\0\x30", 8);
  const std::string header = size + bits + colour_type + '\0' + '\0' + interlaced;
  return std::string("\x89PNG\r\n\x1a\n") + pngChunk("IHDR", header) + before + pngChunk("IDAT", deflated(rows)) +
         pngChunk("IEND", "");
}

/// OpenImageIO would read these, by readers that were made for files of friends.
TEST_F(HostilePackage, ImagesAreOfTheFormatThatTheirNamesSay) {
  const json description = json::parse(contentsOf(package() / "package.json"));
  const fs::path neutral = package() / description["maps"][0]["neutral"]["file"].get<std::string>();
  const image::Image whole = image::readImage(neutral);
  const std::string png_end = contentsOf(neutral).substr(fs::file_size(neutral) - 12);
  for (const char* extension : {".tif", ".bmp", ".tga", ".jpg"}) {
    const fs::path other = folder_ / ("other" + std::string(extension));
    image::writeImage(other, whole);
    io::writeTextFile(neutral, contentsOf(other) + png_end);
    fs::remove(other);
    expectRefused("expected a PNG file", commands());
  }
  EXPECT_EQ(whole.shape.channels, 3);
  const std::map<std::string, std::string> odd = {
      {"palette", png(8, 3, 0, pngChunk("PLTE", "abcdef"), 48)},
      {"interlaced", png(8, 2, 1, "", 144)},
      {"transparent colour", png(8, 2, 0, pngChunk("tRNS", std::string(6, '\0')), 144)},
      {"1 bit", png(1, 0, 0, "", 6)}};
  for (const auto& [what, file] : odd) {
    io::writeTextFile(neutral, file);
    SCOPED_TRACE(what);
    expectRefused("expected a PNG file", thoseOf(commands(), {"info", "blend", "export"}));
  }
  io::writeTextFile(neutral, png(8, 2, 0, "", 144));
  EXPECT_EQ(runFacezip("info " + quoted(package())).exit_code, 0);
}

struct Measured {
  int exit_code = -1;
  std::uint64_t peak_bytes = 0;
};

/// Runs the command and says how much it kept resident at most.
Measured measure(const std::string& arguments) {
  const std::string command =
      "exec " + quoted(FACEZIP_COMMAND) + " --quiet " + arguments + " >/dev/null 2>&1 </dev/null";
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  int status = 0;
  struct rusage usage {};
  EXPECT_EQ(::wait4(child, &status, 0, &usage), child);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), static_cast<std::uint64_t>(usage.ru_maxrss)
                                                                           << 10};
}

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

/// A package of black texels, which take hardly any room on disk.
void writeLargePackage(const fs::path& directory, int width, int height) {
  PackageDescription description;
  description.name = "large";
  description.expressions = {"e00"};
  description.differences = 1;
  description.weights.resize(1);
  description.weights[0].scale = {1.0};
  description.weights[0].offset = {0.0};
  PackageMap map;
  map.name = "albedo";
  map.width = width;
  map.height = height;
  map.channels = 1;
  map.weight_scale = 64;
  map.differences = {{"", {1.0}, {-128.0}}};
  description.maps = {map};
  fs::create_directories(directory);
  package::PackageWriter writer(description, directory);
  const std::vector<std::byte> rows(static_cast<std::size_t>(width) * 64);
  for (int begin = 0; begin < height; begin += 64) {
    writer.writeNeutralRows(0, rows, 64);
    writer.writeDifferenceRows(0, 0, rows, 64);
  }
  const PackageWeights& weights = writer.description().weights[0];
  writer.writeWeights(0, std::vector<std::byte>(static_cast<std::size_t>(weights.tile_width * weights.tile_height)));
  writer.finish();
}

/// 8192 x 16384 texels in a few hundred kilobytes: 128 MiB for each of two textures and a frame.
TEST_F(HostilePackage, LargeTexturesPassWithinTheMemoryThatWasGiven) {
  if (FACEZIP_SANITIZED) GTEST_SKIP() << "sanitized programs take several times the memory";
  writeLargePackage(folder_ / "large", 8192, 16384);
  const std::string p = quoted(folder_ / "large");
  EXPECT_LT(fs::file_size(folder_ / "large/albedo/neutral.png"), 4 * kMiB);
  for (const std::string& command :
       {"info " + p, "blend " + p + " --weights e00=1 --output " + quoted(folder_ / "frame.png"),
        "reconstruct " + p + " --output " + quoted(folder_ / "decoded")}) {
    const Measured result = measure(command + " --memory 320MiB");
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_LT(result.peak_bytes, 320 * kMiB) << command;
  }
  EXPECT_EQ(contentsOf(folder_ / "frame.png"), contentsOf(folder_ / "decoded/albedo/e00.png"));
  // With memory to spare the whole package lies on the device: the same frame.
  const Measured whole =
      measure("blend " + p + " --weights e00=1 --output " + quoted(folder_ / "whole.png") + " --memory 4GiB");
  EXPECT_EQ(whole.exit_code, 0);
  EXPECT_GT(whole.peak_bytes, 450 * kMiB) << "the bound above is not by chance";
  EXPECT_EQ(contentsOf(folder_ / "frame.png"), contentsOf(folder_ / "whole.png"));
}

TEST_F(HostilePackage, WhatCannotBeDoneWithinTheMemoryIsRefused) {
  for (const std::string& command : thoseOf(commands(), {"blend", "reconstruct", "info", "export"})) {
    const test::CommandResult result = runFacezip(command + " --memory 1MiB");
    EXPECT_EQ(result.exit_code, cli::kExitInput) << command;
    EXPECT_THAT(result.error, HasSubstr("--memory: expected at least")) << command;
    EXPECT_EQ(runFacezip(command + " --memory much").exit_code, cli::kExitInput) << command;
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(HostilePackage, RigsTakeNoMoreThanTheirWeights) {
  json rig = {{"format", "facezip-rig"},        {"version", 1},
              {"millimetres_per_unit", 1000.0}, {"skin_vertices", 441},
              {"shapes", json::array()},        {"expressions", json::array()}};
  for (int i = 0; i < 16000; ++i) {
    const std::string name = std::to_string(i);
    rig["shapes"].push_back(name);
    rig["expressions"].push_back({{"name", name}, {"captured", name}, {"weights", json::object()}});
  }
  io::writeTextFile(package() / "rig.json", rig.dump());
  EXPECT_LT(fs::file_size(package() / "rig.json"), 2 * kMiB);
  const Measured result = measure("solve-weights " + quoted(package()) + " " + quoted(*made_ / "capture/neutral.obj") +
                                  " --output " + quoted(folder_ / "clip.csv"));
  EXPECT_EQ(result.exit_code, cli::kExitInput);
  if (FACEZIP_SANITIZED == 0) {
    EXPECT_LT(result.peak_bytes, 300 * kMiB);
  }
}

/// Texts beside the samples of a PNG: a kilobyte unpacks to a megabyte, a megabyte to a gigabyte.
TEST_F(HostilePackage, TextsOfImagesAreNotUnpackedWithoutBounds) {
  const json description = json::parse(contentsOf(package() / "package.json"));
  const fs::path neutral = package() / description["maps"][0]["neutral"]["file"].get<std::string>();
  std::string bomb("note\0\0", 6);
  {
    // 1 GiB of zeros, in parts.
    z_stream stream{};
    ASSERT_EQ(::deflateInit(&stream, 9), Z_OK);
    std::string zeros(std::size_t{16} << 20, '\0'), out(std::size_t{4} << 20, '\0');
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    for (int i = 0; i < 64; ++i) {
      stream.next_in = reinterpret_cast<Bytef*>(zeros.data());
      stream.avail_in = static_cast<uInt>(zeros.size());
      ::deflate(&stream, i == 63 ? Z_FINISH : Z_NO_FLUSH);
    }
    bomb += out.substr(0, stream.total_out);
    ::deflateEnd(&stream);
  }
  io::writeTextFile(neutral, png(8, 2, 0, pngChunk("zTXt", bomb), 144));
  EXPECT_LT(fs::file_size(neutral), 2 * kMiB);
  const Measured result = measure("info " + quoted(package()));
  EXPECT_EQ(result.exit_code, cli::kExitInput);
  if (FACEZIP_SANITIZED == 0) {
    EXPECT_LT(result.peak_bytes, 300 * kMiB);
  }
}

}  // namespace
}  // namespace facezip
