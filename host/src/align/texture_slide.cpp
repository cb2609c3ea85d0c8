#include "align/texture_slide.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "facezip/error.hpp"
#include "flow/flow_sampling.hpp"
#include "image/averaged_image.hpp"
#include "image/set_sample.hpp"
#include "io/counts.hpp"
#include "register/resample.hpp"

namespace facezip::align {
namespace {

constexpr int kMostSide = 2048;  // finer textures are averaged: flow is found to a small part of a texel
constexpr int kLeastSide = 32;
constexpr int kMostRounds = 3;
constexpr double kStill = 0.5;  // texels, that 95 % do not pass

image::ImageShape shapeOf(const std::filesystem::path& file) { return image::ImageReader(file).shape(); }

int factorOf(const image::ImageShape& shape) { return divideUp(std::max(shape.width, shape.height), kMostSide); }

struct Length {
  double mean = 0.0, p95 = 0.0, trusted = 0.0;
};

Length lengthOf(const flow::TextureFlow& flow, const std::vector<std::uint8_t>& region) {
  std::vector<double> lengths;
  std::size_t count = 0;
  for (int y = 0; y < flow.height; ++y) {
    for (int x = 0; x < flow.width; ++x) {
      const std::size_t at = toSize(y) * toSize(flow.width) + toSize(x);
      if (region[at] == 0) continue;
      ++count;
      if (flow::trustOf(flow, x, y) < 0.5) continue;
      lengths.push_back(double{std::hypot(flow.forward[2 * at], flow.forward[2 * at + 1])});
    }
  }
  Length length;
  if (lengths.empty()) return length;
  for (const double l : lengths) length.mean += l / static_cast<double>(lengths.size());
  const auto rank = lengths.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(lengths.size() - 1));
  std::nth_element(lengths.begin(), rank, lengths.end());
  length.p95 = *rank;
  length.trusted = static_cast<double>(lengths.size()) / static_cast<double>(count);
  return length;
}

double largestOf(const SlideField& field, const std::vector<std::uint8_t>& region) {
  double largest = 0.0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] == 0) continue;
    largest = std::max(largest, double{std::hypot(field.vectors[2 * i], field.vectors[2 * i + 1])});
  }
  return largest;
}

}  // namespace

std::span<const float> TextureSlide::Grey::values() const {
  return {reinterpret_cast<const float*>(image.samples.data()), image.samples.size() / sizeof(float)};
}

TextureSlide::TextureSlide(const geometry::TriangleMesh& mesh, std::span<const int> region,
                           const std::filesystem::path& neutral, device::DeviceContext& context, Progress& progress)
    : factor_(factorOf(shapeOf(neutral))), context_(context), progress_(progress) {
  neutral_ = readGrey(neutral);
  shape_ = neutral_.image.shape;
  if (std::min(shape_.width, shape_.height) < kLeastSide) {
    throw InputError({neutral.string(), "", fmt::format("at least {} texels a side", kLeastSide),
                      fmt::format("{} x {}", shape_.width, shape_.height), ""});
  }
  texels_ = texelsOf(mesh, region, shape_.width, shape_.height);
}

TextureSlide::Grey TextureSlide::readGrey(const std::filesystem::path& file) const {
  const image::Image colours = image::readAveraged(file, factor_);
  Grey grey{{{colours.shape.width, colours.shape.height, 1, image::SampleType::kFloat32}, {}}};
  const auto channels = toSize(colours.shape.channels);
  const std::size_t texels = toSize(colours.shape.width, colours.shape.height);
  grey.image.samples.resize(texels * sizeof(float));
  for (std::size_t i = 0; i < texels; ++i) {
    float sample[3] = {};
    for (std::size_t c = 0; c < channels; ++c) sample[c] = image::sampleAt(colours, i * channels + c);
    image::setSample(grey.image, i, flow::greyOf(sample, colours.shape.channels));
  }
  return grey;
}

/// Mean absolute difference from the neutral over the region, both means taken out.
double TextureSlide::differenceFrom(std::span<const float> grey) const {
  const std::span<const float> neutral = neutral_.values();
  double mean = 0.0, count = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    if (texels_.region[i] == 0) continue;
    mean += double{grey[i]} - double{neutral[i]};
    count += 1.0;
  }
  for (std::size_t i = 0; i < grey.size(); ++i) {
    if (texels_.region[i] != 0) sum += std::abs(double{grey[i]} - double{neutral[i]} - mean / count);
  }
  return sum / count;
}

Slide TextureSlide::slideOf(const std::string& name, const std::filesystem::path& texture) const {
  const Grey grey = readGrey(texture);
  if (grey.image.shape != shape_) {
    throw InputError(
        {texture.string(), "",
         fmt::format("the size of the neutral's texture, {} x {}", factor_ * shape_.width, factor_ * shape_.height),
         "another one", ""});
  }
  registration::TextureSampler sampler(context_, grey.image);
  Slide slide{stillField(shape_.width, shape_.height), {}};
  slide.found.name = name;
  std::vector<float> slid(grey.values().begin(), grey.values().end());
  const double difference = differenceFrom(slid);
  const flow::GreyPicture neutral{shape_.width, shape_.height, neutral_.values(), texels_.region};
  while (true) {
    progress_.checkCancelled();
    const flow::TextureFlow flow = flow::flowBetween(neutral, {shape_.width, shape_.height, slid, texels_.region});
    const Length length = lengthOf(flow, texels_.region);
    slide.found.after_mean = length.mean;
    slide.found.after_p95 = length.p95;
    if (slide.found.rounds == 0) {
      slide.found.before_mean = length.mean;
      slide.found.before_p95 = length.p95;
      slide.found.trusted = length.trusted;
    }
    if (slide.found.rounds == kMostRounds || length.p95 < kStill) break;
    slide.field = composed(slide.field, flow, texels_);
    sampler.sample(placesOf(slide.field, 0, shape_.height, shape_.width, shape_.height), slid);
    ++slide.found.rounds;
  }
  slide.found.moved = slide.found.rounds > 0 && differenceFrom(slid) < difference;
  if (slide.found.moved) {
    slide.found.largest = largestOf(slide.field, texels_.region);
  } else {
    slide.field = stillField(shape_.width, shape_.height);
    slide.found.after_mean = slide.found.before_mean;
    slide.found.after_p95 = slide.found.before_p95;
    slide.found.rounds = 0;
  }
  return slide;
}

}  // namespace facezip::align
