// sample_bands.hpp - the textures of one map, neutral and expressions together, in bands of rows.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <stop_token>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/progress.hpp"
#include "image/image_file.hpp"
#include "image/scratch_file.hpp"

namespace facezip::image {

/// One band: rows [begin, end) of the neutral, then of every expression, each row-major and interleaved.
struct SampleBand {
  int begin = 0;
  int end = 0;
  std::span<const std::byte> samples;
};

/// Textures of a map that are no files: made row by row.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// Rows [begin, end) of the neutral, then of every expression, as a SampleBand holds them. A pass begins at row 0 and
  /// goes from top to bottom in multiples of 16 rows; called by one thread at a time.
  virtual void readRows(int begin, int end, std::span<std::byte> out) = 0;
};

class SampleBands {
 public:
  /// Opens every texture of `map` and checks it against the neutral's. Throws InputError: another size, channel count
  /// or sample type than the neutral's, more than four channels. names  the expressions' names, for messages
  SampleBands(const CaptureMap& map, const std::vector<std::string>& names);

  /// Of what `source` makes. shape  of the map; sample_type  of the samples that bands hold, which may be finer
  SampleBands(const ImageShape& shape, SampleType sample_type, int expressions, std::unique_ptr<SampleSource> source);

  /// Of the map's textures.
  const ImageShape& shape() const { return shape_; }
  /// Of the samples in bands: the shape's, but for what a source makes.
  SampleType sampleType() const { return sample_type_; }
  /// "" where all textures say the same of their colours (ImageReader::colours()), else a sentence that says who
  /// differs.
  std::string mixedColours() const;
  int expressions() const { return expressions_; }

  /// Bytes of all textures, decoded.
  std::size_t decodedBytes() const;

  /// Makes passes read from a scratch file in `directory` that decode() fills, once, whatever their number.
  void keepDecoded(const std::filesystem::path& directory) { scratch_ = std::make_unique<ScratchFile>(directory); }

  /// Decodes every texture into the scratch file, from top to bottom; passes may run meanwhile, in other threads, and
  /// wait for the rows that they read. What goes wrong is thrown by the passes. Call once, after keepDecoded().
  /// stop  ends the decoding early; passes must be over by then
  void decode(const std::stop_token& stop) noexcept;

  /// Calls `visit` for each band from top to bottom. The next band is read while `visit` works on this one; textures
  /// are decoded side by side. Throws InputError for an unreadable texture, what `visit` throws, and Cancelled.
  /// prepare  if set, is called for each band beside its reading, in another thread than `visit` and one band ahead
  void forEachBand(int band_rows, Progress& progress, const std::function<void(const SampleBand&)>& visit,
                   const std::function<void(int begin, int end)>& prepare = {});

  /// Reads rows [begin, end) of every texture, as a SampleBand holds them: from the scratch file where there is one.
  /// Passes over the rows must go from top to bottom where there is none. Throws InputError, OutputError.
  void readRows(int begin, int end, std::span<std::byte> out);
  std::size_t bandBytes(int rows) const;
  /// Bytes of a row of one texture, as bands hold it.
  std::size_t rowBytes() const;

  /// Seconds that forEachBand waited for samples, over all passes.
  double waitSeconds() const { return wait_seconds_; }
  /// Seconds that decoding took beside the work, over all passes.
  double decodeSeconds() const { return decode_seconds_; }

 private:
  /// Decodes rows [begin, end) of each texture on several threads, and gives them to keep(texture, rows).
  template <typename Keep>
  void decodeRows(int begin, int end, std::span<std::byte> out, const Keep& keep);
  void waitForRows(int end);
  std::size_t scratchOffset(std::size_t image, int row) const;

  std::string map_name_;
  ImageShape shape_;
  SampleType sample_type_;
  int expressions_;
  std::unique_ptr<SampleSource> source_;  ///< one of the two
  std::vector<ImageReader> readers_;
  std::unique_ptr<ScratchFile> scratch_;
  std::mutex mutex_;                 ///< of the next three
  std::condition_variable decoded_;  ///< rows came, or failure_
  int decoded_rows_ = 0;             ///< that are in scratch_
  std::exception_ptr failure_;       ///< of decode()
  std::vector<std::byte> buffers_[2];
  double wait_seconds_ = 0.0;
  std::atomic<double> decode_seconds_ = 0.0;
};

}  // namespace facezip::image
