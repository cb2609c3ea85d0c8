// package_mesh.hpp - mesh.glb as a package may hold it (docs/package_format.md): a small part of glTF, and nothing that
// leads out of the file. Engines and web pages open what exports make of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "facezip/package.hpp"

namespace facezip::mesh {

inline constexpr std::uintmax_t kMostMeshBytes = (std::uintmax_t{1} << 31) - 1;
inline constexpr std::size_t kMostTargets = 1 << 14;
/// Morph targets times vertices: loaders make whole arrays of sparse ones.
inline constexpr std::size_t kMostMovedVertices = std::size_t{1} << 28;

/// A mesh that keeps the rules.
struct PackageMesh {
  nlohmann::json document;                  ///< glTF: only what the rules know of, all references in range
  std::shared_ptr<const std::string> file;  ///< as it was read
  std::span<const std::byte> buffer;        ///< its one buffer, within the file
  std::size_t vertices = 0;                 ///< of all primitives
  std::size_t targets = 0;
};

/// Checks a binary glTF file wholly: its structure, every range, every index and every float.
/// glb  of strangers. file  path for messages
/// Throws InputError that names `file`, the field as a JSON path, what was expected and what was found.
PackageMesh parsePackageMesh(std::string glb, const std::string& file);

/// Reads and checks the mesh of a package that has one. Throws InputError, where that needs more memory, too.
PackageMesh readPackageMesh(const Package& package, std::uint64_t memory_bytes);

/// Reads and checks the parts of a package that has some: a mesh of a primitive for each material, whose morph targets
/// are named as those of `mesh`, the package's. Throws InputError as readPackageMesh().
PackageMesh readPackageParts(const Package& package, const PackageMesh& mesh, std::uint64_t memory_bytes);

/// The same of a file's bytes.
PackageMesh parsePackageParts(std::string glb, const std::string& file, const PackageParts& parts,
                              const PackageMesh& mesh);

/// A material of glTF, without its texture.
nlohmann::json materialJson(const PackageMaterial& material);

/// The mesh as a binary glTF file of our own making: for readers that trust what they read.
std::string packageMeshFile(const PackageMesh& mesh);

}  // namespace facezip::mesh
