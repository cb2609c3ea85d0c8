// obj_io.hpp - Wavefront OBJ files in and out.
#pragma once

#include <filesystem>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::geometry {

/// Reads the positions, texture coordinates and faces of an OBJ file.
/// Vertices keep the order of the file; several objects or groups are one mesh, in file order. Polygons become triangle
/// fans (a b c), (a c d), ... in the order of the file, so that files with the same faces give the same triangles:
/// quad q of an all-quad file is triangles 2q and 2q + 1. Normals, materials, lines and points are skipped.
/// Faces either all have texture coordinates or none has (then uvs and uv_triangles have 0 rows).
/// Throws InputError with the file and the line: missing or unreadable file, no regular one, one of more than 2 GiB; no
/// vertices or no faces; a coordinate that is missing or not a finite number; a face of fewer than three corners; an
/// index out of range; mixed faces.
TriangleMesh readObj(const std::filesystem::path& file);

/// The OBJ files of a folder by name, ".obj" in any case; hidden files are left out. What has such a name and is no
/// file (a folder, a pipe, a link that leads nowhere) is among them, for readObj() to refuse: left out, an expression
/// would be missing. Throws InputError for a folder that cannot be read and for two files that differ in the case of
/// the extension alone.
std::vector<std::filesystem::path> objFiles(const std::filesystem::path& folder);

/// Writes v, vt and f lines (f v/vt, or f v without uvs) with the shortest decimals that give back the same doubles.
/// An existing file is overwritten. Throws OutputError if the file cannot be opened or the disk does not take it all.
void writeObj(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace facezip::geometry
