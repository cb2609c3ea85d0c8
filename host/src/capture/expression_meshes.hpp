// expression_meshes.hpp - which OBJ files of a capture are the meshes of its expressions.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "facezip/progress.hpp"

namespace facezip {

/// The mesh of each expression, by its name; an empty path where there is none. Those that capture.json names go first,
/// then expressions/NAME.obj. Where neither gives any, the one folder of the capture whose OBJ files have the names of
/// expressions; not where it holds a neutral of its own, as a template does, beside the capture's.
/// named     of capture.json: expression to file, relative to the capture; known expressions, files need not be there
/// progress  notes where meshes were found, those that match no expression, expressions that have none, and where no
///           mesh is taken at all: the package will have nothing that moves. May be null
/// Throws InputError for a folder that cannot be read, and for two meshes of one expression.
std::vector<std::filesystem::path> findExpressionMeshes(const std::filesystem::path& capture,
                                                        const std::map<std::string, std::string>& named,
                                                        const std::vector<std::string>& expressions,
                                                        Progress* progress);

}  // namespace facezip
