// obj_io.cpp - Wavefront OBJ through tinyobjloader, in double precision.
// tinyobjloader reads leniently: "v nan 1 2" is 0 1 2, a missing number is 0, a missing corner drops the face, index
// 4294967297 is 1. A scan of the lines comes first, which refuses those and remembers the lines, so that every message
// can name one.
#include "facezip/geometry/obj_io.hpp"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "facezip/error.hpp"
#include "facezip/geometry/named_obj.hpp"
#include "facezip/geometry/textured_mesh.hpp"
#include "facezip/input_file.hpp"
#include "file_beside.hpp"

namespace facezip::geometry {
namespace {

bool isObj(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  // A name that starts with a dot is the desktop's or an unfinished copy, not a mesh.
  return extension == ".obj" && file.filename().string().front() != '.';
}

void requireUnique(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& files) {
  std::map<std::string, std::string> seen;
  for (const std::filesystem::path& file : files) {
    const std::string name = file.filename().string();
    const auto [it, inserted] = seen.emplace(file.stem().string(), name);
    if (inserted) continue;
    throw InputError({folder.string(), fmt::format("mesh \"{}\"", it->first), "one file",
                      fmt::format("{} and {}", it->second, name), "remove or rename one"});
  }
}

bool isBlank(char c) { return c == ' ' || c == '\t'; }
bool endsLine(char c) { return c == '\n' || c == '\r'; }

// Of a file: some 30 million vertices. Parsed, it takes several times as much memory.
constexpr std::uintmax_t kMostBytes = std::uintmax_t{2} << 30;
// Of a material library: far beyond what people write.
constexpr std::uintmax_t kMostLibraryBytes = std::uintmax_t{16} << 20;
// tinyobjloader counts the corners of a face in a byte.
constexpr int kMostCorners = 255;

// Where the parts of the file are: line numbers from 1, in file order.
struct ObjLines {
  std::vector<int> vertices;
  std::vector<int> uvs;
  std::vector<int> faces;
  bool faces_have_uvs = false;
  // Names that the faces from `first_face` on have, of materials and of objects and groups.
  struct Named {
    std::size_t first_face = 0;
    std::string name;
  };
  std::vector<Named> materials, groups;
};

[[noreturn]] void refuse(const std::filesystem::path& file, int line, const std::string& expected,
                         const std::string& got, const std::string& cure = "") {
  throw InputError({file.string(), "line " + std::to_string(line), expected, got, cure});
}

// Does the line hold numbers, so that no name in it can have a '#'?
bool isOfNumbers(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  return line.starts_with('v') || line.starts_with("f ") || line.starts_with("f\t");
}

// Drops a byte order mark and comments behind numbers, and joins each line that ends in a backslash with the next, but
// for comments, which may end in a path. As many empty lines follow what was joined: line numbers stay those of the
// file.
std::string plainLines(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  std::string plain;
  plain.reserve(text.size());
  std::size_t joined = 0;
  for (bool comment = false, numbers = false; !text.empty();) {
    const std::size_t length = std::min(text.find_first_of("\r\n"), text.size());
    std::string_view line = text.substr(0, length);
    if (joined == 0) {
      comment = line.starts_with('#');
      numbers = isOfNumbers(line);
    }
    if (numbers) line = line.substr(0, line.find('#'));
    text.remove_prefix(length);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(text.size(), 1));
    if (line.ends_with('\\') && !comment) {
      plain.append(line.substr(0, length - 1)).append(1, ' ');
      ++joined;
      continue;
    }
    plain.append(line).append(joined + 1, '\n');
    joined = 0;
  }
  return plain;
}

// Takes the next word off the line; empty at its end.
std::string_view nextWord(std::string_view& line) {
  const char* const begin = std::find_if_not(line.begin(), line.end(), isBlank);
  const char* const end = std::find_if(begin, line.end(), isBlank);
  line = {end, line.end()};
  return {begin, end};
}

std::string trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

// A decimal number as tinyobjloader understands it; whether it is finite shows after reading.
bool isNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool spelled_out = word.find_first_of("nN") != std::string_view::npos;  // nan, inf
  return end == word.data() + word.size() && error != std::errc::invalid_argument && !spelled_out;
}

// `count` numbers and what may follow them: weights, colours.
void checkNumbers(const std::filesystem::path& file, int line_number, std::string_view rest, int count) {
  for (int i = 0;; ++i) {
    const std::string_view word = nextWord(rest);
    if (word.empty() && i >= count) return;
    if (isNumber(word)) continue;
    refuse(file, line_number, fmt::format("{} finite numbers", count),
           word.empty() ? fmt::format("{}", i) : fmt::format("\"{}\"", word), "export the mesh again");
  }
}

// A whole number that an int holds, from 1 or, counted back from the last of `count`, from -1.
bool isIndex(std::string_view word, std::size_t count) {
  int index = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
  if (error != std::errc() || end != word.data() + word.size()) return false;
  return index > 0 || (index < 0 && static_cast<std::size_t>(-static_cast<long long>(index)) <= count);
}

// Checks the corner "v", "v/vt", "v//vn" or "v/vt/vn"; whether it has a texture coordinate. Normals are not read, and
// may be counted as they like.
bool scanCorner(const std::filesystem::path& file, int line_number, std::string_view corner, const ObjLines& lines) {
  constexpr std::size_t kAny = std::numeric_limits<int>::max();
  const std::size_t counts[] = {lines.vertices.size(), lines.uvs.size(), kAny};
  std::array<bool, 3> given = {};
  std::string_view rest = corner;
  for (std::size_t part = 0;; ++part) {
    const std::size_t slash = rest.find('/');
    const std::string_view index = rest.substr(0, slash);
    const bool good = part < given.size() && (index.empty() ? part > 0 : isIndex(index, counts[part]));
    if (!good) {
      refuse(file, line_number, "corners of whole indices such as 7, 7/8 or 7/8/9", fmt::format("\"{}\"", corner),
             "export the mesh again");
    }
    given[part] = !index.empty();
    if (slash == std::string_view::npos) return given[1];
    rest.remove_prefix(slash + 1);
  }
}

void scanFace(const std::filesystem::path& file, int line_number, std::string_view rest, ObjLines& lines) {
  int corners = 0;
  int corners_with_uvs = 0;
  for (std::string_view word = nextWord(rest); !word.empty(); word = nextWord(rest)) {
    ++corners;
    corners_with_uvs += scanCorner(file, line_number, word, lines) ? 1 : 0;
  }
  if (corners < 3) refuse(file, line_number, "a face of at least 3 corners", std::to_string(corners));
  if (corners > kMostCorners) {
    refuse(file, line_number, fmt::format("a face of at most {} corners", kMostCorners), std::to_string(corners),
           "triangulate the mesh");
  }
  if (lines.faces.empty()) lines.faces_have_uvs = corners_with_uvs > 0;
  if (corners_with_uvs != (lines.faces_have_uvs ? corners : 0)) {
    refuse(file, line_number, "texture coordinates at all corners of all faces or at none",
           fmt::format("{} of {} corners with one", corners_with_uvs, corners), "give every face UVs");
  }
  lines.faces.push_back(line_number);
}

ObjLines scanLines(const std::filesystem::path& file, std::string_view text) {
  ObjLines lines;
  for (int number = 1; !text.empty(); ++number) {
    const char* const end = std::find_if(text.begin(), text.end(), endsLine);
    std::string_view rest(text.begin(), end);
    const std::string_view keyword = nextWord(rest);
    if (keyword == "v") {
      checkNumbers(file, number, rest, 3);
      lines.vertices.push_back(number);
    } else if (keyword == "vt") {
      checkNumbers(file, number, rest, 2);
      lines.uvs.push_back(number);
    } else if (keyword == "f") {
      scanFace(file, number, rest, lines);
    } else if (keyword == "usemtl") {
      lines.materials.push_back({lines.faces.size(), trimmed(rest)});
    } else if (keyword == "o" || keyword == "g") {
      lines.groups.push_back({lines.faces.size(), trimmed(rest)});
    }
    text = {end, text.end()};
    text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
  }
  if (lines.vertices.empty()) throw InputError({file.string(), "", "an OBJ mesh", "no vertices", ""});
  if (lines.faces.empty()) throw InputError({file.string(), "", "an OBJ mesh", "no faces", ""});
  return lines;
}

tinyobj::ObjReader parse(const std::filesystem::path& file, const std::string& text,
                         const std::string& materials = "") {
  tinyobj::ObjReaderConfig config;
  config.triangulate = false;  // it would cut each quad along its shorter diagonal, so differently in every expression
  config.vertex_color = false;
  tinyobj::ObjReader reader;
  if (!reader.ParseFromString(text, materials, config)) {
    std::string reason = reader.Error();
    while (!reason.empty() && reason.back() == '\n') reason.pop_back();
    throw InputError({file.string(), "", "an OBJ mesh", reason, "export the mesh again"});
  }
  return reader;
}

// Copies `values` into a matrix of as many columns as Matrix has.
template <typename Matrix>
Matrix coordinates(const std::filesystem::path& file, const std::vector<double>& values,
                   const std::vector<int>& lines) {
  constexpr Eigen::Index kColumns = Matrix::ColsAtCompileTime;
  const auto rows = static_cast<Eigen::Index>(lines.size());
  if (static_cast<Eigen::Index>(values.size()) != rows * kColumns) {
    throw InputError({file.string(), "", fmt::format("{} rows of {} coordinates", rows, Eigen::Index{kColumns}),
                      fmt::format("{} numbers", values.size()), "export the mesh again"});
  }
  Matrix matrix(rows, kColumns);
  for (Eigen::Index row = 0; row < rows; ++row) {
    for (Eigen::Index column = 0; column < kColumns; ++column) {
      const double value = values[static_cast<std::size_t>(row * kColumns + column)];
      if (!std::isfinite(value)) {
        refuse(file, lines[static_cast<std::size_t>(row)], "finite numbers", fmt::format("{}", value));
      }
      matrix(row, column) = value;
    }
  }
  return matrix;
}

// The index of one corner, checked against the number of what it counts.
int checkedIndex(const std::filesystem::path& file, int line, int index, std::size_t count, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= count) {
    refuse(file, line, fmt::format("{} indices from 1 to {}", what, count), fmt::format("{}", index + 1LL));
  }
  return index;
}

// Polygons as fans around their first corner.
class FanBuilder {
 public:
  FanBuilder(const std::filesystem::path& file, const ObjLines& lines) : file_(file), lines_(lines) {}

  void add(const tinyobj::mesh_t& mesh) {
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh.num_face_vertices.size(); ++face) {
      const unsigned char corners = mesh.num_face_vertices[face];
      const int line = lines_.faces.at(face_++);
      for (std::size_t i = 1; i + 1 < corners; ++i) {
        for (const std::size_t j : {std::size_t{0}, i, i + 1}) addCorner(mesh.indices[corner + j], line);
        materials_.push_back(mesh.material_ids[face]);
        polygons_.push_back(static_cast<int>(face_) - 1);
      }
      corner += corners;
    }
  }

  void store(TriangleMesh& mesh) const {
    mesh.polygons = polygons_;
    using RowMajor = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const auto rows = static_cast<Eigen::Index>(vertices_.size() / 3);
    mesh.triangles = Eigen::Map<const RowMajor>(vertices_.data(), rows, 3);
    mesh.uv_triangles = Eigen::Map<const RowMajor>(uvs_.data(), static_cast<Eigen::Index>(uvs_.size() / 3), 3);
  }

  std::size_t faceCount() const { return face_; }
  /// Of each triangle; -1: none.
  const std::vector<int>& materials() const { return materials_; }

 private:
  void addCorner(const tinyobj::index_t& index, int line) {
    vertices_.push_back(checkedIndex(file_, line, index.vertex_index, lines_.vertices.size(), "vertex"));
    if (lines_.faces_have_uvs) {
      uvs_.push_back(checkedIndex(file_, line, index.texcoord_index, lines_.uvs.size(), "texture coordinate"));
    }
  }

  const std::filesystem::path& file_;
  const ObjLines& lines_;
  std::size_t face_ = 0;
  std::vector<int> vertices_;
  std::vector<int> uvs_;
  std::vector<int> materials_;
  std::vector<int> polygons_;
};

/// textures is left empty.
TexturedMesh meshOf(const std::filesystem::path& file, const ObjLines& lines, const tinyobj::ObjReader& reader) {
  TexturedMesh textured;
  TriangleMesh& mesh = textured.mesh;
  mesh.positions = coordinates<Eigen::MatrixX3d>(file, reader.GetAttrib().vertices, lines.vertices);
  FanBuilder fans(file, lines);
  for (const tinyobj::shape_t& shape : reader.GetShapes()) fans.add(shape.mesh);
  if (fans.faceCount() != lines.faces.size()) {
    throw InputError({file.string(), "", fmt::format("{} faces", lines.faces.size()),
                      fmt::format("{}", fans.faceCount()), "export the mesh again"});
  }
  fans.store(mesh);
  textured.materials = fans.materials();
  // Texture coordinates that no face uses are as good as none: callers ask "has it UVs?" by their number.
  if (lines.faces_have_uvs) mesh.uvs = coordinates<Eigen::MatrixX2d>(file, reader.GetAttrib().texcoords, lines.uvs);
  return textured;
}

/// The text of every material library that the mesh names, one after the other.
std::string readLibraries(const std::filesystem::path& file, std::string_view text) {
  std::string libraries;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (nextWord(line) != "mtllib") continue;
    const std::filesystem::path library = fileBeside(file, std::string(trimmed(line)));
    if (!library.empty())
      libraries += plainLines(InputFile(library, "a material library").read(kMostLibraryBytes)) + "\n";
  }
  return libraries;
}

/// What a face of the file, counted from 0, is called.
std::string_view nameAt(const std::vector<ObjLines::Named>& names, std::size_t face) {
  const auto after = std::ranges::upper_bound(names, face, {}, &ObjLines::Named::first_face);
  return after == names.begin() ? std::string_view() : std::string_view((after - 1)->name);
}

std::optional<ObjMaterial> materialOf(const std::filesystem::path& file, const tinyobj::ObjReader& reader,
                                      const std::string& name) {
  const auto& materials = reader.GetMaterials();
  const auto found = std::ranges::find(materials, name, &tinyobj::material_t::name);
  if (found == materials.end()) return std::nullopt;
  ObjMaterial material;
  const auto share = [](double value) { return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 1.0; };
  for (std::size_t c = 0; c < 3; ++c) material.colour[c] = share(found->diffuse[c]);
  material.opacity = share(found->dissolve);
  material.texture = fileBeside(file, found->diffuse_texname);
  return material;
}

std::string formatObj(const TriangleMesh& mesh) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  for (const auto& p : mesh.positions.rowwise()) fmt::format_to(out, "v {} {} {}\n", p[0], p[1], p[2]);
  for (const auto& uv : mesh.uvs.rowwise()) fmt::format_to(out, "vt {} {}\n", uv[0], uv[1]);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    fmt::format_to(out, "f");
    for (int corner = 0; corner < 3; ++corner) {
      fmt::format_to(out, " {}", mesh.triangles(t, corner) + 1);
      if (mesh.uv_triangles.rows() > 0) fmt::format_to(out, "/{}", mesh.uv_triangles(t, corner) + 1);
    }
    fmt::format_to(out, "\n");
  }
  return fmt::to_string(text);
}

}  // namespace

TriangleMesh readObj(const std::filesystem::path& file) {
  const std::string text = plainLines(InputFile(file, "an OBJ file", "check the path").read(kMostBytes));
  const ObjLines lines = scanLines(file, text);
  return meshOf(file, lines, parse(file, text)).mesh;
}

TexturedMesh readTexturedObj(const std::filesystem::path& file) {
  const std::string text = plainLines(InputFile(file, "an OBJ file", "check the path").read(kMostBytes));
  const ObjLines lines = scanLines(file, text);
  const tinyobj::ObjReader reader = parse(file, text, readLibraries(file, text));
  TexturedMesh textured = meshOf(file, lines, reader);
  for (const tinyobj::material_t& material : reader.GetMaterials()) {
    textured.textures.push_back(fileBeside(file, material.diffuse_texname));
  }
  const auto none = static_cast<int>(textured.textures.size());
  for (int& material : textured.materials) material = material < 0 || material >= none ? none : material;
  textured.textures.emplace_back();
  const std::vector<double>& colours = reader.GetAttrib().colors;  // all vertices have one, or there are none
  if (colours.size() == static_cast<std::size_t>(textured.mesh.positions.size())) {
    textured.colours = coordinates<Eigen::MatrixX3d>(file, colours, lines.vertices).cast<float>();
    if (textured.colours.maxCoeff() > 1.0f) textured.colours /= 255.0f;  // as some write them
  }
  return textured;
}

NamedMesh readNamedObj(const std::filesystem::path& file) {
  const std::string text = plainLines(InputFile(file, "an OBJ file", "check the path").read(kMostBytes));
  const ObjLines lines = scanLines(file, text);
  const tinyobj::ObjReader reader = parse(file, text, readLibraries(file, text));
  NamedMesh named;
  named.mesh = meshOf(file, lines, reader).mesh;
  const std::vector<ObjLines::Named>& of_faces = lines.materials.empty() ? lines.groups : lines.materials;
  std::map<std::string, int, std::less<>> index;
  for (const int polygon : named.mesh.polygons) {
    const std::string_view name = nameAt(of_faces, static_cast<std::size_t>(polygon));
    const auto [it, is_new] = index.emplace(name, static_cast<int>(named.names.size()));
    if (is_new) {
      named.names.emplace_back(name);
      named.materials.push_back(materialOf(file, reader, named.names.back()));
    }
    named.of_triangle.push_back(it->second);
  }
  return named;
}

std::vector<std::filesystem::path> objFiles(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (isObj(entry->path())) files.push_back(entry->path());
  }
  if (error) {
    throw InputError({folder.string(), "", "a folder that can be read", error.message(), "check its permissions"});
  }
  std::sort(files.begin(), files.end());
  requireUnique(folder, files);
  return files;
}

void writeObj(const std::filesystem::path& file, const TriangleMesh& mesh) {
  const std::string text = formatObj(mesh);
  errno = 0;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  if (!stream) throw OutputError(file, std::system_category().message(errno), "check the folder and its permissions");
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();  // the last block may be refused only here
  if (!stream) throw OutputError(file, std::system_category().message(errno), "free some space");
}

}  // namespace facezip::geometry
