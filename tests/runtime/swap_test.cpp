// Packages that are replaced while they are read: a frame is one package's or the other's, never of both.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "facezip/blend.hpp"
#include "facezip/check.hpp"
#include "facezip/facezip_runtime.h"
#include "facezip/reconstruct.hpp"
#include "file_contents.hpp"
#include "host/sample_package.hpp"
#include "host/test_device.hpp"
#include "io/staged_directory.hpp"
#include "package/footprint.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using Frames = std::vector<std::vector<std::byte>>;

constexpr int kMaps = 6;
const std::vector<float> kWeights = {0.7f, 0.4f, 1.0f};

/// Frames of all maps.
Frames blendAll(const Package& package) {
  Blender blender(package, test::testDevice());
  blender.setWeights(kWeights);
  Frames frames;
  for (int m = 0; m < kMaps; ++m) {
    frames.emplace_back(package.maps()[static_cast<std::size_t>(m)].frameBytes());
    blender.blend(m, frames.back());
  }
  return frames;
}

Frames blendThroughC(const fs::path& directory) {
  facezip_package* package = nullptr;
  EXPECT_EQ(facezip_load(directory.c_str(), "pocl", &package), FACEZIP_OK) << facezip_last_error();
  if (package == nullptr) return {};
  EXPECT_EQ(facezip_set_weights(package, kWeights.data(), kWeights.size()), FACEZIP_OK);
  Frames frames;
  for (int m = 0; m < kMaps; ++m) {
    facezip_map_info info{};
    info.struct_size = sizeof(info);
    EXPECT_EQ(facezip_get_map_info(package, m, &info), FACEZIP_OK);
    frames.emplace_back(info.frame_bytes);
    EXPECT_EQ(facezip_blend(package, m, frames.back().data(), frames.back().size()), FACEZIP_OK);
  }
  facezip_free(package);
  return frames;
}

/// Two packages of one shape with nothing in common, and a third place where one replaces the other all the time.
class Swap : public testing::Test {
 protected:
  void SetUp() override {
    for (int p = 0; p < 2; ++p) {
      std::vector<test::SampleMap> maps;
      for (int m = 0; m < kMaps; ++m) maps.push_back({.name = "map_" + std::to_string(m), .width = 64, .height = 64});
      test::SamplePackage sample = test::makeSample(maps, 3, 4);
      for (auto& neutral : sample.neutrals) invert(neutral, p);
      for (auto& map : sample.differences) {
        for (auto& difference : map) invert(difference, p);
      }
      for (auto& set : sample.weights) invert(set, p);
      test::writeSample(sample, folder_ / std::to_string(p));
      expected_[p] = blendAll(Package::open(folder_ / std::to_string(p)));
    }
    replace(0);
  }

  static void invert(std::vector<std::byte>& bytes, int times) {
    if (times == 0) return;
    for (std::byte& b : bytes) b = ~b;
  }

  /// As `facezip compress` replaces a package.
  void replace(int by) const {
    io::StagedDirectory staged(place(), package::footprint());
    fs::copy(folder_ / std::to_string(by), staged.path(), fs::copy_options::recursive);
    staged.commit();
  }

  /// Calls `read` again and again while packages take turns, until both have happened often. How long that takes is the
  /// disk's matter: each turn waits for what is written.
  void whileSwapping(const std::function<void()>& read) const {
    std::atomic<bool> done = false;
    std::atomic<int> swaps = 0;
    std::thread writer([&] {  // one that fails ends the test: nothing catches it
      for (int turn = 1; !done; ++turn, ++swaps) replace(turn % 2);
    });
    try {
      for (int reads = 0; reads < 40 || swaps < 20; ++reads) read();
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
    done = true;
    writer.join();
  }

  void expectOneOfThem(const Frames& frames) const { EXPECT_TRUE(frames == expected_[0] || frames == expected_[1]); }

  fs::path place() const { return folder_ / "place"; }

  const test::TemporaryDirectory folder_;
  Frames expected_[2];
};

TEST_F(Swap, BlendersAreOfOnePackage) {
  whileSwapping([&] { expectOneOfThem(withPackage(place(), blendAll)); });
}

TEST_F(Swap, TheCInterfaceLoadsOnePackage) {
  whileSwapping([&] { expectOneOfThem(blendThroughC(place())); });
}

TEST_F(Swap, WhatIsOpenStaysWhatItIs) {
  whileSwapping([&] { expectOneOfThem(blendAll(Package::open(place()))); });
  replace(0);
  const Package package = Package::open(place());
  EXPECT_FALSE(package.wasReplaced());
  replace(1);
  replace(0);
  replace(1);
  EXPECT_TRUE(package.wasReplaced());
  EXPECT_EQ(blendAll(package), expected_[0]);
  EXPECT_EQ(blendAll(Package::open(place())), expected_[1]);
}

/// Files are copied over it, one by one.
TEST_F(Swap, AFileThatChangedInItsFolderIsRefused) {
  replace(0);
  const Package package = Package::open(place());
  const std::string file = package.maps()[2].neutral_file;
  fs::copy_file(folder_ / "1" / file, place() / "new");
  fs::rename(place() / "new", place() / file);
  EXPECT_EQ(blendAll(package), expected_[0]);
  replace(0);
  const Package again = Package::open(place());
  fs::copy_file(folder_ / "1" / file, place() / file, fs::copy_options::overwrite_existing);
  EXPECT_THROW(blendAll(again), InputError);
  EXPECT_NO_THROW(blendAll(Package::open(place())));
}

TEST_F(Swap, ChecksAndReconstructionsAreOfOnePackage) {
  int turn = 0;
  whileSwapping([&] {
    Progress progress;
    withPackage(place(), [&](const Package& package) { checkTexels(package, progress); });
    const fs::path out = folder_ / ("out_" + std::to_string(++turn));
    withPackage(place(), [&](const Package& package) {
      const std::vector<std::string> first = {package.expressions()[0]};
      reconstruct(package, out, first, test::testDevice(), progress);
    });
    EXPECT_EQ(test::filesOf(out).size(), static_cast<std::size_t>(kMaps));
    fs::remove_all(out);
  });
}

}  // namespace
}  // namespace facezip
