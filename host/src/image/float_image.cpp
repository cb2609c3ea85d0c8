#include "image/float_image.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "facezip/error.hpp"
#include "image/set_sample.hpp"

namespace facezip::image {
namespace fs = std::filesystem;
namespace {

constexpr int kBandRows = 64;

/// One texel's part of another, along one axis.
struct Tap {
  int texel = 0;
  float weight = 0.0f;
};
using Taps = std::vector<std::vector<Tap>>;  ///< of each resulting texel, in rising order

/// Averages the texels that a resulting one covers.
std::vector<Tap> averageTaps(int to, double scale, int size) {
  std::vector<Tap> taps;
  const double begin = to * scale, end = (to + 1) * scale;
  for (int i = static_cast<int>(begin); i < size && i < end; ++i) {
    const double share = (std::min<double>(i + 1, end) - std::max<double>(i, begin)) / scale;
    if (share > 0.0) taps.push_back({i, static_cast<float>(share)});
  }
  return taps;
}

std::vector<Tap> bilinearTaps(int to, double scale, int size) {
  const double place = std::clamp((to + 0.5) * scale - 0.5, 0.0, size - 1.0);
  const int first = std::min(static_cast<int>(place), size - 1);
  const auto share = static_cast<float>(place - first);
  if (first + 1 >= size || share == 0.0f) return {{first, 1.0f}};
  return {{first, 1.0f - share}, {first + 1, share}};
}

Taps tapsOf(int from, int to) {
  const double scale = static_cast<double>(from) / to;
  Taps taps;
  for (int i = 0; i < to; ++i) taps.push_back(scale > 1.0 ? averageTaps(i, scale, from) : bilinearTaps(i, scale, from));
  return taps;
}

/// The same by the texels that are read: which resulting ones each is part of.
Taps turned(const Taps& taps, int from) {
  Taps parts(static_cast<std::size_t>(from));
  for (std::size_t to = 0; to < taps.size(); ++to) {
    for (const Tap& tap : taps[to]) {
      parts[static_cast<std::size_t>(tap.texel)].push_back({static_cast<int>(to), tap.weight});
    }
  }
  return parts;
}

void resampleRow(std::span<const float> row, const Taps& columns, int channels, std::span<float> out) {
  for (std::size_t x = 0; x < columns.size(); ++x) {
    for (int c = 0; c < channels; ++c) {
      float sum = 0.0f;
      for (const Tap& tap : columns[x]) sum += tap.weight * row[static_cast<std::size_t>(tap.texel * channels + c)];
      out[x * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] = sum;
    }
  }
}

/// Resamples rows that come in from top to bottom.
class RowResampler {
 public:
  RowResampler(int width, int height, int channels, FloatImage& result)
      : channels_(channels),
        columns_(tapsOf(width, result.width)),
        rows_(turned(tapsOf(height, result.height), height)),
        result_(result),
        narrow_(static_cast<std::size_t>(result.width) * static_cast<std::size_t>(channels)) {}

  void add(int y, std::span<const float> row) {
    resampleRow(row, columns_, channels_, narrow_);
    for (const Tap& part : rows_[static_cast<std::size_t>(y)]) {
      float* out = result_.samples.data() + static_cast<std::size_t>(part.texel) * narrow_.size();
      for (std::size_t i = 0; i < narrow_.size(); ++i) out[i] += part.weight * narrow_[i];
    }
  }

 private:
  int channels_;
  Taps columns_, rows_;
  FloatImage& result_;
  std::vector<float> narrow_;
};

/// Rows [begin, end) as floats in 1/255.
std::vector<float> readFloats(ImageReader& reader, int begin, int end) {
  Image band{reader.shape(), {}};
  band.shape.height = end - begin;
  band.samples.resize(static_cast<std::size_t>(end - begin) * band.shape.rowBytes());
  reader.readRows(begin, end, band.samples);
  std::vector<float> floats(band.samples.size() / sampleBytes(band.shape.type));
  for (std::size_t i = 0; i < floats.size(); ++i) floats[i] = 255.0f * sampleAt(band, i);
  return floats;
}

}  // namespace

FloatImage::FloatImage(int w, int h, int c)
    : width(w),
      height(h),
      channels(c),
      samples(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(c)) {}

std::string FloatImage::sizeText() const { return fmt::format("{} x {}, {} channels", width, height, channels); }

FloatImage readFloatImage(const fs::path& path) {
  ImageReader reader(path);
  const ImageShape shape = reader.shape();
  FloatImage image(shape.width, shape.height, shape.channels);
  image.samples = readFloats(reader, 0, shape.height);
  return image;
}

FloatImage readResized(const fs::path& path, int width, int height) {
  ImageReader reader(path);
  const ImageShape shape = reader.shape();
  FloatImage result(width, height, shape.channels);
  RowResampler resampler(shape.width, shape.height, shape.channels, result);
  const auto row = static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.channels);
  for (int begin = 0; begin < shape.height; begin += kBandRows) {
    const int end = std::min(begin + kBandRows, shape.height);
    const std::vector<float> band = readFloats(reader, begin, end);
    for (int y = begin; y < end; ++y) {
      resampler.add(y, std::span(band).subspan(static_cast<std::size_t>(y - begin) * row, row));
    }
  }
  return result;
}

std::string losslessExtension(const fs::path& path) {
  return ImageReader(path).shape().type == SampleType::kFloat32 ? ".exr" : ".png";
}

void writeChanged(const fs::path& neutral, const FloatImage& change, const fs::path& output) {
  ImageReader reader(neutral);
  const ImageShape shape = reader.shape();
  if (shape.channels != change.channels) {
    throw InputError({neutral.string(), "texture", fmt::format("{} channels, as its changes have", change.channels),
                      fmt::format("{}", shape.channels), ""});
  }
  const Taps columns = tapsOf(change.width, shape.width), rows = tapsOf(change.height, shape.height);
  const auto wide = static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.channels);
  const auto narrow = static_cast<std::size_t>(change.width) * static_cast<std::size_t>(change.channels);
  ImageWriter writer(output, shape, reader.colours());
  for (int begin = 0; begin < shape.height; begin += kBandRows) {
    const int end = std::min(begin + kBandRows, shape.height);
    Image band{shape, {}};
    band.shape.height = end - begin;
    band.samples.resize(static_cast<std::size_t>(end - begin) * shape.rowBytes());
    reader.readRows(begin, end, band.samples);
    tbb::parallel_for(begin, end, [&](int y) {
      std::vector<float> row(narrow), out(wide);
      for (const Tap& tap : rows[static_cast<std::size_t>(y)]) {
        const float* from = change.samples.data() + static_cast<std::size_t>(tap.texel) * narrow;
        for (std::size_t i = 0; i < narrow; ++i) row[i] += tap.weight * from[i];
      }
      resampleRow(row, columns, shape.channels, out);
      const std::size_t first = static_cast<std::size_t>(y - begin) * wide;
      for (std::size_t i = 0; i < wide; ++i) {
        setSample(band, first + i, sampleAt(band, first + i) + out[i] / 255.0f);
      }
    });
    writer.writeRows(band.samples, end - begin);
  }
  writer.close();
}

}  // namespace facezip::image
