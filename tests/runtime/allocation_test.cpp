// Frames stream without allocation: no OpenCL buffer but views of the caller's memory, and after the first frame, in
// which libraries set themselves up, no operator new. Both are counted for the whole process, libraries included.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "device/device_context.hpp"
#include "facezip/blend.hpp"
#include "host/sample_package.hpp"
#include "host/test_device.hpp"
#include "temporary_directory.hpp"

namespace {

std::atomic<long> g_news = 0;
std::atomic<long> g_buffers = 0;

void* allocate(std::size_t bytes, const std::nothrow_t& /*unused*/) noexcept {
  ++g_news;
  return std::malloc(bytes == 0 ? 1 : bytes);
}

void* allocate(std::size_t bytes) {
  if (void* memory = allocate(bytes, std::nothrow)) return memory;
  throw std::bad_alloc();
}

void* allocate(std::size_t bytes, std::align_val_t alignment) {
  ++g_news;
  const auto step = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(step, (bytes + step - 1) / step * step)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes); }
void* operator new[](std::size_t bytes) { return allocate(bytes); }
void* operator new(std::size_t bytes, const std::nothrow_t& none) noexcept { return allocate(bytes, none); }
void* operator new[](std::size_t bytes, const std::nothrow_t& none) noexcept { return allocate(bytes, none); }
void* operator new(std::size_t bytes, std::align_val_t alignment) { return allocate(bytes, alignment); }
void* operator new[](std::size_t bytes, std::align_val_t alignment) { return allocate(bytes, alignment); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

/// In front of the loader's own.
extern "C" cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, std::size_t bytes, void* host, cl_int* error) {
  if ((flags & CL_MEM_USE_HOST_PTR) == 0) ++g_buffers;
  static const auto create = reinterpret_cast<decltype(&clCreateBuffer)>(::dlsym(RTLD_NEXT, "clCreateBuffer"));
  return create(context, flags, bytes, host, error);
}

namespace facezip {
namespace {

/// Counts allocations while frames are blended into `out`.
void expectNoAllocation(Blender& blender, const Package& package, std::span<std::byte> out) {
  std::vector<float> beta(package.expressions().size(), 0.0f);
  const auto blendFrame = [&](int f) {
    for (std::size_t n = 0; n < beta.size(); ++n) beta[n] = static_cast<float>((n + static_cast<std::size_t>(f)) % 3);
    blender.setWeights(beta);
    blender.blend(0, out);
  };
  const long buffers = g_buffers;
  blendFrame(0);
  const long news = g_news;
  for (int f = 1; f <= 20; ++f) blendFrame(f);
  EXPECT_EQ(g_news - news, 0);
  EXPECT_EQ(g_buffers - buffers, 0);
}

class Frames : public testing::TestWithParam<test::SampleMap> {};

TEST_P(Frames, AreBlendedWithoutAllocation) {
  const test::TemporaryDirectory folder;
  test::SamplePackage sample = test::makeSample({GetParam()});
  test::writeSample(sample, folder / "package");
  const Package package = Package::open(folder / "package");
  Blender blender(package, test::testDevice());
  ASSERT_GT(g_buffers, 0);  // what counts them is in place
  std::vector<std::byte> memory(package.maps()[0].frameBytes() + 64);
  // At 64 bytes the kernel may write into it; one byte further the frame is copied out.
  const std::size_t offset = (64 - reinterpret_cast<std::uintptr_t>(memory.data()) % 64) % 64;
  expectNoAllocation(blender, package, std::span(memory).subspan(offset, package.maps()[0].frameBytes()));
  expectNoAllocation(blender, package,
                     std::span(memory).subspan(offset == 0 ? 1 : offset - 1, package.maps()[0].frameBytes()));
}

INSTANTIATE_TEST_SUITE_P(Maps, Frames,
                         testing::Values(test::SampleMap{.width = 64, .height = 32},
                                         test::SampleMap{.width = 61, .height = 27},
                                         test::SampleMap{.type = SampleType::kFloat32}));

}  // namespace
}  // namespace facezip
