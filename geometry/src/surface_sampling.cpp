// surface_sampling.cpp - dart throwing with a CGAL k-d tree.
// A dart is a vertex, and all darts are thrown in one random order, so nothing is thrown twice and the result is
// maximal: a vertex is refused only because a sample covers it.
#include "facezip/geometry/surface_sampling.hpp"

#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "facezip/error.hpp"

namespace facezip::geometry {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using IndexedPoint = std::pair<Kernel::Point_3, int>;
using Traits = CGAL::Search_traits_adapter<IndexedPoint, CGAL::First_of_pair_property_map<IndexedPoint>,
                                           CGAL::Search_traits_3<Kernel>>;
using Tree = CGAL::Kd_tree<Traits>;
using Sphere = CGAL::Fuzzy_sphere<Traits>;

constexpr const char* kCoarserCure = "ask for fewer masks";

// SplitMix64 (Steele, Lea, Flood 2014), as a hash: the same on every platform, unlike the standard distributions.
std::uint64_t hash(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed + (counter + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

// All vertices in random order: by hash, then by index.
std::vector<int> randomOrder(int vertex_count, std::uint64_t seed) {
  // Hashing the seed first keeps seeds 1 and 2 from using shifted copies of one sequence.
  const std::uint64_t key = hash(seed, 0);
  std::vector<std::pair<std::uint64_t, int>> keyed;
  for (int v = 0; v < vertex_count; ++v) keyed.emplace_back(hash(key, static_cast<std::uint64_t>(v)), v);
  std::sort(keyed.begin(), keyed.end());
  std::vector<int> order;
  for (const auto& [ignored, vertex] : keyed) order.push_back(vertex);
  return order;
}

double boundingDiagonal(const RegionMesh& region) {
  return (region.positions.colwise().maxCoeff() - region.positions.colwise().minCoeff()).norm();
}

// Throws the darts of one seed at any number of radii.
class DartThrower {
 public:
  DartThrower(const RegionMesh& region, std::uint64_t seed)
      : region_(region), order_(randomOrder(region.vertexCount(), seed)) {
    std::vector<IndexedPoint> points;
    for (int v = 0; v < region.vertexCount(); ++v) points.emplace_back(point(v), v);
    tree_.insert(points.begin(), points.end());
    tree_.build();
  }

  SurfaceSamples sample(double radius) const {
    SurfaceSamples samples{radius, {}};
    std::vector<bool> covered(order_.size(), false);
    std::vector<bool> component_has_sample(static_cast<std::size_t>(region_.component_count), false);
    for (const int vertex : order_) {
      if (covered[static_cast<std::size_t>(vertex)]) continue;
      samples.vertices.push_back(vertex);
      component_has_sample[componentOf(vertex)] = true;
      cover(vertex, radius, covered);
    }
    // Components that others' samples cover wholly: their first vertex.
    for (const int vertex : order_) {
      if (component_has_sample[componentOf(vertex)]) continue;
      samples.vertices.push_back(vertex);
      component_has_sample[componentOf(vertex)] = true;
    }
    std::sort(samples.vertices.begin(), samples.vertices.end());
    return samples;
  }

 private:
  Kernel::Point_3 point(int v) const {
    return {region_.positions(v, 0), region_.positions(v, 1), region_.positions(v, 2)};
  }
  std::size_t componentOf(int vertex) const {
    return static_cast<std::size_t>(region_.components[static_cast<std::size_t>(vertex)]);
  }

  void cover(int vertex, double radius, std::vector<bool>& covered) const {
    covered[static_cast<std::size_t>(vertex)] = true;
    // The tree may differ from us on its sphere's surface, so it searches a little further and we decide.
    std::vector<IndexedPoint> near;
    tree_.search(std::back_inserter(near), Sphere(point(vertex), radius * (1 + 1e-9)));
    for (const auto& [ignored, other] : near) {
      const double distance = (region_.positions.row(other) - region_.positions.row(vertex)).norm();
      if (distance < radius) covered[static_cast<std::size_t>(other)] = true;
    }
  }

  const RegionMesh& region_;
  std::vector<int> order_;
  Tree tree_;
};

// Finds a radius for a count, remembering every radius tried.
class CountSearch {
 public:
  CountSearch(const DartThrower& thrower, int count, double diagonal)
      : thrower_(thrower), count_(count), diagonal_(diagonal) {}

  std::optional<SurfaceSamples> run() {
    // Below every distance between distinct vertices: all of them.
    double finer = std::max(1e-7 * diagonal_, std::numeric_limits<double>::min());
    double coarser = diagonal_;
    if (tryRadius(coarser) == count_ || tryRadius(finer) == count_) return std::move(found_);
    // 40 halvings of the ratio narrow 1e7 to 1 + 1e-11: then the count jumps at a single distance between vertices.
    for (int step = 0; step < 40; ++step) {
      const double middle = std::sqrt(finer * coarser);
      const int got = tryRadius(middle);
      if (got == count_) return std::move(found_);
      (got > count_ ? finer : coarser) = middle;
    }
    return scanAround(finer);
  }

  /// The largest count seen below the one wanted and the smallest above it, as text.
  std::string nearest() const {
    const auto above = tried_.upper_bound(count_);
    const std::string more = above == tried_.end() ? "" : std::to_string(above->first);
    const std::string fewer = above == tried_.begin() ? "" : std::to_string(std::prev(above)->first);
    return fewer.empty() || more.empty() ? fewer + more : fewer + " or " + more;
  }

 private:
  // The count jumps over the one wanted at the pivot; near it, on other plateaus, it may not.
  std::optional<SurfaceSamples> scanAround(double pivot) {
    constexpr int kSteps = 400;
    constexpr double kReach = 0.25;  // beyond, expected counts differ by half
    for (int step = 1; step <= kSteps; ++step) {
      const double factor = 1 + kReach * step / kSteps;
      for (const double radius : {pivot * factor, pivot / factor}) {
        if (radius <= diagonal_ && tryRadius(radius) == count_) return std::move(found_);
      }
    }
    return std::nullopt;
  }

  int tryRadius(double radius) {
    SurfaceSamples samples = thrower_.sample(radius);
    const int got = static_cast<int>(samples.vertices.size());
    tried_.emplace(got, radius);
    if (got == count_) found_ = std::move(samples);
    return got;
  }

  const DartThrower& thrower_;
  const int count_;
  const double diagonal_;
  std::map<int, double> tried_;
  std::optional<SurfaceSamples> found_;
};

int distinctPositions(const RegionMesh& region) {
  std::vector<std::tuple<double, double, double>> points;
  for (const auto& p : region.positions.rowwise()) points.emplace_back(p[0], p[1], p[2]);
  std::sort(points.begin(), points.end());
  return static_cast<int>(std::unique(points.begin(), points.end()) - points.begin());
}

}  // namespace

SurfaceSamples samplePoissonDisk(const RegionMesh& region, double radius, std::uint64_t seed) {
  const double diagonal = boundingDiagonal(region);
  if (!(radius > 0) || !std::isfinite(radius)) {
    throw InputError({"", "mask radius", "a length above 0", fmt::format("{}", radius), "choose a larger one"});
  }
  if (radius > diagonal) {
    throw InputError({"", "mask radius", fmt::format("at most {:.4g}, the diagonal of the face region", diagonal),
                      fmt::format("{:.4g}", radius), "choose a smaller one, or check the unit of the mesh"});
  }
  return DartThrower(region, seed).sample(radius);
}

SurfaceSamples sampleByCount(const RegionMesh& region, int count, std::uint64_t seed) {
  const int most = std::max(distinctPositions(region), region.component_count);
  if (count < region.component_count || count > most) {
    throw InputError(
        {"", "number of masks",
         fmt::format("from {} (the face region's separate parts) to {} (its vertices)", region.component_count, most),
         std::to_string(count), count > most ? kCoarserCure : "ask for more masks"});
  }
  const DartThrower thrower(region, seed);
  CountSearch search(thrower, count, boundingDiagonal(region));
  if (std::optional<SurfaceSamples> samples = search.run()) return *std::move(samples);
  throw InputError({"", "number of masks", fmt::format("{} samples", count), search.nearest(),
                    "ask for one of those, or pass another --seed"});
}

}  // namespace facezip::geometry
