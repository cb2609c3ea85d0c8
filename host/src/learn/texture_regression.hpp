// texture_regression.hpp - what an expression does to a texture, told from the strain of the skin and from the
// neutral's own texture: where faint lines are, wrinkles deepen.
//
// The change of a texel, over the usual level of its channel, is  y = sum_kj B_kj h_k(u) f_j,   with
//   u    strain of the skin there: log of the mean length of the edges around a vertex over that of the neutral
//   h_k  hat functions of u, 0 where nothing is strained
//   f_j  1; local colour and details at three scales of the neutral's textures; the details over their usual size
// Textures count over the mean of their channel: how bright a scan is as a whole says nothing of the skin, and a
// regression would learn to undo it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "image/float_image.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::learn {

/// One way to predict a map: from the textures of some maps of the neutral.
struct TextureRegression {
  std::vector<std::string> maps;  ///< that features are made of, in order
  std::vector<int> channels;      ///< of each
  Eigen::MatrixXf factors;        ///< B: K J by channels of the predicted map, row k J + j
};

/// A map that is predicted.
struct TextureModel {
  std::string map;
  int channels = 0;
  int side = 0;                                ///< texels of the layout along each axis
  std::vector<TextureRegression> regressions;  ///< the one that needs most of the neutral first
};

/// Which vertices each texel of a square layout lies among.
class TexelStrain {
 public:
  /// region  triangles whose textures change
  TexelStrain(const geometry::TriangleMesh& neutral, const std::vector<int>& region, int side);

  int side() const { return side_; }
  /// Texels of the region, rising: row side + column.
  const std::vector<int>& texels() const { return texels_; }
  /// u of each of them. displacement  #V by 3, of the neutral that this was made with
  Eigen::VectorXf of(const Eigen::MatrixX3d& displacement) const;

  /// An image, zero outside the region, whose texels around it take the nearest one's value where no triangle lies.
  /// values  texels by channels
  image::FloatImage imageOf(const Eigen::MatrixXf& values) const;

 private:
  int side_ = 0;
  Eigen::MatrixX3d neutral_;
  Eigen::MatrixX3i triangles_;
  std::vector<int> texels_;
  std::vector<raster::TexelSample> samples_;  ///< of the texels
  std::vector<int> source_;                   ///< of every texel of the image: index into texels_, -1 for none
};

/// The mean of each channel over the texels, at least 16; 1/255.
Eigen::RowVectorXf levelsOf(const image::FloatImage& texture, const std::vector<int>& texels);

/// f of every texel: texels by J.
/// textures  of the neutral, side by side
Eigen::MatrixXf textureFeatures(const std::vector<image::FloatImage>& textures, const std::vector<int>& texels);
/// J for textures of so many channels together.
Eigen::Index featureCount(int channels);
/// K, hat functions.
Eigen::Index hatCount();

/// y of every texel: texels by channels of the predicted map.
/// strain  u;  features  f of the regression's maps
Eigen::MatrixXf predictTexture(const TextureRegression& regression, const Eigen::VectorXf& strain,
                               const Eigen::MatrixXf& features);

/// Sums of least squares, over subjects and expressions in any number.
class TextureSums {
 public:
  TextureSums(Eigen::Index features, Eigen::Index channels);
  /// Adds one expression. changes  texels by channels, of all maps that are predicted side by side
  void add(const Eigen::VectorXf& strain, const Eigen::MatrixXf& features, const Eigen::MatrixXf& changes);
  void add(const TextureSums& other);
  /// Factors for columns [begin, begin + count) of the changes from features `used`.
  Eigen::MatrixXf solve(const std::vector<Eigen::Index>& used, Eigen::Index begin, Eigen::Index count) const;
  /// Root mean square over the texels of what factors from all features leave of columns [begin, begin + count), and of
  /// these columns.
  std::pair<double, double> errorOf(const Eigen::MatrixXf& factors, Eigen::Index begin, Eigen::Index count) const;

 private:
  Eigen::MatrixXd gram_;     ///< K J by K J
  Eigen::MatrixXd right_;    ///< K J by channels
  Eigen::VectorXd squares_;  ///< channels: sums of squares of the changes
  double texels_ = 0.0;
};

}  // namespace facezip::learn
