// blend.hpp - frames from a package and blendshape weights (FaceZip, Eq. 8).
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "facezip/device.hpp"
#include "facezip/gain.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// Of a blendshape weight, either way: a million times an expression is a mistake, and floats overflow not far above.
inline constexpr float kLargestWeight = 1e6f;
/// Beyond it, either way, a weight is noted: rigs drive shapes a little beyond 1, and people write per cent.
inline constexpr float kUsualWeight = 2.0f;

/// Blends frames of one package:  T(p) = I_0(p) + sum_i D_i(p) w_i(p),  w_i = bilinear(sum_n beta_n W_n[i])  (Eq. 8).
/// The textures go to the device once; frames then cost no upload and no allocation of texels.
/// One thread at a time may use a Blender.
class Blender {
 public:
  /// Reads every texel of `package` and puts it on `device`, weights all zero. Peak host memory is the weight maps and
  /// a band of rows. Throws InputError for damaged images, DeviceError when the device has not the memory.
  Blender(const Package& package, const Device& device);
  ~Blender();
  Blender(Blender&&) noexcept;
  Blender& operator=(Blender&&) noexcept;

  /// Sets beta, for the blend() calls that follow, of any map. Costs one pass over the weight maps of the expressions
  /// whose beta is not zero, of each set of weights.
  /// beta  N values in the order of Package::expressions(); any sign, at most kLargestWeight
  /// Throws InputError for another count, and naming the expression whose value is larger, or NaN.
  void setWeights(std::span<const float> beta);

  /// Sets gains, for the setWeights() calls that follow. Throws InputError when the gain is of another package.
  void setGain(const Gain& gain);

  /// Blends one map with the current weights into `out`, in the type of the map's neutral: integers are rounded half up
  /// and clamped; floats are neither. With all weights zero the result is the neutral, bit for bit.
  /// map_index  index into Package::maps()
  /// out        PackageMap::frameBytes() bytes: height x width x channels samples, row 0 first, channels interleaved.
  ///            On a CPU device the kernel writes straight into it when it is aligned to 64 bytes (16 for 8-bit RGB)
  ///            and the width is a multiple of 16 and the height of 8; otherwise the frame is copied once.
  /// Throws InputError for an index or a size that does not fit.
  void blend(int map_index, std::span<std::byte> out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A weight vector from names: beta of every expression that is not named is 0. A name may be another one of the same
/// blendshape: ARKit's mouthSmileLeft is mouthSmile_L and AU12L, upper and lower case alike; AU12 is both sides, and an
/// expression AU12 gets half of the weights of mouthSmileLeft and mouthSmileRight. Exact names go first.
/// Throws InputError for a name that the package does not have, with the nearest names that it has, and for an
/// expression that is named twice.
std::vector<float> weightsByName(const Package& package, const std::vector<std::pair<std::string, float>>& weights);

/// Reads "smile=0.7,jawOpen=0.2"; blanks around names and values are ignored, the empty text is no weights.
/// Throws InputError that quotes the part that is not NAME=NUMBER.
std::vector<std::pair<std::string, float>> parseWeights(std::string_view text);

/// Blendshape weights over time.
struct AnimationClip {
  int expressions = 0;         ///< N
  std::vector<float> weights;  ///< frames x N, in the package's order

  int frames() const { return expressions == 0 ? 0 : static_cast<int>(weights.size()) / expressions; }
  std::span<const float> frame(int index) const {
    return std::span(weights).subspan(static_cast<std::size_t>(index) * static_cast<std::size_t>(expressions),
                                      static_cast<std::size_t>(expressions));
  }
};

/// Reads a comma-separated table: a header of expression names in any order, then a row of weights a frame. Names are
/// those that weightsByName() takes. Expressions without a column stay 0; columns that no expression is called are
/// skipped, and empty lines. A row whose column "BlendShapeCount" is 0, as Live Link Face writes where it finds no
/// face, repeats the frame before. progress  notes skipped columns, but for what trackers write beside weights (time,
/// turns of the head), and weights
///           above 2, which are per cent, most likely; may be null
/// Throws InputError naming file, line and column: no column of an expression, two of one, a weight that is no number.
AnimationClip readAnimation(const std::filesystem::path& file, const Package& package, Progress* progress = nullptr);

}  // namespace facezip
