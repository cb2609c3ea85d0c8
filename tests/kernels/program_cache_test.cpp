#include "device/program_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "file_contents.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using device::DeviceContext;
using device::ProgramCache;
using test::contentsOf;

const std::vector<unsigned char> kBinary = {1, 2, 3, 0, 255};

void overwrite(const fs::path& file, const std::string& contents) { std::ofstream(file, std::ios::binary) << contents; }

std::vector<fs::path> filesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

TEST(ProgramCache, GivesBackWhatItKeeps) {
  const test::TemporaryDirectory folder;
  const ProgramCache cache(folder / "deep" / "cache");
  EXPECT_FALSE(cache.find("key"));
  cache.store("key", kBinary);
  EXPECT_EQ(cache.find("key"), kBinary);
  EXPECT_FALSE(cache.find("another key"));
  cache.store("key", {9});
  EXPECT_EQ(cache.find("key"), std::vector<unsigned char>{9});
  EXPECT_EQ(filesIn(folder / "deep" / "cache").size(), 1u);
}

TEST(ProgramCache, TellsKeysOfOneFileApart) {
  const test::TemporaryDirectory folder;
  const ProgramCache cache(folder.path());
  cache.store("key", kBinary);
  fs::rename(cache.fileOf("key"), cache.fileOf("kez"));  // as if their hashes were equal
  EXPECT_FALSE(cache.find("kez"));
}

TEST(ProgramCache, IgnoresDamagedFiles) {
  const test::TemporaryDirectory folder;
  const ProgramCache cache(folder.path());
  cache.store("key", kBinary);
  const std::string whole = contentsOf(cache.fileOf("key"));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    overwrite(cache.fileOf("key"), whole.substr(0, length));
    EXPECT_FALSE(cache.find("key")) << length;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x40);
    overwrite(cache.fileOf("key"), flipped);
    EXPECT_FALSE(cache.find("key")) << at;
  }
  overwrite(cache.fileOf("key"), whole + "x");
  EXPECT_FALSE(cache.find("key"));
  overwrite(cache.fileOf("key"), whole);
  EXPECT_TRUE(cache.find("key"));
}

TEST(ProgramCache, WithoutAFolderItHoldsNothing) {
  const test::TemporaryDirectory folder;
  overwrite(folder / "file", "in the way");
  for (const fs::path& path : {fs::path(), folder / "file", folder / "file" / "below", fs::path("/proc/facezip")}) {
    const ProgramCache cache(path);
    cache.store("key", kBinary);
    EXPECT_FALSE(cache.find("key")) << path;
  }
  EXPECT_EQ(filesIn(folder.path()).size(), 1u);
}

TEST(ProgramCache, WritersAtOnceLeaveOneWholeFile) {
  const test::TemporaryDirectory folder;
  const ProgramCache cache(folder.path());
  const std::vector<unsigned char> large(100000, 7);
  std::vector<std::thread> writers;
  std::atomic<int> wrong = 0;
  for (int t = 0; t < 4; ++t) {
    writers.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        cache.store("key", large);
        if (cache.find("key") != large) ++wrong;
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(filesIn(folder.path()).size(), 1u);
}

/// Sets an environment variable while it lives.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    value != nullptr ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Environment() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(ProgramCache, LiesWhereTheUserWants) {
  const Environment home("HOME", "/home/actor");
  const Environment xdg("XDG_CACHE_HOME", nullptr);
  const auto folder = [] { return ProgramCache::ofUser().fileOf("key").parent_path(); };
  {
    const Environment none("FACEZIP_CACHE_DIR", nullptr);
    EXPECT_EQ(folder(), "/home/actor/.cache/facezip");
    const Environment relative("XDG_CACHE_HOME", "cache");
    EXPECT_EQ(folder(), "/home/actor/.cache/facezip");
    const Environment absolute("XDG_CACHE_HOME", "/cache");
    EXPECT_EQ(folder(), "/cache/facezip");
  }
  const Environment ours("FACEZIP_CACHE_DIR", "/elsewhere");
  EXPECT_EQ(folder(), "/elsewhere");
  const Environment off("FACEZIP_CACHE_DIR", "");
  EXPECT_EQ(folder(), "");
}

/// Counts what is compiled.
struct CompileCount : Progress {
  void busy(std::string_view) override { ++count; }
  int count = 0;
};

/// Asks a fresh context, as a new process has, for a kernel; returns how many programs it compiled.
int compiledBy(const ProgramCache& cache) {
  CompileCount progress;
  DeviceContext& shared = test::testDevice();
  DeviceContext context(shared.device(), shared.info(), &progress, cache);
  const cl::Kernel kernel = context.kernel("weight_blend.cl", "weight_blend", "-D LANES=1 -D DIFFERENCES=2");
  EXPECT_EQ(kernel.getInfo<CL_KERNEL_NUM_ARGS>(), 10u);
  return progress.count;
}

TEST(KernelBinaries, AreCompiledOnceAndAgainWhenTheyAreDamagedOrRefused) {
  const test::TemporaryDirectory folder;
  const ProgramCache cache(folder.path());
  EXPECT_EQ(compiledBy(cache), 1);
  if (filesIn(folder.path()).empty()) GTEST_SKIP() << "the driver gives no binaries";
  ASSERT_EQ(filesIn(folder.path()).size(), 1u);
  const fs::path file = filesIn(folder.path()).front();
  EXPECT_EQ(compiledBy(cache), 0);

  const std::string whole = contentsOf(file);
  overwrite(file, whole.substr(0, whole.size() / 2));
  EXPECT_EQ(compiledBy(cache), 1);
  EXPECT_EQ(contentsOf(file).size(), whole.size());  // kept again

  // Mesa 22 ends the process over such a binary; the checksum and the driver's version in the key keep it from one.
  if (test::testDevice().info().platform == "rusticl") return;
  // A whole file whose binary no driver takes: the key stands between header and binary.
  const std::size_t source = whole.find("kernel void weight_blend");
  ASSERT_NE(source, std::string::npos);
  const std::size_t key_begin = 16 + 3 * sizeof(std::uint64_t);
  std::uint64_t key_bytes = 0;
  std::memcpy(&key_bytes, whole.data() + 16, sizeof(key_bytes));
  cache.store(whole.substr(key_begin, key_bytes), kBinary);
  EXPECT_EQ(compiledBy(cache), 1);
  EXPECT_EQ(compiledBy(cache), 0);

  EXPECT_EQ(compiledBy(ProgramCache({})), 1);
}

}  // namespace
}  // namespace facezip
