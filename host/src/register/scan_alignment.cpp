#include "register/scan_alignment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "facezip/error.hpp"
#include "facezip/geometry/mesh_edges.hpp"

namespace facezip::registration {
namespace {

constexpr double kOffSurface = 5.0;  // millimetres: farther landmarks are mistakes, or in a hole
constexpr std::size_t kFewest = 6;
constexpr double kMirrored = 0.6;  // of the residual, that a mirror image leaves

struct FoundLandmarks {
  std::vector<geometry::Landmark> kept;
  std::vector<std::string> off;  ///< names
};

FoundLandmarks landmarksOn(const geometry::ScanSurface& surface,
                           const std::map<std::string, Eigen::RowVector3d>& points, const TemplateLandmarks& vertices,
                           double scale) {
  FoundLandmarks found;
  for (const auto& [name, point] : points) {
    const auto vertex = vertices.find(name);
    if (vertex == vertices.end()) continue;
    const Eigen::RowVector3d place = scale * point;
    if (surface.surface().closest(place.transpose(), kOffSurface).found()) {
      found.kept.push_back({vertex->second, place});
    } else {
      found.off.push_back(name);
    }
  }
  return found;
}

void requireEnough(const FoundLandmarks& found, const std::string& scan, const std::string& file, Progress& progress) {
  if (found.off.size() > found.kept.size()) {
    throw InputError({file, scan, "landmarks on the scan's surface",
                      fmt::format("{} of {} more than {:g} mm off it", found.off.size(),
                                  found.off.size() + found.kept.size(), kOffSurface),
                      "are they this scan's, in its unit?"});
  }
  if (found.kept.size() < kFewest) {
    throw InputError({file, scan, fmt::format("at least {} landmarks that the template has, too", kFewest),
                      std::to_string(found.kept.size()), ""});
  }
  if (found.off.empty()) return;
  progress.note(fmt::format("{}: landmarks off the surface are left out: {}", scan, fmt::join(found.off, ", ")));
}

void noteCleaning(const Scan& scan, Progress& progress) {
  if (!scan.cleaning.any()) return;
  progress.note(fmt::format("{}: {} vertices welded, {} triangles without area and {} in loose parts left out",
                            scan.name, scan.cleaning.welded_vertices, scan.cleaning.flat_triangles,
                            scan.cleaning.loose_triangles));
}

/// Whether the scan's triangles face against the template's, by the normals at the landmarks.
bool isInsideOut(const Scan& scan, const std::vector<geometry::Landmark>& landmarks,
                 const geometry::ScanSurface& surface, const geometry::TriangleMesh& mesh) {
  const geometry::Similarity motion = geometry::alignLandmarks(mesh.positions, landmarks, false);
  const Eigen::MatrixX3d normals = geometry::vertexNormals(motion.apply(mesh.positions), mesh.triangles);
  double facing = 0.0;
  for (const geometry::Landmark& mark : landmarks) {
    const geometry::SurfacePoint point = surface.surface().closest(mark.position.transpose());
    if (point.found()) facing += surface.surface().normals().row(point.triangle).dot(normals.row(mark.vertex));
  }
  return scan.mesh.triangles.rows() > 0 && facing < 0.0;
}

double rmsOf(const geometry::Similarity& motion, const Eigen::MatrixX3d& mesh,
             const std::vector<geometry::Landmark>& landmarks) {
  return landmarkRms(landmarks, motion.apply(mesh));
}

}  // namespace

double landmarkRms(const std::vector<geometry::Landmark>& landmarks, const Eigen::MatrixX3d& mesh) {
  double sum = 0.0;
  for (const geometry::Landmark& mark : landmarks) sum += (mark.position - mesh.row(mark.vertex)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(landmarks.size()));
}

PlacedScan placeScan(const std::filesystem::path& file, double millimetres_per_unit, const ScanLandmarks& landmarks,
                     const std::filesystem::path& landmark_file, const TemplateLandmarks& vertices,
                     const geometry::TriangleMesh& mesh, Progress& progress) {
  Scan scan = readScan(file);
  noteCleaning(scan, progress);
  scan.mesh.positions *= millimetres_per_unit;
  geometry::ScanSurface surface(scan.mesh.positions, scan.mesh.triangles);
  const auto points = landmarks.find(scan.name);
  if (points == landmarks.end()) {
    throw InputError({landmark_file.string(), scan.name, "landmarks of every scan", "none of this one", ""});
  }
  FoundLandmarks found = landmarksOn(surface, points->second, vertices, millimetres_per_unit);
  requireEnough(found, scan.name, landmark_file.string(), progress);
  if (isInsideOut(scan, found.kept, surface, mesh)) {
    progress.note(fmt::format("{}: triangles face inwards; they are turned about", scan.name));
    turnAbout(scan);
    surface = geometry::ScanSurface(scan.mesh.positions, scan.mesh.triangles);
  }
  return {std::move(scan), std::move(surface), std::move(found.kept)};
}

geometry::Similarity alignOrRefuse(const PlacedScan& placed, const Eigen::MatrixX3d& mesh, bool fixed_scale,
                                   double largest_rms) {
  const geometry::Similarity motion = geometry::alignLandmarks(mesh, placed.landmarks, fixed_scale);
  const double rms = rmsOf(motion, mesh, placed.landmarks);
  std::vector<geometry::Landmark> mirrored = placed.landmarks;
  for (geometry::Landmark& mark : mirrored) mark.position.x() *= -1.0;
  const double mirrored_rms = rmsOf(geometry::alignLandmarks(mesh, mirrored, fixed_scale), mesh, mirrored);
  if (mirrored_rms < kMirrored * rms && rms > kOffSurface) {
    throw InputError(
        {placed.scan.file.string(), "landmarks", "left and right as the template has them",
         fmt::format("a mirror image: {:.1f} mm from the template as they are, {:.1f} mm mirrored", rms, mirrored_rms),
         "swap left and right in the names, or mirror the scan"});
  }
  if (!(rms < largest_rms)) {
    throw InputError({placed.scan.file.string(), "landmarks", "those of the template, on a face",
                      fmt::format("{:.1f} mm between them at the best (rms)", rms),
                      "are scan and landmarks in one unit, and the names the template's?"});
  }
  return motion;
}

}  // namespace facezip::registration
