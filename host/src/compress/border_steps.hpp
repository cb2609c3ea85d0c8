// border_steps.hpp - how much expressions change tone or light where the region ends: what would stop there at once.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "bands/map_bands.hpp"
#include "bands/map_set.hpp"

namespace facezip::compress {

/// Looks at the texels just outside the region while the textures are read the first time.
class BorderSteps {
 public:
  /// mesh, region  as raster::UvRaster takes them
  BorderSteps(const MapSet& maps, const geometry::TriangleMesh& mesh, std::span<const int> region);

  /// Shows a band of map `m`; of rising rows.
  void addBand(std::size_t m, const MapBand& band);

  /// The step that an expression makes at the border, in 1/255: root mean square over the border of differences that
  /// are averaged over stretches of it, so that noise is not taken for one. Of the expression and map with the largest.
  double largest() const;

 private:
  struct Border {
    std::vector<std::uint32_t> texels;  ///< row * width + column, rising
    std::vector<int> stretch;           ///< of each
    std::vector<int> counts;            ///< texels of each stretch
    Eigen::MatrixXd sums;               ///< differences: stretches x (expressions x channels)
    int width = 0;
    std::size_t next = 0;  ///< of `texels`, not yet shown
  };
  std::vector<Border> borders_;  ///< of every map
};

/// Steps from here on, in 1/255, are seen, and fade out unless told otherwise.
inline constexpr double kVisibleStep = 1.0;

}  // namespace facezip::compress
