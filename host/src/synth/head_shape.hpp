// head_shape.hpp - the skin of a neutral head as a closed formula.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace facezip::synth {

/// A point of the skin, in metres on the neutral face: s to the subject's left along a horizontal section from the
/// midline, t upwards along the profile from the line between the lips. Nearly isometric except on nose and lips.
struct SkinPoint {
  double s = 0.0;
  double t = 0.0;
};

/// Where the features are on the skin. Everything that paints or moves the face refers to these.
struct Landmarks {
  double bottom = -0.1155;  ///< t of the lower border, on the neck
  double top = 0.165;       ///< t of the upper border, on the scalp
  double mouth_half_width = 0.025;
  double eye_s = 0.0315;  ///< centre of the left eye; the right one mirrors it
  double eye_t = 0.066;
  double eye_half_width = 0.0145;
  double brow_t = 0.0835;
  double upper_lid_height = 0.0065;  ///< opening of the lids above and below the line between the eye's corners
  double lower_lid_height = 0.0040;
};

/// Shape of one face. Proportions depend on the seed; landmarks do not, so that all seeds share a layout.
class HeadShape {
 public:
  explicit HeadShape(std::uint64_t seed);

  /// Position in metres: y up, z out of the face, x to the subject's left.
  Eigen::Vector3d position(SkinPoint point) const;
  /// Largest |s| of the mesh at height t: the chart's outline is rounded.
  static double halfWidth(double t);

  const Landmarks& landmarks() const { return landmarks_; }

 private:
  double relief(double s, double t) const;
  double noseHeight(double s, double t) const;
  double eyeRelief(double s, double t) const;
  double lipRelief(double s, double t) const;
  double cheekRelief(double s, double t) const;

  Landmarks landmarks_;
  std::uint64_t noise_seed_;
  double width_, jaw_width_, nose_length_, nose_width_, lip_fullness_, brow_ridge_, cheekbone_, chin_;
};

}  // namespace facezip::synth
