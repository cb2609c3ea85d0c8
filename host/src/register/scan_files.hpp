// scan_files.hpp - raw scans, from disk.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "facezip/geometry/scan_surface.hpp"
#include "io/scratch_directory.hpp"
#include "register/landmark_files.hpp"

namespace facezip::registration {

/// The scans of a folder: files are named, not read.
struct ScanFolder {
  std::filesystem::path neutral;                   ///< mesh of the neutral
  std::vector<std::filesystem::path> expressions;  ///< N meshes, by name; may be empty
  std::filesystem::path landmark_file;
  ScanLandmarks landmarks;
};

/// Finds NAME.obj, NAME.ply, NAME.glb and NAME.fbx in DIR/scans, or in DIR itself, and reads DIR/landmarks.json, or
/// `landmarks` where that is not empty. Throws InputError: no directory, no neutral, names that a
/// capture cannot hold, no landmarks.
ScanFolder openScans(const std::filesystem::path& directory, const std::filesystem::path& landmarks);

/// The same without landmarks.
ScanFolder findScans(const std::filesystem::path& directory);

/// A scan, cleaned.
struct Scan {
  std::string name;
  std::filesystem::path file;
  geometry::TriangleMesh mesh;                  ///< with UVs; in the unit of the file
  std::vector<int> materials;                   ///< #T, index into textures
  std::vector<std::filesystem::path> textures;  ///< images; empty for materials that no triangle has
  Eigen::MatrixX3f colours;                     ///< where there are no textures: of vertices as they were read, 0..1
  Eigen::MatrixX3i colour_triangles;            ///< #T by 3, indices into colours
  geometry::ScanCleaning cleaning;
  std::unique_ptr<io::ScratchDirectory> pictures;  ///< where textures that were in the mesh's file lie; may be null

  bool isPainted() const { return colours.rows() > 0; }
};

/// The mesh alone, as it stands in the file. Throws InputError.
geometry::TriangleMesh readScanMesh(const std::filesystem::path& file);

/// Reads a scan, OBJ, PLY, binary glTF or FBX, with the textures of its materials; where they have none, NAME.png (or
/// another image) beside it, else the colours of its vertices. Throws InputError: a material without a texture that
/// triangles have, textures without UVs, nothing but crumbs.
Scan readScan(const std::filesystem::path& file);

/// Turns its triangles about.
void turnAbout(Scan& scan);

}  // namespace facezip::registration
