// capture.hpp - a capture on disk: a neutral and N expressions, each with its own textures, in one mesh and UV layout.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "facezip/error.hpp"
#include "facezip/progress.hpp"
#include "facezip/protected_paths.hpp"

namespace facezip {

/// One kind of texture (albedo, normal, ...) of every face of a capture.
struct CaptureMap {
  std::string name;
  std::string colour_space;                        ///< "sRGB", "linear" or "" (not known); carried into the package
  double metric_weight = 1.0;                      ///< how much an error of this map counts beside the others', >= 0
  std::filesystem::path neutral;                   ///< image of the neutral
  std::vector<std::filesystem::path> expressions;  ///< N images, in the order of Capture::expressions
};

/// UDIM: tile 1001 + 10 row + column holds the UVs of [column, column + 1] by [row, row + 1].
inline constexpr int kFirstTile = 1001;
inline constexpr int kTilesInRow = 10;

/// What a capture directory holds. Files are named, not read; their content is checked where it is used.
struct Capture {
  std::string name;
  std::filesystem::path directory;
  std::filesystem::path neutral_mesh;    ///< an OBJ file, or GLB or FBX with morph targets
  std::string mesh_name;                 ///< in a GLB or FBX file; "": whichever has morph targets
  std::vector<std::string> expressions;  ///< N unique names
  /// N paths, empty where an expression has no mesh; neutral_mesh itself where that has a morph target of its name
  std::vector<std::filesystem::path> expression_meshes;
  std::vector<CaptureMap> maps;                      ///< at least one
  std::optional<int> tile;                           ///< of UDIM, where textures name tiles
  std::string unit;                                  ///< of the meshes' coordinates as written, "" if not stated
  std::optional<std::filesystem::path> face_region;  ///< triangle indices of the part that changes
  std::optional<std::filesystem::path> coverage;     ///< or a painted image of it
  std::optional<std::filesystem::path> importance;   ///< painted image of where errors matter more
};

/// Whether a capture may be a neutral alone.
enum class NeutralAlone { kRefused, kAllowed };

/// Finds what is in `directory` (layout in docs/capture_format.md). capture.json, where present, decides; what it
/// leaves out is found by name: MAP/neutral.EXT and MAP/NAME.EXT for textures (NAME.1001.EXT where they are tiles),
/// neutral.obj, expressions/NAME.obj, or else one GLB or FBX file with morph targets,
/// face_region.txt, coverage.png, importance.png. Expressions come in the order of capture.json, else by name.
/// map_names  maps to take, in this order; empty: all
/// progress   notes where meshes of expressions were found if not in expressions/, OBJ files that match no expression,
///            expressions without a mesh where others have one, and that there is no mesh at all; may be null
/// neutral_alone  whether there may be no expression (N = 0)
/// Throws InputError: no directory, one that cannot be read, no neutral mesh, no map, a map without neutral, an
/// expression that one map has and another lacks, textures of several tiles of which none is chosen, two expressions
/// with the same name, no expression, a name that a package cannot hold, malformed capture.json.
Capture openCapture(const std::filesystem::path& directory, const std::vector<std::string>& map_names = {},
                    Progress* progress = nullptr, NeutralAlone neutral_alone = NeutralAlone::kRefused);

/// The capture's directory and every file that it names, wherever that lies.
ProtectedPaths inputsOf(const Capture& capture);

}  // namespace facezip
