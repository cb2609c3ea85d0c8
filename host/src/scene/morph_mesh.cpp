#include "scene/morph_mesh.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <numeric>

#include "facezip/error.hpp"
#include "io/composed.hpp"
#include "io/counts.hpp"
#include "io/quoted.hpp"
#include "scene/fbx_scene.hpp"
#include "scene/glb_scene.hpp"

namespace facezip::scene {
namespace {
namespace fs = std::filesystem;

std::string extensionOf(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

std::vector<SceneMesh> readMeshes(const fs::path& file) {
  if (extensionOf(file) == ".fbx") return readFbx(file);
  return meshesOf(GlbFile(file, "meshes of a capture"));
}

/// Appends a part of the same mesh: another material's.
void append(const SceneMesh& part, SceneMesh& mesh) {
  const auto first = static_cast<int>(mesh.positions.size());
  const int face = mesh.polygons.empty() ? 0 : mesh.polygons.back() + 1;
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
  for (const Eigen::RowVector3i& triangle : part.triangles) mesh.triangles.emplace_back(triangle.array() + first);
  for (const int polygon : part.polygons) mesh.polygons.push_back(face + polygon);
  for (std::size_t s = 0; s < part.shapes.size(); ++s) {
    std::vector<Eigen::RowVector3d>& offsets = mesh.shapes[s].offsets;
    offsets.insert(offsets.end(), part.shapes[s].offsets.begin(), part.shapes[s].offsets.end());
  }
}

/// Meshes of one name that have the same shapes are parts of one: FBX is read material by material.
std::vector<SceneMesh> joined(std::vector<SceneMesh> parts) {
  std::vector<SceneMesh> meshes;
  for (SceneMesh& part : parts) {
    const auto same = std::ranges::find_if(meshes, [&](const SceneMesh& mesh) {
      return mesh.name == part.name && mesh.uvs.empty() == part.uvs.empty() &&
             std::ranges::equal(mesh.shapes, part.shapes, {}, &SceneShape::name, &SceneShape::name);
    });
    if (same == meshes.end()) {
      meshes.push_back(std::move(part));
    } else {
      append(part, *same);
    }
  }
  return meshes;
}

std::string namesOf(const std::vector<SceneMesh>& meshes) {
  std::vector<std::string> names;
  for (const SceneMesh& mesh : meshes) names.push_back(io::quoted(mesh.name));
  return fmt::format("{}", fmt::join(names, ", "));
}

SceneMesh chosen(std::vector<SceneMesh> meshes, const std::string& name, const fs::path& file, std::string& note) {
  const bool any = !name.empty() || std::ranges::all_of(meshes, [](const auto& mesh) { return mesh.shapes.empty(); });
  std::vector<SceneMesh> fitting;
  for (const SceneMesh& mesh : meshes) {
    if (name.empty() ? any || !mesh.shapes.empty() : io::composed(mesh.name) == name) fitting.push_back(mesh);
  }
  if (fitting.empty()) {
    throw InputError({file.string(), "mesh", fmt::format("one of {}", namesOf(meshes)), io::quoted(name), ""});
  }
  const auto most = std::ranges::max_element(fitting, {}, [](const SceneMesh& mesh) { return mesh.triangles.size(); });
  if (fitting.size() > 1) {
    note = fmt::format("{}: mesh {} is taken, of {}; \"mesh\" in capture.json chooses", file.string(),
                       io::quoted(most->name), namesOf(fitting));
  }
  return std::move(*most);
}

bool isLess(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// The first vertex that lies where each one does and moves as it does: lips touch, and part.
std::vector<int> vertexFor(const SceneMesh& mesh) {
  std::vector<int> order(mesh.positions.size()), first(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto less = [&](int a, int b) {
    const Eigen::RowVector3d &p = mesh.positions[toSize(a)], &q = mesh.positions[toSize(b)];
    if (p != q) return isLess(p, q);
    for (const SceneShape& shape : mesh.shapes) {
      const Eigen::RowVector3d &s = shape.offsets[toSize(a)], &t = shape.offsets[toSize(b)];
      if (s != t) return isLess(s, t);
    }
    return false;
  };
  std::ranges::sort(order, [&](int a, int b) { return less(a, b) || (!less(b, a) && a < b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && !less(order[i - 1], order[i]);
    first[toSize(order[i])] = same ? first[toSize(order[i - 1])] : order[i];
  }
  return first;
}

std::vector<int> uvFor(const SceneMesh& mesh) {
  std::vector<int> order(mesh.uvs.size()), first(mesh.uvs.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const Eigen::RowVector2d& uv = mesh.uvs[toSize(i)];
    return std::make_tuple(uv.x(), uv.y(), i);
  };
  std::ranges::sort(order, {}, key);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && mesh.uvs[toSize(order[i])] == mesh.uvs[toSize(order[i - 1])];
    first[toSize(order[i])] = same ? first[toSize(order[i - 1])] : order[i];
  }
  return first;
}

/// New numbers, in the order of the file, for those that stand for themselves; `kept` receives the old ones.
std::vector<int> renumbered(const std::vector<int>& first, std::vector<int>& kept) {
  std::vector<int> numbers(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == static_cast<int>(i)) {
      numbers[i] = static_cast<int>(kept.size());
      kept.push_back(first[i]);
    }
  }
  for (std::size_t i = 0; i < first.size(); ++i) numbers[i] = numbers[toSize(first[i])];
  return numbers;
}

template <typename Matrix, typename Row>
Matrix rowsOf(const std::vector<Row>& rows, const std::vector<int>& kept) {
  Matrix matrix(static_cast<Eigen::Index>(kept.size()), Row::ColsAtCompileTime);
  for (std::size_t i = 0; i < kept.size(); ++i) matrix.row(static_cast<Eigen::Index>(i)) = rows[toSize(kept[i])];
  return matrix;
}

Eigen::MatrixX3i cornersOf(const SceneMesh& mesh, const std::vector<int>& numbers) {
  Eigen::MatrixX3i corners(static_cast<Eigen::Index>(mesh.triangles.size()), 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) corners(static_cast<Eigen::Index>(t), k) = numbers[toSize(mesh.triangles[t][k])];
  }
  return corners;
}

/// How long the beginning is that names share, up to what parts a node's name from a shape's.
std::size_t sharedBeginning(const std::vector<SceneShape>& shapes) {
  if (shapes.size() < 2) return 0;
  std::string shared = shapes.front().name;
  for (const SceneShape& shape : shapes) {
    const auto [end, other] = std::ranges::mismatch(shared, shape.name);
    shared.erase(end, shared.end());
  }
  const std::size_t mark = shared.find_last_of(".:|"), lines = shared.rfind("__");
  return std::max(mark == std::string::npos ? 0 : mark + 1, lines == std::string::npos ? 0 : lines + 2);
}

}  // namespace

bool isSceneFile(const fs::path& file) {
  const std::string extension = extensionOf(file);
  return extension == ".glb" || extension == ".fbx";
}

fs::path sceneFileIn(const fs::path& directory, const std::string& cure) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    const fs::path& file = entry->path();
    if (file.filename().string().front() != '.' && isSceneFile(file)) found.push_back(file);
  }
  std::ranges::sort(found);
  if (found.size() < 2) return found.empty() ? fs::path() : found.front();
  throw InputError({directory.string(), "meshes", "one GLB or FBX file",
                    fmt::format("{} and {}", found[0].filename().string(), found[1].filename().string()), cure});
}

MorphMesh readMorphMesh(const fs::path& file, const std::string& name) {
  MorphMesh morphs;
  const SceneMesh mesh = chosen(joined(readMeshes(file)), name, file, morphs.note);
  if (mesh.uvs.empty()) {
    throw InputError({file.string(), "mesh " + io::quoted(mesh.name), "texture coordinates", "none", ""});
  }
  morphs.name = mesh.name;
  std::vector<int> vertices, uvs;
  const std::vector<int> vertex_of = renumbered(vertexFor(mesh), vertices), uv_of = renumbered(uvFor(mesh), uvs);
  morphs.neutral.positions = rowsOf<Eigen::MatrixX3d>(mesh.positions, vertices);
  morphs.neutral.uvs = rowsOf<Eigen::MatrixX2d>(mesh.uvs, uvs);
  morphs.neutral.triangles = cornersOf(mesh, vertex_of);
  morphs.neutral.uv_triangles = cornersOf(mesh, uv_of);
  morphs.neutral.polygons = mesh.polygons;
  const std::size_t shared = sharedBeginning(mesh.shapes);
  for (const SceneShape& shape : mesh.shapes) {
    const std::string shape_name = io::composed(shape.name.substr(shared));
    if (shape_name.empty()) {
      throw InputError({file.string(), "mesh " + io::quoted(mesh.name), "a name of every morph target", "one without",
                        "export names (mesh.extras.targetNames in glTF)"});
    }
    const auto [it, is_new] = morphs.positions.emplace(
        shape_name, morphs.neutral.positions + rowsOf<Eigen::MatrixX3d>(shape.offsets, vertices));
    if (is_new) continue;
    throw InputError({file.string(), "morph target", "each name once", io::quoted(shape_name) + " twice", ""});
  }
  return morphs;
}

}  // namespace facezip::scene
