// expression_meshes.hpp - which OBJ files of a capture are the meshes of its expressions.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "capture/capture_json.hpp"
#include "facezip/capture.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// The mesh of each expression, by its name; an empty path where there is none. Those that capture.json names go first,
/// then NAME.obj in the folder that it names, or in expressions/. Where neither gives any, the one folder of the
/// capture whose OBJ files have the names of expressions; not where it holds a neutral of its own, as a template does,
/// beside the capture's. description  its expression_meshes are of known expressions; files need not be there progress
/// notes where meshes were found, those that match no expression, expressions that have none, and where no
///           mesh is taken at all: the package will have nothing that moves. May be null
/// Throws InputError for a folder that cannot be read or that capture.json names and has no meshes, and for two meshes
/// of one expression.
std::vector<std::filesystem::path> findExpressionMeshes(const std::filesystem::path& capture,
                                                        const CaptureJson& description,
                                                        const std::vector<std::string>& expressions,
                                                        Progress* progress);

/// The same where the neutral's file has morph targets: that file for each expression that one is named after, and what
/// capture.json names for others. progress  as above; may be null
/// Throws InputError for a file that cannot be read.
std::vector<std::filesystem::path> findMorphTargets(const Capture& capture, const CaptureJson& description,
                                                    Progress* progress);

}  // namespace facezip
