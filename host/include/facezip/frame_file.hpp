// frame_file.hpp - blended frames as image files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "facezip/blend.hpp"
#include "facezip/memory.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// Writes one blended frame of `map`; the extension decides the format. The file appears whole or not at all;
/// directories above it are made.
/// frame     map.frameBytes() bytes, as Blender::blend() gives them
/// progress  gets a note of what a killed run left there; may be null
/// Throws InputError for a format that is not known or could not hold the frame, OutputError.
void writeFrame(const std::filesystem::path& file, const PackageMap& map, std::span<const std::byte> frame,
                Progress* progress = nullptr);

/// Writes a picture, 8-bit RGB, likewise.
/// samples  height x width x 3, from the upper left corner
void writePicture(const std::filesystem::path& file, int width, int height, std::span<const std::byte> samples);

/// Names of frame files from a pattern: "%d" or "%04d" stands for the number of the frame, "{map}" for the map's name.
class FramePattern {
 public:
  /// numbered  several frames are to be written, so the pattern must tell them apart
  /// maps      number of maps; without "{map}" the names of several are put before the extension: frame.albedo.png
  /// Throws InputError naming what is missing or malformed.
  FramePattern(std::string pattern, bool numbered, std::size_t maps);
  std::filesystem::path file(int frame, const std::string& map) const;
  /// Throws, before any work, InputError where frames of a map would lose something in that format, OutputError where
  /// one of frames 0 to frames - 1 would be an input or lie in one, or among the textures of a capture or package.
  /// inputs  beside the package
  void requireFits(const Package& package, int frames = 1, ProtectedPaths inputs = {}) const;

 private:
  void findNumber();

  std::string pattern_;
  std::size_t number_begin_ = std::string::npos;
  std::size_t number_length_ = 0;
  int number_width_ = 0;
  bool append_map_ = false;
};

/// Blends every frame of `clip` for every map of `package`, as Blender does, and writes pattern.file(frame, map). The
/// package is put on the device where it fits; else rows of its textures stream through in bands, from disk for each
/// frame: the same bytes, slower.
/// memory_bytes  what the process may keep resident, host and device together
/// Throws InputError for damaged images, and a package whose weights alone need more memory; what writeFrame() does;
/// DeviceError, Cancelled.
void writeFrames(const Package& package, const AnimationClip& clip, const Gain& gain, const FramePattern& pattern,
                 const Device& device, Progress& progress, std::uint64_t memory_bytes = kDefaultMemoryBytes);

}  // namespace facezip
