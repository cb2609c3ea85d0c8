// texture_flow.hpp - how textures in one layout slide against each other: dense optical flow, by OpenCV.
//
// OpenCV's video module brings 25 libraries of Debian. As with OpenImageIO (image/image_format.hpp) a program may leave
// it to a module that is loaded by the commands that need flow.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace facezip::flow {

/// A grey picture of which some texels are known.
struct GreyPicture {
  int width = 0;
  int height = 0;
  std::span<const float> grey;          ///< [height][width], 0..1
  std::span<const std::uint8_t> known;  ///< [height][width], 0: nothing was seen
};

/// The grey of a sample of one channel or three, as greys of encoded colours are made (Rec. 601).
inline float greyOf(const float* sample, int channels) {
  return channels == 3 ? 0.299f * sample[0] + 0.587f * sample[1] + 0.114f * sample[2] : sample[0];
}

/// Flow both ways: texel x of `from` shows what texel x + forward(x) of `to` does, and the other way about.
struct TextureFlow {
  int width = 0;
  int height = 0;
  std::vector<float> forward;   ///< [height][width][2], x to the right, y down, in texels
  std::vector<float> backward;  ///< [height][width][2]
  /// [height][width], -1..1: correlation of the details around a texel of `from` with those that it flows to; 0 where
  /// nothing is known. Creases of one picture alone flow there and back as smoothly as skin, but do not look alike.
  std::vector<float> agreement;
};

/// The flow between the details of two pictures: each less its local mean, over its local deviation, so that blood,
/// shading and gain do not pull. The same pictures give the same flow, on any number of threads.
/// Pictures are of one size, at least 32 texels a side. Throws Error.
TextureFlow flowBetween(const GreyPicture& from, const GreyPicture& to);

/// How far flow is believed, 0 to 1: it comes back to where it began, and what it flows to looks alike.
double trustOf(const TextureFlow& flow, int x, int y);

/// How far there and back misses where it began, in texels, at a texel of `from`; infinity where that leaves the
/// picture. Folds and what one picture alone shows miss by much.
float missedBy(const TextureFlow& flow, int x, int y);

/// What the module exports; the library facezip holds it itself.
using FlowFunction = TextureFlow (*)(const GreyPicture& from, const GreyPicture& to);
extern "C" __attribute__((visibility("default"))) FlowFunction facezipOpenCvFlow();
inline constexpr const char* kOpenCvFlowEntry = "facezipOpenCvFlow";

}  // namespace facezip::flow
