#include "image/sample_bands.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <future>

namespace facezip::image {

namespace {

std::string describe(const ImageShape& shape) {
  return fmt::format("{} x {}, {} channel{}, {}", shape.width, shape.height, shape.channels,
                     shape.channels == 1 ? "" : "s", sampleTypeName(shape.type));
}

void requireLikeNeutral(const ImageReader& texture, const ImageReader& neutral, const std::string& name) {
  const ImageShape& got = texture.shape();
  const ImageShape& expected = neutral.shape();
  if (got == expected) return;
  std::string cure = "export both alike";
  if (got.width != expected.width || got.height != expected.height) cure = "resize one of them";
  throw InputError({texture.path().string(), fmt::format("expression \"{}\"", name),
                    fmt::format("{} as {} has", describe(expected), neutral.path().filename().string()), describe(got),
                    cure});
}

}  // namespace

SampleBands::SampleBands(const CaptureMap& map, const std::vector<std::string>& names)
    : map_name_(map.name), expressions_(static_cast<int>(names.size())) {
  assert(names.size() == map.expressions.size());
  readers_.emplace_back(map.neutral);
  shape_ = readers_.front().shape();
  sample_type_ = shape_.type;
  if (shape_.channels < 1 || shape_.channels > 4) {
    throw InputError(
        {map.neutral.string(), "", "1 to 4 channels", fmt::format("{} channels", shape_.channels), "split the image"});
  }
  for (std::size_t n = 0; n < names.size(); ++n) {
    readers_.emplace_back(map.expressions[n]);
    requireLikeNeutral(readers_.back(), readers_.front(), names[n]);
  }
}

SampleBands::SampleBands(const ImageShape& shape, SampleType sample_type, int expressions,
                         std::unique_ptr<SampleSource> source)
    : shape_(shape), sample_type_(sample_type), expressions_(expressions), source_(std::move(source)) {}

std::string SampleBands::mixedColours() const {
  if (source_) return "";
  const std::string expected = readers_.front().colours();
  const auto said = [](const std::string& colours) { return colours.empty() ? "nothing" : colours; };
  std::string first;
  int others = 0;
  for (const ImageReader& reader : readers_) {
    const std::string colours = reader.colours();
    if (colours == expected) continue;
    if (others++ == 0) first = fmt::format("{} says {}", reader.path().filename().string(), said(colours));
  }
  if (others == 0) return "";
  if (others > 1) first += fmt::format(", {} more are no {} either", others - 1, said(expected));
  return fmt::format("map \"{}\": of its colours {} says {}, {}: samples are taken as they are, without conversion",
                     map_name_, readers_.front().path().filename().string(), said(expected), first);
}

std::size_t SampleBands::rowBytes() const {
  return ImageShape{shape_.width, 1, shape_.channels, sample_type_}.rowBytes();
}

std::size_t SampleBands::bandBytes(int rows) const {
  return (static_cast<std::size_t>(expressions_) + 1) * static_cast<std::size_t>(rows) * rowBytes();
}

std::size_t SampleBands::decodedBytes() const { return bandBytes(shape_.height); }

std::size_t SampleBands::scratchOffset(std::size_t image, int row) const {
  return (image * static_cast<std::size_t>(shape_.height) + static_cast<std::size_t>(row)) * rowBytes();
}

template <typename Keep>
void SampleBands::decodeRows(int begin, int end, std::span<std::byte> out, const Keep& keep) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t image_bytes = static_cast<std::size_t>(end - begin) * rowBytes();
  tbb::parallel_for(std::size_t{0}, readers_.size(), [&](std::size_t i) {
    const std::span<std::byte> rows = out.subspan(i * image_bytes, image_bytes);
    readers_[i].readRows(begin, end, rows);
    keep(i, rows);
  });
  decode_seconds_ = decode_seconds_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void SampleBands::decode(const std::stop_token& stop) noexcept {
  assert(scratch_ && decoded_rows_ == 0);
  constexpr int kRowsAtOnce = 64;
  try {
    std::vector<std::byte> buffer(bandBytes(std::min(kRowsAtOnce, shape_.height)));
    for (int begin = 0; begin < shape_.height && !stop.stop_requested(); begin += kRowsAtOnce) {
      const int end = std::min(begin + kRowsAtOnce, shape_.height);
      decodeRows(
          begin, end, std::span(buffer).first(bandBytes(end - begin)),
          [&](std::size_t i, std::span<const std::byte> rows) { scratch_->write(scratchOffset(i, begin), rows); });
      const std::lock_guard lock(mutex_);
      decoded_rows_ = end;
      decoded_.notify_all();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    decoded_.notify_all();
  }
}

void SampleBands::waitForRows(int end) {
  std::unique_lock lock(mutex_);
  decoded_.wait(lock, [&] { return decoded_rows_ >= end || failure_; });
  if (decoded_rows_ < end) std::rethrow_exception(failure_);
}

void SampleBands::readRows(int begin, int end, std::span<std::byte> out) {
  assert(out.size() == bandBytes(end - begin));
  if (source_) return source_->readRows(begin, end, out);
  if (!scratch_) return decodeRows(begin, end, out, [](std::size_t, std::span<const std::byte>) {});
  waitForRows(end);
  const std::size_t image_bytes = static_cast<std::size_t>(end - begin) * rowBytes();
  tbb::parallel_for(std::size_t{0}, readers_.size(), [&](std::size_t i) {
    scratch_->read(scratchOffset(i, begin), out.subspan(i * image_bytes, image_bytes));
  });
}

void SampleBands::forEachBand(int band_rows, Progress& progress, const std::function<void(const SampleBand&)>& visit,
                              const std::function<void(int begin, int end)>& prepare) {
  const auto load = [this, band_rows, &prepare](int begin, std::vector<std::byte>& buffer) {
    const int end = std::min(begin + band_rows, shape_.height);
    if (prepare) prepare(begin, end);
    buffer.resize(bandBytes(end - begin));
    readRows(begin, end, buffer);
  };
  std::future<void> next = std::async(std::launch::async, load, 0, std::ref(buffers_[0]));
  int current = 0;
  for (int begin = 0; begin < shape_.height; begin += band_rows) {
    const auto start = std::chrono::steady_clock::now();
    next.get();
    wait_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    progress.checkCancelled();
    const int end = std::min(begin + band_rows, shape_.height);
    if (end < shape_.height) next = std::async(std::launch::async, load, end, std::ref(buffers_[1 - current]));
    visit({begin, end, buffers_[current]});
    current = 1 - current;
  }
  for (std::vector<std::byte>& buffer : buffers_) std::vector<std::byte>().swap(buffer);
}

}  // namespace facezip::image
