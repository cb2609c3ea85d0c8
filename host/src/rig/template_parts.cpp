#include "rig/template_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/named_obj.hpp"
#include "facezip/geometry/part_transfer.hpp"
#include "io/safe_names.hpp"
#include "package/guides.hpp"
#include "rig/part_looks.hpp"

namespace facezip::rig {
namespace fs = std::filesystem;
namespace {

constexpr int kMostTextureSide = 8192;
/// Pieces of eyes nearer than this share of the head's diagonal are of one eye.
constexpr double kOneEye = 0.05;
/// A part without a name that lies nearer to the skin than this share of the diagonal lies on it.
constexpr double kOnSkin = 0.008;

image::Image readTexture(const fs::path& file) {
  image::ImageReader reader(file);
  const image::ImageShape shape = reader.shape();
  if (shape.width > kMostTextureSide || shape.height > kMostTextureSide || shape.channels > 4 ||
      shape.type != SampleType::kUint8) {
    throw InputError({file.string(), "texture of a part",
                      fmt::format("8 bits, 1 to 4 channels, at most {0} x {0}", kMostTextureSide),
                      fmt::format("{}, {} channels, {} x {}", image::sampleTypeName(shape.type), shape.channels,
                                  shape.width, shape.height),
                      "export it anew"});
  }
  return image::readImage(std::move(reader));
}

/// What a material library says; linear or not, its colours are taken as light.
void takeMaterial(const geometry::ObjMaterial& said, PackageMaterial& material) {
  const bool colours = said.texture.empty() && std::ranges::any_of(said.colour, [](double c) { return c > 0.0; });
  if (colours) material.colour = said.colour;
  if (said.opacity >= 1.0) return;
  material.opacity = said.opacity;
  material.alpha = PackageMaterial::Alpha::kBlend;
}

/// Names of the triangles beyond the skin, by a file that has names or a topology that is known.
class PartNames {
 public:
  PartNames(const geometry::NamedMesh& named, Eigen::Index vertices) : named_(named) {
    const bool has_names = named.names.size() > 1 || !named.names.front().empty();
    if (!has_names) known_ = knownParts(static_cast<int>(vertices));
  }

  std::string of(Eigen::Index triangle) const {
    const int vertex = named_.mesh.triangles.row(triangle).maxCoeff();
    for (const KnownPart& part : known_) {
      if (vertex >= part.first && vertex <= part.last) return part.name;
    }
    return named_.names[static_cast<std::size_t>(index(triangle))];
  }
  const std::optional<geometry::ObjMaterial>& material(Eigen::Index triangle) const {
    return named_.materials[static_cast<std::size_t>(index(triangle))];
  }

 private:
  int index(Eigen::Index triangle) const { return named_.of_triangle[static_cast<std::size_t>(triangle)]; }

  const geometry::NamedMesh& named_;
  std::vector<KnownPart> known_;
};

TemplatePart makePart(const std::string& name, const std::optional<geometry::ObjMaterial>& said,
                      const fs::path& folder) {
  TemplatePart part;
  part.material = lookOf(name).material;
  part.material.name = name;
  if (said) takeMaterial(*said, part.material);
  fs::path texture = said ? said->texture : fs::path();
  std::error_code error;
  const fs::path beside = folder / "parts" / (name + ".png");
  if (texture.empty() && fs::is_regular_file(beside, error)) texture = beside;
  if (texture.empty()) return part;
  part.texture = readTexture(texture);
  part.material.colour = {1, 1, 1};  // the texture's
  const bool has_alpha = part.texture.shape.channels % 2 == 0;
  if (has_alpha && part.material.alpha == PackageMaterial::Alpha::kOpaque) {
    part.material.alpha = PackageMaterial::Alpha::kMask;
  }
  return part;
}

/// A name that files may have; `count` are there already.
std::string safeName(const std::string& name, std::size_t count) {
  if (name.empty()) return "parts";
  return io::nameFault(name, ",=:") ? fmt::format("part_{}", count + 1) : name;
}

}  // namespace

TemplateParts readTemplateParts(const fs::path& neutral_file, const geometry::TriangleMesh& whole,
                                const geometry::TriangleMesh& skin) {
  TemplateParts found;
  if (whole.triangles.rows() == skin.triangles.rows()) return found;
  const geometry::NamedMesh named = geometry::readNamedObj(neutral_file);
  const PartNames names(named, whole.positions.rows());
  std::map<std::string, int> index;
  for (Eigen::Index t = skin.triangles.rows(); t < whole.triangles.rows(); ++t) {
    const std::string said = names.of(t);
    const auto [it, is_new] = index.emplace(said, static_cast<int>(found.parts.size()));
    if (is_new) {
      if (found.parts.size() == package::kMostParts) {
        throw InputError({neutral_file.string(), "parts", fmt::format("at most {} materials", package::kMostParts),
                          "more", "join some"});
      }
      found.parts.push_back(
          makePart(safeName(said, found.parts.size()), names.material(t), neutral_file.parent_path()));
    }
    found.of_triangle.push_back(it->second);
  }
  return found;
}

namespace {

/// Gives the connected pieces of a template their groups, one after the other.
class Grouping {
 public:
  Grouping(const TemplateParts& parts, const geometry::TriangleMesh& whole, Eigen::Index skin_vertices,
           Eigen::Index skin_triangles)
      : positions_(whole.positions),
        skin_(skin_vertices),
        piece_of_(geometry::connectedParts(skin_vertices, whole.positions.rows(), whole.triangles)),
        diagonal_(geometry::boundingDiagonal(whole.positions.topRows(skin_vertices))) {
    for (std::size_t i = 0; i < piece_of_.size(); ++i) {
      const auto piece = static_cast<std::size_t>(piece_of_[i]);
      if (piece >= vertices_.size()) vertices_.resize(piece + 1);
      vertices_[piece].push_back(skin_vertices + static_cast<Eigen::Index>(i));
    }
    part_of_.assign(vertices_.size(), -1);
    for (std::size_t i = 0; i < parts.of_triangle.size(); ++i) {
      const Eigen::Index t = skin_triangles + static_cast<Eigen::Index>(i);
      const Eigen::Index v = whole.triangles.row(t).maxCoeff() - skin_vertices;
      part_of_[static_cast<std::size_t>(piece_of_[static_cast<std::size_t>(v)])] = parts.of_triangle[i];
    }
  }

  PartGroups run(const TemplateParts& parts) {
    std::vector<int> group_of(vertices_.size());
    for (std::size_t piece = 0; piece < vertices_.size(); ++piece) {
      const int part = part_of_[piece];
      const PartLook look = part < 0 ? PartLook() : lookOf(parts.parts[static_cast<std::size_t>(part)].material.name);
      group_of[piece] = groupOf(piece, look);
    }
    for (const int piece : piece_of_) groups_.of_vertex.push_back(group_of[static_cast<std::size_t>(piece)]);
    return std::move(groups_);
  }

 private:
  int add(bool on_skin) {
    groups_.on_skin.push_back(on_skin);
    return static_cast<int>(groups_.on_skin.size()) - 1;
  }

  int groupOf(std::size_t piece, const PartLook& look) {
    switch (look.place) {
      case PartPlace::kMouth:
        if (mouth_ < 0) mouth_ = add(false);
        return mouth_;
      case PartPlace::kEye:
        return eyeOf(piece);
      case PartPlace::kSkin:
        return add(true);
      case PartPlace::kAlone:
        break;
    }
    return add(liesOnSkin(piece));
  }

  int eyeOf(std::size_t piece) {
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (const Eigen::Index v : vertices_[piece]) centre += positions_.row(v);
    centre /= static_cast<double>(vertices_[piece].size());
    for (const auto& [group, other] : eyes_) {
      if ((centre - other).norm() < kOneEye * diagonal_) return group;
    }
    eyes_.emplace_back(add(false), centre);
    return eyes_.back().first;
  }

  bool liesOnSkin(std::size_t piece) {
    if (distances_.size() == 0) distances_ = geometry::distancesToSkin(skin_, positions_);
    std::vector<double> of_piece;
    for (const Eigen::Index v : vertices_[piece]) of_piece.push_back(distances_[v - skin_]);
    const auto middle = of_piece.begin() + std::ssize(of_piece) / 2;
    std::nth_element(of_piece.begin(), middle, of_piece.end());
    return *middle < kOnSkin * diagonal_;
  }

  const Eigen::MatrixX3d& positions_;
  Eigen::Index skin_;
  std::vector<int> piece_of_;
  double diagonal_;
  std::vector<std::vector<Eigen::Index>> vertices_;  ///< of each piece
  std::vector<int> part_of_;                         ///< of each piece; -1: without triangles
  PartGroups groups_;
  int mouth_ = -1;
  std::vector<std::pair<int, Eigen::RowVector3d>> eyes_;
  Eigen::VectorXd distances_;
};

}  // namespace

PartGroups groupParts(const TemplateParts& parts, const geometry::TriangleMesh& whole, Eigen::Index skin_vertices,
                      Eigen::Index skin_triangles) {
  return Grouping(parts, whole, skin_vertices, skin_triangles).run(parts);
}

}  // namespace facezip::rig
