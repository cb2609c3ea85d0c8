#include "register/scan_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "facezip/error.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/textured_mesh.hpp"
#include "image/input_extensions.hpp"
#include "io/safe_names.hpp"
#include "register/glb_scan.hpp"
#include "scene/fbx_scene.hpp"

namespace facezip::registration {
namespace fs = std::filesystem;
namespace {

constexpr const char* kNeutral = "neutral";

fs::path meshFolder(const fs::path& directory) {
  std::error_code error;
  if (!fs::is_directory(directory, error)) {
    throw InputError({directory.string(), "scans",
                      "a directory with neutral.obj (or .ply, .glb, .fbx) and a mesh for each expression",
                      fs::exists(directory, error) ? "a file" : "no such directory", ""});
  }
  return fs::is_directory(directory / "scans", error) ? directory / "scans" : directory;
}

std::string extensionOf(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool isGlb(const fs::path& file) { return extensionOf(file) == ".glb"; }
bool isPly(const fs::path& file) { return extensionOf(file) == ".ply"; }
bool isFbx(const fs::path& file) { return extensionOf(file) == ".fbx"; }
bool isHidden(const fs::path& file) { return file.filename().string().front() == '.'; }

/// Its materials name textures anywhere: the image beside the scan is its texture.
geometry::TexturedMesh readFbxScan(const fs::path& file) {
  geometry::TexturedMesh scan = joinedMeshes(scene::readFbx(file), file);
  std::ranges::fill(scan.materials, 0);
  scan.textures.resize(1);
  return scan;
}

geometry::TexturedMesh readTextured(const fs::path& file) {
  if (isFbx(file)) return readFbxScan(file);
  return isPly(file) ? geometry::readTexturedPly(file) : geometry::readTexturedObj(file);
}

/// Meshes of the folder by name.
std::vector<fs::path> scansOf(const fs::path& folder) {
  std::vector<fs::path> files = geometry::objFiles(folder);
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    const fs::path& file = entry->path();
    if (!isHidden(file) && (isGlb(file) || isPly(file) || isFbx(file))) files.push_back(file);
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) { return a.stem() < b.stem(); });
  for (std::size_t i = 1; i < files.size(); ++i) {
    if (files[i].stem() != files[i - 1].stem()) continue;
    throw InputError({folder.string(), "scans", "one mesh of a name",
                      files[i - 1].filename().string() + " and " + files[i].filename().string(), "remove one"});
  }
  return files;
}

/// The image beside the mesh that has its name. Empty if there is none.
fs::path imageBeside(const fs::path& mesh) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(mesh.parent_path(), error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (entry->path().stem() == mesh.stem() && image::hasImageExtension(entry->path())) found.push_back(entry->path());
  }
  return found.empty() ? fs::path() : *std::min_element(found.begin(), found.end());
}

void requireUvs(const Scan& scan) {
  if (scan.mesh.uv_triangles.rows() > 0) return;
  throw InputError({scan.file.string(), "", "texture coordinates, or colours of vertices", "neither",
                    "export the scan with its UVs"});
}

/// Materials that triangles have get a texture each; the others none. Without any, vertices may have colours.
/// colours  of the vertices before cleaning, whose triangles are `triangles`; kept: rows of these
void requireTextures(Scan& scan, Eigen::MatrixX3f colours, const Eigen::MatrixX3i& triangles,
                     const std::vector<int>& kept) {
  std::vector<bool> used(scan.textures.size(), false);
  for (const int material : scan.materials) used[static_cast<std::size_t>(material)] = true;
  const bool none =
      std::all_of(scan.textures.begin(), scan.textures.end(), [](const fs::path& f) { return f.empty(); });
  const fs::path beside = none ? imageBeside(scan.file) : fs::path();
  if (none && colours.rows() > 0 && (beside.empty() || scan.mesh.uv_triangles.rows() == 0)) {
    scan.colours = std::move(colours);
    scan.colour_triangles = triangles(kept, Eigen::all);
    return;
  }
  requireUvs(scan);
  for (std::size_t m = 0; m < scan.textures.size(); ++m) {
    if (!used[m]) {
      scan.textures[m].clear();
    } else if (scan.textures[m].empty()) {
      scan.textures[m] = beside;
    }
    if (!used[m] || !scan.textures[m].empty()) continue;
    throw InputError({scan.file.string(), "",
                      "a texture: of its material (map_Kd, TextureFile, baseColorTexture), or an image of the scan's "
                      "name beside it; or colours of vertices",
                      none ? "none" : "triangles of a material without one", ""});
  }
}

}  // namespace

ScanFolder findScans(const fs::path& directory) {
  ScanFolder found;
  const fs::path folder = meshFolder(directory);
  for (const fs::path& file : scansOf(folder)) {
    const std::string name = file.stem().string();
    if (name == kNeutral) {
      found.neutral = file;
      continue;
    }
    if (const auto fault = io::nameFault(name, ",=")) {
      throw InputError({file.string(), "scan", fault->expected, fault->got, "rename the file"});
    }
    found.expressions.push_back(file);
  }
  if (found.neutral.empty())
    throw InputError({folder.string(), "scans", "neutral.obj (or .ply, .glb, .fbx)", "none", "name the neutral so"});
  return found;
}

ScanFolder openScans(const fs::path& directory, const fs::path& landmarks) {
  ScanFolder found = findScans(directory);
  found.landmark_file = landmarks.empty() ? directory / "landmarks.json" : landmarks;
  found.landmarks = readScanLandmarks(found.landmark_file);
  return found;
}

geometry::TriangleMesh readScanMesh(const fs::path& file) {
  return isGlb(file) ? readGlbScan(file).textured.mesh : readTextured(file).mesh;
}

Scan readScan(const fs::path& file) {
  GlbScan glb;
  if (isGlb(file)) glb = readGlbScan(file);
  geometry::TexturedMesh read = isGlb(file) ? std::move(glb.textured) : readTextured(file);
  Scan scan;
  scan.pictures = std::move(glb.pictures);
  scan.name = file.stem().string();
  scan.file = file;
  const Eigen::MatrixX3i triangles = read.mesh.triangles;
  scan.mesh = std::move(read.mesh);
  std::vector<int> kept;
  try {
    scan.cleaning = geometry::cleanScan(scan.mesh, &kept);
  } catch (const InputError& error) {
    throw error.in(file.string());
  }
  for (const int triangle : kept) scan.materials.push_back(read.materials[static_cast<std::size_t>(triangle)]);
  scan.textures = std::move(read.textures);
  requireTextures(scan, std::move(read.colours), triangles, kept);
  return scan;
}

void turnAbout(Scan& scan) {
  scan.mesh.triangles.col(1).swap(scan.mesh.triangles.col(2));
  if (scan.mesh.uv_triangles.rows() > 0) scan.mesh.uv_triangles.col(1).swap(scan.mesh.uv_triangles.col(2));
  if (scan.isPainted()) scan.colour_triangles.col(1).swap(scan.colour_triangles.col(2));
}

}  // namespace facezip::registration
