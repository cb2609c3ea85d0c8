// write_frames.cpp - frames of a package as files, within the memory that was given.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "blend/band_blender.hpp"
#include "blend/blend_memory.hpp"
#include "blend/frame_writer.hpp"
#include "blend/weight_blend.hpp"
#include "facezip/frame_file.hpp"
#include "io/memory_bound.hpp"
#include "package/package_files.hpp"

namespace facezip {
namespace {

/// The whole package lies on the device: frames cost no reading.
void writeFromDevice(const Package& package, const AnimationClip& clip, const Gain& gain, const FramePattern& pattern,
                     const Device& device, Progress& progress) {
  Blender blender(package, device);
  blender.setGain(gain);
  std::vector<std::byte> frame;
  for (int f = 0; f < clip.frames(); ++f) {
    blender.setWeights(clip.frame(f));
    for (std::size_t m = 0; m < package.maps().size(); ++m) {
      progress.checkCancelled();
      const PackageMap& map = package.maps()[m];
      frame.resize(map.frameBytes());
      blender.blend(static_cast<int>(m), frame);
      writeFrame(pattern.file(f, map.name), map, frame, &progress);
    }
    progress.advance(static_cast<std::size_t>(f) + 1);
  }
}

/// A band of rows of the textures at a time, from disk for each frame.
class BandFrames {
 public:
  BandFrames(const Package& package, const Gain& gain, const Device& device, std::uint64_t band_bytes)
      : package_(package), gain_(gain), band_bytes_(band_bytes), weights_(blend::loadWeightMaps(package, device)) {
    for (std::size_t set = 0; set < weights_.size(); ++set) weights_[set]->setGain(gain.cells[set]);
    for (std::size_t m = 0; m < package.maps().size(); ++m) {
      blenders_.emplace_back(package, static_cast<int>(m), weights_, device);
    }
  }

  void write(std::span<const float> weights, std::size_t m, const std::filesystem::path& file, Progress& progress) {
    const PackageMap& map = package_.maps()[m];
    std::vector<float> beta(weights.begin(), weights.end());
    for (std::size_t n = 0; n < beta.size(); ++n) beta[n] *= gain_.expressions[n];
    blend::writeFrameBy(file, map, &progress, [&](image::ImageWriter& writer) {
      const int rows_at_once = blenders_[m].rowsWithin(band_bytes_);
      std::vector<std::byte> rows;
      for (int begin = 0; begin < map.height; begin += rows_at_once) {
        progress.checkCancelled();
        const int end = std::min(begin + rows_at_once, map.height);
        rows.resize(static_cast<std::size_t>(end - begin) * package::neutralShape(map).rowBytes());
        blenders_[m].loadRows(begin, end);
        blenders_[m].blend(beta, rows);
        writer.writeRows(rows, end - begin);
      }
    });
  }

 private:
  const Package& package_;
  const Gain& gain_;
  std::uint64_t band_bytes_;
  blend::WeightSets weights_;
  std::vector<blend::BandBlender> blenders_;  // per map
};

/// What BandFrames takes with bands of one row of tiles. Each map keeps its band.
std::uint64_t leastBytes(const Package& package) {
  std::uint64_t bytes = blend::weightBytes(package);
  for (const PackageMap& map : package.maps()) {
    bytes += blend::bandBytes(map, package.differences()) + blend::stagingBytes(map, package.differences()) +
             blend::writerBytes(map);
  }
  return bytes;
}

std::uint64_t largestFrame(const Package& package) {
  std::uint64_t largest = 0;
  for (const PackageMap& map : package.maps()) largest = std::max<std::uint64_t>(largest, map.frameBytes());
  return largest;
}

}  // namespace

void writeFrames(const Package& package, const AnimationClip& clip, const Gain& gain, const FramePattern& pattern,
                 const Device& device, Progress& progress, std::uint64_t memory_bytes) {
  progress.stage("blending", static_cast<std::size_t>(clip.frames()));
  const std::uint64_t whole = io::kProcessBytes + blend::blenderBytes(package) + largestFrame(package);
  if (whole <= memory_bytes) return writeFromDevice(package, clip, gain, pattern, device, progress);
  const std::uint64_t least = leastBytes(package);
  io::requireMemory(least, memory_bytes, package.directory().string());
  const std::uint64_t left = memory_bytes - io::kProcessBytes - least;
  BandFrames frames(package, gain, device, left / package.maps().size());
  for (int f = 0; f < clip.frames(); ++f) {
    for (std::size_t m = 0; m < package.maps().size(); ++m) {
      frames.write(clip.frame(f), m, pattern.file(f, package.maps()[m].name), progress);
    }
    progress.advance(static_cast<std::size_t>(f) + 1);
  }
}

}  // namespace facezip
