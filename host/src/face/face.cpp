#include "face/face.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "capture/capture_meshes.hpp"
#include "face/painted_image.hpp"
#include "facezip/geometry/float_origin.hpp"
#include "facezip/geometry/topology.hpp"

namespace facezip::compress {
namespace fs = std::filesystem;
namespace {

std::vector<int> paintedRegion(const geometry::TriangleMesh& mesh, const fs::path& file) {
  const PaintedImage painted = readPaintedImage(file);
  std::vector<int> region = geometry::regionFromPredicate(mesh, [&painted](double u, double v) {
    const int x = std::clamp(static_cast<int>(std::floor(u * painted.width)), 0, painted.width - 1);
    const int y = std::clamp(static_cast<int>(std::floor((1.0 - v) * painted.height)), 0, painted.height - 1);
    return painted.at(x, y) > 0.5f;
  });
  if (region.empty()) {
    throw InputError({file.string(), "", "a painted part (brighter than half) that covers triangles of the mesh",
                      "an empty region", "paint the part of the face that changes white"});
  }
  return region;
}

std::vector<int> regionFromFile(const geometry::TriangleMesh& mesh, const fs::path& file) {
  if (file.extension() == ".txt") return geometry::readTriangleIndices(file, static_cast<int>(mesh.triangles.rows()));
  return paintedRegion(mesh, file);
}

/// Keeps the triangles that lie in the tile of the textures; others have textures elsewhere.
void keepTile(const Capture& capture, Face& face) {
  std::erase_if(face.region, [&](int triangle) {
    const Eigen::Matrix<double, 3, 2> corners = face.mesh.uvs(face.mesh.uv_triangles.row(triangle), Eigen::all);
    const Eigen::RowVector2d middle = corners.colwise().mean();
    return middle.minCoeff() < 0.0 || middle.maxCoeff() > 1.0;
  });
  face.region_description += fmt::format(", tile {}", *capture.tile);
  if (!face.region.empty()) return;
  throw InputError({capture.neutral_mesh.string(), "",
                    fmt::format("UVs in tile {}, as the textures' names say", *capture.tile), "none of the region",
                    ""});
}

}  // namespace

Face readFace(const Capture& capture, const std::string& region) {
  Face face;
  face.mesh = CaptureMeshes(capture).neutral();
  std::optional<fs::path> file;
  if (region.empty()) {
    file = capture.face_region ? capture.face_region : capture.coverage;
  } else if (region != "whole") {
    file = region;
  }
  // UVs first: a painted region cannot be looked up without them.
  if (face.mesh.uv_triangles.rows() == 0) geometry::requireUvs(face.mesh, capture.neutral_mesh.string());
  face.region = file ? regionFromFile(face.mesh, *file) : geometry::wholeMeshRegion(face.mesh);
  face.region_description = file ? file->filename().string() : "whole mesh";
  if (capture.tile) keepTile(capture, face);
  geometry::requireUvs(face.mesh, capture.neutral_mesh.string(), face.region);
  return face;
}

std::vector<Eigen::MatrixX3f> readExpressionMeshes(const Capture& capture, Progress& progress) {
  progress.stage("checking meshes", capture.expression_meshes.size());
  std::vector<Eigen::MatrixX3f> positions(capture.expression_meshes.size());
  const CaptureMeshes from(capture);
  const Eigen::RowVector3d origin = geometry::floatOrigin(from.neutral().positions);
  tbb::parallel_for(std::size_t{0}, capture.expression_meshes.size(), [&](std::size_t n) {
    if (capture.expression_meshes[n].empty()) return;
    progress.checkCancelled();
    positions[n] = (from.positions(n).rowwise() - origin).cast<float>();
  });
  return positions;
}

std::vector<Eigen::MatrixX3d> readExpressionMeshes(const Capture& capture, const std::string& needed_for,
                                                   Progress& progress) {
  for (std::size_t n = 0; n < capture.expressions.size(); ++n) {
    if (!capture.expression_meshes[n].empty()) continue;
    throw InputError({(capture.directory / "expressions" / (capture.expressions[n] + ".obj")).string(),
                      fmt::format("expression \"{}\"", capture.expressions[n]), needed_for, "no such file",
                      "add the mesh, or take the expression out of the capture"});
  }
  progress.stage("reading expressions", capture.expressions.size());
  const CaptureMeshes from(capture);
  std::vector<Eigen::MatrixX3d> meshes(capture.expressions.size());
  tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t n) {
    progress.checkCancelled();
    meshes[n] = from.positions(n);
  });
  return meshes;
}

namespace {

/// Finds the mesh's unit, where a length in a physical unit has to be applied to it or its size is written.
void resolveUnit(const Capture& capture, const Face& face, const CompressOptions& options, FaceMasks& result,
                 Progress& progress) {
  const std::string stated = options.unit.value_or(capture.unit);
  if (!stated.empty()) {
    result.unit = geometry::parseUnit(stated);
    return;
  }
  const bool needed = !options.masks && options.mask_radius.unit;
  if (!needed && !options.mesh) return;
  try {
    const geometry::UnitGuess guess = geometry::guessUnit(face.mesh);
    result.unit = guess.unit;
    result.unit_guessed = true;
    progress.note(guess.explanation);
  } catch (const InputError& error) {
    if (needed) throw error.in(capture.neutral_mesh.string());
    progress.note(fmt::format("{}: its size ({}) tells no unit: it is written as if in metres; {}",
                              capture.neutral_mesh.string(), error.parts().got, error.parts().cure));
  }
}

geometry::SurfaceSamples sampleRegion(const FaceMasks& face, const CompressOptions& options) {
  if (options.masks) return geometry::sampleByCount(face.region, *options.masks, options.seed);
  const geometry::Length& radius = options.mask_radius;
  const double in_mesh_units = radius.unit ? geometry::toMeshUnits(radius, face.unit.value()) : radius.value;
  return geometry::samplePoissonDisk(face.region, in_mesh_units, options.seed);
}

}  // namespace

FaceMasks makeFaceMasks(const Capture& capture, const Face& face, const CompressOptions& options, Progress& progress) {
  FaceMasks result;
  progress.stage("masks", 0);
  resolveUnit(capture, face, options, result, progress);
  result.region = geometry::extractRegion(face.mesh, face.region);
  try {
    result.samples = sampleRegion(result, options);
  } catch (const InputError& error) {
    throw error.in(options.masks ? "--masks" : "--mask-radius");
  }
  progress.checkCancelled();
  const Eigen::MatrixXd phi = geometry::solveMaskWeights(result.region, result.samples.vertices);
  result.masks = geometry::compactMaskWeights(phi, options.mask_cutoff);
  return result;
}

}  // namespace facezip::compress
