// ply_io.cpp - PLY through CGAL's reader of elements.
// It believes headers: a property of no known type is left out, an element without properties is counted to its end,
// and a list is as long as its count says before a number of it was read. A look at the header comes first.
#include <CGAL/IO/PLY/PLY_reader.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "facezip/error.hpp"
#include "facezip/geometry/textured_mesh.hpp"
#include "facezip/input_file.hpp"
#include "file_beside.hpp"

namespace facezip::geometry {
namespace {
namespace fs = std::filesystem;
namespace ply = CGAL::IO::internal;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{2} << 30;
constexpr std::size_t kMost = std::size_t{1} << 25;  // vertices, triangles
constexpr const char* kCure = "export the mesh again";
constexpr std::string_view kTextureFile = "TextureFile";

[[noreturn]] void refuse(const fs::path& file, const std::string& item, const std::string& expected,
                         const std::string& got) {
  throw InputError({file.string(), item, expected, got, kCure});
}

bool isOneOf(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool isNumberType(std::string_view type) {
  return isOneOf(type, {"char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int", "int32", "uint",
                        "uint32", "float", "float32", "double", "float64"});
}

/// A list whose count says 4 billion would be allocated at once.
bool isCountType(std::string_view type) {
  return isOneOf(type, {"char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16"});
}

void requireProperty(const fs::path& file, const std::string& line, std::istringstream& words) {
  std::string type, count, name;
  words >> type;
  const bool list = type == "list";
  if (list) words >> count >> type;
  words >> name;
  if (!isNumberType(type) || name.empty() || (list && !isNumberType(count)))
    refuse(file, "header", "properties of PLY's types", line);
  if (list && !isCountType(count)) refuse(file, "header", "lists that 8 or 16 bits count", line);
}

/// The next line, without what ends it.
std::string nextLine(std::string_view& text) {
  const std::string line(text.substr(0, text.find('\n')));
  text.remove_prefix(std::min(text.size(), line.size() + 1));
  return line;
}

/// Throws InputError for headers that the reader would trip over.
void requireReadableHeader(const fs::path& file, std::string_view text) {
  const std::size_t bytes = text.size();
  if (!nextLine(text).starts_with("ply")) refuse(file, "", "a PLY file, which begins with ply", "another");
  if (!nextLine(text).starts_with("format ")) refuse(file, "header", "its format in the second line", "another");
  bool in_element = false, wants_property = false;
  while (!text.empty()) {
    const std::string line = nextLine(text);
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "element") {
      if (wants_property) break;
      std::string name;
      std::uintmax_t count = 0;
      if (!(words >> name >> count) || count > bytes)
        refuse(file, "header", "an element, and no more of it than the file can hold", line);
      in_element = wants_property = true;
    } else if (keyword == "property") {
      if (!in_element) break;
      requireProperty(file, line, words);
      wants_property = false;
    } else if (keyword == "end_header" && !wants_property) {
      return;
    }
  }
  refuse(file, "header", "elements, properties behind each, and end_header", "another");
}

/// A property as a number, whatever its type.
struct Number {
  const ply::PLY_read_number* property = nullptr;
  double (*value)(const ply::PLY_read_number&) = nullptr;
  double full = 1.0;  ///< what a colour has at full scale

  explicit operator bool() const { return property != nullptr; }
  double get() const { return value(*property); }
};

/// A property as a list of numbers.
struct List {
  const ply::PLY_read_number* property = nullptr;
  std::size_t (*size_of)(const ply::PLY_read_number&) = nullptr;
  double (*value)(const ply::PLY_read_number&, std::size_t) = nullptr;

  explicit operator bool() const { return property != nullptr; }
  std::size_t size() const { return size_of(*property); }
  double operator[](std::size_t i) const { return value(*property, i); }
};

template <typename T>
void takeIfOf(const ply::PLY_read_number& property, Number& number) {
  if (dynamic_cast<const ply::PLY_read_typed_number<T>*>(&property) == nullptr) return;
  number.property = &property;
  number.value = [](const ply::PLY_read_number& p) {
    return static_cast<double>(static_cast<const ply::PLY_read_typed_number<T>&>(p).buffer());
  };
  number.full = std::is_floating_point_v<T> ? 1.0 : static_cast<double>(std::numeric_limits<T>::max());
}

template <typename T>
void takeIfOf(const ply::PLY_read_number& property, List& list) {
  if (dynamic_cast<const ply::PLY_read_typed_list<T>*>(&property) == nullptr) return;
  list.property = &property;
  list.size_of = [](const ply::PLY_read_number& p) {
    return static_cast<const ply::PLY_read_typed_list<T>&>(p).buffer().size();
  };
  list.value = [](const ply::PLY_read_number& p, std::size_t i) {
    return static_cast<double>(static_cast<const ply::PLY_read_typed_list<T>&>(p).buffer()[i]);
  };
}

/// The first property that has one of the names, and is a Kind: Number or List.
template <typename Kind>
Kind propertyOf(ply::PLY_element& element, std::initializer_list<std::string_view> names) {
  Kind found;
  for (std::size_t i = 0; i < element.number_of_properties() && !found; ++i) {
    const ply::PLY_read_number& property = *element.property(i);
    if (!isOneOf(property.name(), names)) continue;
    takeIfOf<std::int8_t>(property, found);
    takeIfOf<std::uint8_t>(property, found);
    takeIfOf<std::int16_t>(property, found);
    takeIfOf<std::uint16_t>(property, found);
    takeIfOf<std::int32_t>(property, found);
    takeIfOf<std::uint32_t>(property, found);
    takeIfOf<float>(property, found);
    takeIfOf<double>(property, found);
  }
  return found;
}

template <std::size_t N>
using Numbers = std::array<Number, N>;

template <std::size_t N>
bool areAll(const Numbers<N>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](const Number& n) { return static_cast<bool>(n); });
}

class PlyMesh {
 public:
  PlyMesh(const fs::path& file, std::istringstream stream)
      : file_(file), stream_(std::move(stream)), reader_(/*verbose=*/false) {
    if (!reader_.init(stream_)) refuse(file_, "header", "a PLY header", "another");
    for (std::size_t e = 0; e < reader_.number_of_elements(); ++e) {
      ply::PLY_element& element = reader_.element(e);
      if (element.name() == "vertex") {
        readVertices(element);
      } else if (element.name() == "face") {
        readFaces(element);
      } else {
        for (std::size_t i = 0; i < element.number_of_items(); ++i) next(element, i);
      }
    }
    if (positions_.empty()) throw InputError({file_.string(), "", "a PLY mesh", "no vertices", ""});
    if (faces_.empty()) throw InputError({file_.string(), "", "a PLY mesh", "no faces", ""});
  }

  TexturedMesh mesh() const {
    TexturedMesh made;
    TriangleMesh& mesh = made.mesh;
    mesh.positions = rowsOf<Eigen::MatrixX3d>(positions_);
    mesh.triangles = rowsOf<Eigen::MatrixX3i>(corners_);
    if (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= mesh.positions.rows()) {
      refuse(file_, "face", fmt::format("indices below {}", mesh.positions.rows()), "others");
    }
    mesh.polygons = faces_;
    if (!face_uvs_.empty()) {
      if (face_uvs_.size() != 2 * corners_.size()) refuse(file_, "face", "texcoord of every face", "of some alone");
      mesh.uvs = rowsOf<Eigen::MatrixX2d>(face_uvs_);
      mesh.uv_triangles.resize(mesh.triangles.rows(), 3);
      for (Eigen::Index t = 0, corner = 0; t < mesh.triangles.rows(); ++t) {
        for (int k = 0; k < 3; ++k) mesh.uv_triangles(t, k) = static_cast<int>(corner++);
      }
    } else if (!vertex_uvs_.empty()) {
      mesh.uvs = rowsOf<Eigen::MatrixX2d>(vertex_uvs_);
      mesh.uv_triangles = mesh.triangles;
    }
    made.colours = rowsOf<Eigen::MatrixX3f>(colours_);
    nameTextures(made);
    return made;
  }

 private:
  template <typename Matrix>
  static Matrix rowsOf(const std::vector<typename Matrix::Scalar>& numbers) {
    using RowMajor = Eigen::Matrix<typename Matrix::Scalar, Eigen::Dynamic, Matrix::ColsAtCompileTime, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor>(numbers.data(),
                                      static_cast<Eigen::Index>(numbers.size()) / Matrix::ColsAtCompileTime,
                                      Matrix::ColsAtCompileTime);
  }

  void next(ply::PLY_element& element, std::size_t item) {
    for (std::size_t i = 0; i < element.number_of_properties(); ++i) {
      element.property(i)->get(stream_);
      if (!stream_.fail()) continue;
      refuse(file_, fmt::format("{} {}", element.name(), item), element.property(i)->name(), "no number, or the end");
    }
  }

  double finite(const Number& number, const char* element, std::size_t item) const {
    const double value = number.get();
    if (std::isfinite(value)) return value;
    refuse(file_, fmt::format("{} {}", element, item), "finite numbers", fmt::format("{}", value));
  }

  void readVertices(ply::PLY_element& element) {
    const auto number = [&](std::initializer_list<std::string_view> names) {
      return propertyOf<Number>(element, names);
    };
    const Numbers<3> position = {number({"x"}), number({"y"}), number({"z"})};
    const Numbers<3> colour = {number({"red", "r", "diffuse_red"}), number({"green", "g", "diffuse_green"}),
                               number({"blue", "b", "diffuse_blue"})};
    const Numbers<2> uv = {number({"s", "u", "texture_u", "texture_s"}), number({"t", "v", "texture_v", "texture_t"})};
    if (!areAll(position)) refuse(file_, "vertex", "properties x, y and z", "none");
    if (!positions_.empty()) refuse(file_, "vertex", "one such element", "two");
    if (element.number_of_items() > kMost) refuse(file_, "vertex", fmt::format("at most {}", kMost), "more");
    for (std::size_t i = 0; i < element.number_of_items(); ++i) {
      next(element, i);
      for (const Number& p : position) positions_.push_back(finite(p, "vertex", i));
      if (areAll(uv)) {
        for (const Number& p : uv) vertex_uvs_.push_back(finite(p, "vertex", i));
      }
      if (!areAll(colour)) continue;
      for (const Number& p : colour) colours_.push_back(static_cast<float>(finite(p, "vertex", i) / p.full));
    }
  }

  void readFaces(ply::PLY_element& element) {
    const List vertices = propertyOf<List>(element, {"vertex_indices", "vertex_index"});
    const List uvs = propertyOf<List>(element, {"texcoord"});
    const Number texture = propertyOf<Number>(element, {"texnumber"});
    if (!vertices) refuse(file_, "face", "a list vertex_indices", "none");
    if (!faces_.empty()) refuse(file_, "face", "one such element", "two");
    for (std::size_t i = 0; i < element.number_of_items(); ++i) {
      next(element, i);
      const std::size_t corners = vertices.size();
      if (corners < 3) refuse(file_, fmt::format("face {}", i), "at least 3 corners", std::to_string(corners));
      const std::size_t coordinates = uvs ? uvs.size() : 0;
      if (coordinates != 0 && coordinates != 2 * corners) {
        refuse(file_, fmt::format("face {}", i), fmt::format("{} numbers of texcoord", 2 * corners),
               std::to_string(coordinates));
      }
      for (std::size_t k = 1; k + 1 < corners; ++k) addTriangle(i, {0, k, k + 1}, vertices, uvs, coordinates != 0);
      if (texture) texture_numbers_.resize(faces_.size(), texture.get());
    }
  }

  void addTriangle(std::size_t face, const std::array<std::size_t, 3>& corners, const List& vertices, const List& uvs,
                   bool with_uvs) {
    if (faces_.size() >= kMost) refuse(file_, "face", fmt::format("at most {} triangles", kMost), "more");
    faces_.push_back(static_cast<int>(face));
    for (const std::size_t k : corners) {
      const double vertex = vertices[k];
      // Negative and fractional ones are none; whether there are as many vertices shows at the end.
      const bool whole = vertex >= 0.0 && vertex <= 2147483647.0 && vertex == std::floor(vertex);
      corners_.push_back(whole ? static_cast<int>(vertex) : -1);
      if (!with_uvs) continue;
      for (const std::size_t c : {2 * k, 2 * k + 1}) {
        if (!std::isfinite(uvs[c])) refuse(file_, fmt::format("face {}", face), "finite numbers", "others");
        face_uvs_.push_back(uvs[c]);
      }
    }
  }

  /// Textures that comments name, in their order.
  void nameTextures(TexturedMesh& made) const {
    std::istringstream comments(reader_.comments());
    for (std::string line; std::getline(comments, line);) {
      const std::size_t start = line.find_first_not_of(" \t");
      if (start == std::string::npos || line.compare(start, kTextureFile.size(), kTextureFile) != 0) continue;
      std::string name = line.substr(start + kTextureFile.size());
      name.erase(0, name.find_first_not_of(" \t\""));
      name.erase(name.find_last_not_of(" \t\r\"") + 1);
      made.textures.push_back(fileBeside(file_, name));
    }
    const auto none = static_cast<int>(made.textures.size());
    made.materials.assign(faces_.size(), 0);
    for (std::size_t t = 0; t < texture_numbers_.size(); ++t) {
      const double number = texture_numbers_[t];
      made.materials[t] = number >= 0.0 && number < none ? static_cast<int>(number) : none;
    }
    made.textures.emplace_back();
  }

  const fs::path& file_;
  std::istringstream stream_;
  ply::PLY_reader reader_;
  std::vector<double> positions_, vertex_uvs_, face_uvs_, texture_numbers_;
  std::vector<float> colours_;
  std::vector<int> corners_, faces_;  // faces_: of each triangle
};

}  // namespace

TexturedMesh readTexturedPly(const fs::path& file) {
  std::string text = InputFile(file, "a PLY file", "check the path").read(kMostBytes);
  requireReadableHeader(file, text);
  try {
    return PlyMesh(file, std::istringstream(std::move(text))).mesh();
  } catch (const std::length_error&) {
    refuse(file, "", "lists of no negative length", "others");
  }
}

}  // namespace facezip::geometry
