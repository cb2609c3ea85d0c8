// surface_sampling.hpp - Poisson-disk samples of the face region (FaceZip 3.1, Mask Computation).
#pragma once

#include <cstdint>
#include <vector>

#include "facezip/geometry/face_region.hpp"

namespace facezip::geometry {

/// Samples of the region, one for each mask.
struct SurfaceSamples {
  double radius = 0;          ///< in the unit of the mesh
  std::vector<int> vertices;  ///< K region vertices, ascending
};

/// Dart throwing over the region's vertices: visits them in a random order and keeps each that has no kept vertex
/// within the radius (Euclidean). The result is maximal: every vertex is a sample or closer than the radius to one, and
/// samples are at least the radius apart. A connected component that lies in the shadow of another one's samples gets
/// one sample all the same, as its masks need one; those alone may be closer than the radius to another sample.
/// Same region, radius and seed: same samples, on every platform. Cost: one k-d tree query per sample.
/// radius  above 0 and at most the diagonal of the region's bounding box, in the unit of the mesh
/// Throws InputError for any other radius.
SurfaceSamples samplePoissonDisk(const RegionMesh& region, double radius, std::uint64_t seed);

/// Searches the radius at which samplePoissonDisk gives exactly count samples, and returns both. The count falls with
/// the radius, but not steadily: the search bisects and then looks around where the count passes the one wanted. Cost:
/// tens to hundreds of samplings. count  at least the number of components, at most that of distinct vertices Throws
/// InputError beyond those, or naming the nearest counts if no radius was found to give this one.
SurfaceSamples sampleByCount(const RegionMesh& region, int count, std::uint64_t seed);

}  // namespace facezip::geometry
