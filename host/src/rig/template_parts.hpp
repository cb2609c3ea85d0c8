// template_parts.hpp - what a template has beyond the captured skin: eyes, teeth, lashes, with names and materials.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "facezip/package.hpp"
#include "image/image_file.hpp"

namespace facezip::rig {

/// A part: one name, one material.
struct TemplatePart {
  PackageMaterial material;  ///< its name is the part's; the texture's file is named when it is written
  image::Image texture;      ///< of 8 bits; no samples where there is none
};

struct TemplateParts {
  std::vector<TemplatePart> parts;
  std::vector<int> of_triangle;  ///< of each triangle beyond the skin, index into parts

  bool empty() const { return parts.empty(); }
};

/// Reads the parts of a template. They are called as the file's materials, or its groups where it has none
/// (geometry::readNamedObj()); in a file without either, as its known topology has them, or else "parts". They look as
/// their material says, with `parts/NAME.png` beside the template for a texture where it names none, and for the rest
/// as lookOf() their name.
/// neutral_file  the template's neutral, `whole` what it holds
/// skin          its first vertices and triangles
/// Throws InputError: a texture that cannot be read, is larger than 8192 texels a side or not of 8 bits.
TemplateParts readTemplateParts(const std::filesystem::path& neutral_file, const geometry::TriangleMesh& whole,
                                const geometry::TriangleMesh& skin);

/// What is placed as one, and what bends with the skin: geometry::PartProblem's groups.
struct PartGroups {
  std::vector<int> of_vertex;  ///< beyond the skin
  std::vector<bool> on_skin;
};

/// whole  the template's neutral. skin  number of its vertices that are skin, and of its triangles
PartGroups groupParts(const TemplateParts& parts, const geometry::TriangleMesh& whole, Eigen::Index skin_vertices,
                      Eigen::Index skin_triangles);

}  // namespace facezip::rig
