#include "learn/face_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "facezip/version.hpp"
#include "io/json_field.hpp"
#include "io/safe_names.hpp"
#include "learn/block_file.hpp"
#include "package/guides.hpp"

namespace facezip::learn {
namespace fs = std::filesystem;
namespace {

using Shape = std::vector<std::uint64_t>;
using RowsXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowsXi = Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr char kAbout[] = "about";
constexpr int kMostShapes = 4096;
constexpr int kMostComponents = 4096;
constexpr int kMostMaps = 64;
constexpr int kMostSide = 4096;
constexpr int kMostVertices = 1 << 26;
constexpr std::uint64_t kMostTextureSide = 8192;

std::uint64_t size(Eigen::Index count) { return static_cast<std::uint64_t>(count); }

template <typename Matrix>
void addMatrix(Blocks& blocks, const std::string& name, const Matrix& matrix) {
  if constexpr (std::is_integral_v<typename Matrix::Scalar>) {
    const RowsXi rows = matrix;
    blocks.add(name, Shape{size(rows.rows()), size(rows.cols())},
               std::vector<std::int32_t>(rows.data(), rows.data() + rows.size()));
  } else {
    const RowsXf rows = matrix.template cast<float>();
    blocks.add(name, Shape{size(rows.rows()), size(rows.cols())},
               std::vector<float>(rows.data(), rows.data() + rows.size()));
  }
}

void addMesh(Blocks& blocks, const std::string& name, const geometry::TriangleMesh& mesh) {
  addMatrix(blocks, name + "/positions", mesh.positions);
  addMatrix(blocks, name + "/uvs", mesh.uvs);
  addMatrix(blocks, name + "/triangles", mesh.triangles);
  addMatrix(blocks, name + "/uv_triangles", mesh.uv_triangles);
  blocks.add(name + "/polygons", Shape{mesh.polygons.size()},
             std::vector<std::int32_t>(mesh.polygons.begin(), mesh.polygons.end()));
}

std::string aboutJson(const FaceModel& model) {
  nlohmann::ordered_json about;
  about["format"] = "facezip-model";
  about["version"] = 1;
  about["generator"] = "facezip " FACEZIP_VERSION;
  about["name"] = model.name;
  about["method"] = "linear";
  about["components"] = model.shapes.identity.size();
  about["shapes"] = model.face_template.names;
  about["maps"] = nlohmann::ordered_json::array();
  for (const TextureModel& texture : model.textures) {
    nlohmann::ordered_json map = {{"name", texture.map}, {"channels", texture.channels}, {"side", texture.side}};
    map["regressions"] = nlohmann::ordered_json::array();
    for (const TextureRegression& regression : texture.regressions) {
      map["regressions"].push_back({{"maps", regression.maps}, {"channels", regression.channels}});
    }
    about["maps"].push_back(std::move(map));
  }
  if (model.face_template.parts.empty()) return about.dump(1);
  about["parts"] = nlohmann::ordered_json::array();
  for (const rig::TemplatePart& part : model.face_template.parts.parts) {
    nlohmann::ordered_json json = {{"material", package::materialJson(part.material)}};
    if (!part.texture.samples.empty()) json["channels"] = part.texture.shape.channels;
    about["parts"].push_back(std::move(json));
  }
  return about.dump(1);
}

std::string textureBlock(const std::string& part) { return "parts/" + part + "/texture"; }

/// Four samples to a number, the first in the lowest bits; channels that an image does not have are 0.
void addParts(Blocks& blocks, const rig::TemplateParts& parts) {
  if (parts.empty()) return;
  blocks.add("template/parts", Shape{parts.of_triangle.size()},
             std::vector<std::int32_t>(parts.of_triangle.begin(), parts.of_triangle.end()));
  for (const rig::TemplatePart& part : parts.parts) {
    const image::Image& texture = part.texture;
    if (texture.samples.empty()) continue;
    const auto channels = static_cast<std::size_t>(texture.shape.channels);
    std::vector<std::int32_t> texels;
    for (std::size_t i = 0; i < texture.samples.size(); i += channels) {
      std::uint32_t texel = 0;
      for (std::size_t c = 0; c < channels; ++c) {
        texel |= std::to_integer<std::uint32_t>(texture.samples[i + c]) << (8 * c);
      }
      texels.push_back(static_cast<std::int32_t>(texel));
    }
    blocks.add(textureBlock(part.material.name), Shape{size(texture.shape.height), size(texture.shape.width)},
               std::move(texels));
  }
}

image::Image readTexture(const Blocks& blocks, const std::string& name, int channels) {
  const Shape shape = blocks.shapeOf(name, BlockType::kInteger, 2);
  if (shape[0] < 1 || shape[1] < 1 || shape[0] > kMostTextureSide || shape[1] > kMostTextureSide) {
    blocks.fail(name, fmt::format("1 to {} texels a side", kMostTextureSide),
                fmt::format("{} x {}", shape[1], shape[0]));
  }
  image::Image texture;
  texture.shape = {static_cast<int>(shape[1]), static_cast<int>(shape[0]), channels, SampleType::kUint8};
  for (const std::int32_t texel : blocks.integers(name, shape)) {
    for (int c = 0; c < channels; ++c) {
      texture.samples.push_back(static_cast<std::byte>(static_cast<std::uint32_t>(texel) >> (8 * c)));
    }
  }
  return texture;
}

/// beyond  triangles of the template beyond the skin
rig::TemplateParts readParts(const Blocks& blocks, const io::JsonField& root, Eigen::Index beyond) {
  rig::TemplateParts parts;
  if (beyond == 0) return parts;
  std::vector<std::string> names;
  for (const io::JsonField& field : root["parts"].elements(1, package::kMostParts)) {
    rig::TemplatePart& part = parts.parts.emplace_back();
    part.material = package::parseMaterial(field["material"]);
    if (std::ranges::find(names, part.material.name) != names.end()) field.fail("unique names of parts", "one twice");
    names.push_back(part.material.name);
    part.material.texture.clear();
    if (field.has("channels")) {
      part.texture = readTexture(blocks, textureBlock(part.material.name), field["channels"].integer(1, 4));
    }
  }
  const std::vector<std::int32_t>& of_triangle = blocks.integers("template/parts", {size(beyond)});
  for (const std::int32_t part : of_triangle) {
    if (part < 0 || part >= std::ssize(parts.parts)) {
      blocks.fail("template/parts", fmt::format("0 to {}", parts.parts.size() - 1), fmt::format("{}", part));
    }
  }
  parts.of_triangle.assign(of_triangle.begin(), of_triangle.end());
  return parts;
}

/// Numbers of a block whose second extent is known, as rows.
RowsXf floatRows(const Blocks& blocks, const std::string& name, std::uint64_t columns) {
  const std::uint64_t rows = blocks.shapeOf(name, BlockType::kFloat, 2)[0];
  const std::vector<float>& values = blocks.floats(name, {rows, columns});
  return Eigen::Map<const RowsXf>(values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
}

/// Indices in [0, end).
RowsXi indexRows(const Blocks& blocks, const std::string& name, std::uint64_t columns, Eigen::Index end) {
  const std::uint64_t rows = blocks.shapeOf(name, BlockType::kInteger, 2)[0];
  const std::vector<std::int32_t>& values = blocks.integers(name, {rows, columns});
  for (const std::int32_t value : values) {
    if (value < 0 || value >= end) blocks.fail(name, fmt::format("0 to {}", end - 1), fmt::format("{}", value));
  }
  return Eigen::Map<const RowsXi>(values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
}

geometry::TriangleMesh readMesh(const Blocks& blocks, const std::string& name) {
  geometry::TriangleMesh mesh;
  mesh.positions = floatRows(blocks, name + "/positions", 3).cast<double>();
  if (mesh.positions.rows() < 3 || mesh.positions.rows() > kMostVertices) {
    blocks.fail(name + "/positions", fmt::format("3 to {} vertices", kMostVertices),
                fmt::format("{}", mesh.positions.rows()));
  }
  mesh.uvs = floatRows(blocks, name + "/uvs", 2).cast<double>();
  mesh.triangles = indexRows(blocks, name + "/triangles", 3, mesh.positions.rows());
  mesh.uv_triangles = indexRows(blocks, name + "/uv_triangles", 3, mesh.uvs.rows());
  const Eigen::Index triangles = mesh.triangles.rows();
  if (triangles == 0) blocks.fail(name + "/triangles", "at least one triangle", "none");
  if (mesh.uv_triangles.rows() != 0 && mesh.uv_triangles.rows() != triangles) {
    blocks.fail(name + "/uv_triangles", fmt::format("{} triangles", triangles),
                fmt::format("{}", mesh.uv_triangles.rows()));
  }
  const std::vector<std::int32_t>& polygons = blocks.integers(name + "/polygons", {size(triangles)});
  if (polygons[0] < 0 || !std::ranges::is_sorted(polygons)) {
    blocks.fail(name + "/polygons", "rising numbers from 0", "others");
  }
  mesh.polygons.assign(polygons.begin(), polygons.end());
  return mesh;
}

geometry::ShapeOffsets readOffsets(const Blocks& blocks, const std::string& name, std::uint64_t features,
                                   Eigen::Index vertices) {
  geometry::ShapeOffsets offsets;
  const RowsXi indices = indexRows(blocks, name + "/vertices", 1, vertices);
  offsets.vertices.assign(indices.data(), indices.data() + indices.size());
  if (!std::ranges::is_sorted(offsets.vertices)) blocks.fail(name + "/vertices", "rising numbers", "others");
  const std::vector<float>& rows = blocks.floats(name + "/rows", {features, 3 * offsets.vertices.size()});
  offsets.rows =
      Eigen::Map<const RowsXf>(rows.data(), static_cast<Eigen::Index>(features), 3 * std::ssize(offsets.vertices));
  return offsets;
}

std::vector<std::string> readShapeNames(const io::JsonField& field) {
  std::vector<std::string> names;
  for (const io::JsonField& name : field.elements(1, kMostShapes)) {
    names.push_back(io::fileSafeName(name));
    const auto fault = io::nameFault(names.back(), ",=:");
    if (fault) name.fail(fault->expected, fault->got);
  }
  std::vector<std::string> sorted = names;
  std::ranges::sort(sorted);
  if (std::ranges::adjacent_find(sorted) != sorted.end()) field.fail("unique names of shapes", "one twice");
  return names;
}

TextureModel readTexture(const Blocks& blocks, const io::JsonField& field) {
  TextureModel model;
  model.map = io::fileSafeName(field["name"]);
  model.channels = field["channels"].integer(1, 4);
  model.side = field["side"].integer(1, kMostSide);
  const std::string name = "textures/" + model.map;
  for (const io::JsonField& each : field["regressions"].elements(1, kMostMaps)) {
    TextureRegression regression;
    int channels = 0;
    for (const io::JsonField& map : each["maps"].elements(1, kMostMaps)) {
      regression.maps.push_back(io::fileSafeName(map));
    }
    if (std::ranges::find(regression.maps, model.map) == regression.maps.end()) {
      each["maps"].fail("the predicted map among them", each["maps"].got());
    }
    for (const io::JsonField& count : each["channels"].elements(regression.maps.size(), regression.maps.size())) {
      regression.channels.push_back(count.integer(1, 4));
      channels += regression.channels.back();
    }
    const std::string factors = fmt::format("{}/factors_{}", name, model.regressions.size());
    const auto rows = hatCount() * featureCount(channels);
    const std::vector<float>& values = blocks.floats(factors, {size(rows), size(model.channels)});
    regression.factors = Eigen::Map<const RowsXf>(values.data(), rows, model.channels);
    model.regressions.push_back(std::move(regression));
  }
  return model;
}

void addTexture(Blocks& blocks, const TextureModel& model) {
  const std::string name = "textures/" + model.map;
  for (std::size_t i = 0; i < model.regressions.size(); ++i) {
    addMatrix(blocks, fmt::format("{}/factors_{}", name, i), model.regressions[i].factors);
  }
}

rig::RigTemplate readTemplate(const Blocks& blocks, const std::vector<std::string>& names,
                              const geometry::TriangleMesh& skin) {
  rig::RigTemplate found;
  found.neutral_file = blocks.file();
  found.names = names;
  found.neutral = readMesh(blocks, "template");
  const Eigen::Index vertices = found.neutral.positions.rows();
  if (vertices < skin.positions.rows()) {
    blocks.fail("template/positions", fmt::format("at least the {} vertices of the skin", skin.positions.rows()),
                fmt::format("{}", vertices));
  }
  rig::requireSkin(found, skin, blocks.file().string());
  const std::vector<float>& moved = blocks.floats("template/shapes", {names.size(), size(vertices), 3});
  for (std::size_t m = 0; m < names.size(); ++m) {
    const float* from = moved.data() + m * size(vertices) * 3;
    const RowsXf displacement = Eigen::Map<const RowsXf>(from, vertices, 3);
    found.shapes.push_back(found.neutral.positions + displacement.cast<double>());
  }
  return found;
}

}  // namespace

std::uint64_t writeModel(const fs::path& file, const FaceModel& model, Progress& progress) {
  Blocks blocks;
  blocks.add(kAbout, aboutJson(model));
  addMesh(blocks, "skin", model.skin);
  addMesh(blocks, "template", model.face_template.neutral);
  addParts(blocks, model.face_template.parts);
  std::vector<float> moved;
  for (const Eigen::MatrixX3d& shape : model.face_template.shapes) {
    const RowsXf rows = (shape - model.face_template.neutral.positions).cast<float>();
    moved.insert(moved.end(), rows.data(), rows.data() + rows.size());
  }
  blocks.add("template/shapes",
             Shape{model.face_template.shapes.size(), size(model.face_template.neutral.positions.rows()), 3},
             std::move(moved));
  addMatrix(blocks, "identity/axes", model.shapes.identity.axes.transpose());
  for (std::size_t m = 0; m < model.shapes.offsets.size(); ++m) {
    const geometry::ShapeOffsets& offsets = model.shapes.offsets[m];
    const std::string name = "offsets/" + model.face_template.names[m];
    addMatrix(blocks, name + "/vertices",
              Eigen::Map<const Eigen::VectorXi>(offsets.vertices.data(), std::ssize(offsets.vertices)));
    addMatrix(blocks, name + "/rows", offsets.rows);
  }
  for (const TextureModel& texture : model.textures) addTexture(blocks, texture);
  return writeBlocks(file, blocks, progress);
}

FaceModel readModel(const fs::path& file) {
  const Blocks blocks = readBlocks(file);
  const nlohmann::json about = io::parseJson(blocks.text(kAbout), file.string());
  const io::JsonField root(about, file.string(), "", "take a file that `facezip train` wrote, or train again");
  if (root["format"].text() != "facezip-model") root["format"].fail("\"facezip-model\"", root["format"].got());
  root["version"].integer(1, 1);
  if (root["method"].text() != "linear") root["method"].fail("\"linear\"", root["method"].got());
  FaceModel model;
  model.name = root["name"].text();
  model.skin = readMesh(blocks, "skin");
  const std::vector<std::string> names = readShapeNames(root["shapes"]);
  model.face_template = readTemplate(blocks, names, model.skin);
  model.face_template.parts =
      readParts(blocks, root, model.face_template.neutral.triangles.rows() - model.skin.triangles.rows());
  const auto components = static_cast<std::uint64_t>(root["components"].integer(1, kMostComponents));
  const Eigen::Index vertices = model.skin.positions.rows();
  model.shapes.identity.mean = model.skin.positions;
  const std::vector<float>& axes = blocks.floats("identity/axes", {components, 3 * size(vertices)});
  model.shapes.identity.axes =
      Eigen::Map<const RowsXf>(axes.data(), static_cast<Eigen::Index>(components), 3 * vertices)
          .transpose()
          .cast<double>();
  for (const std::string& name : names) {
    model.shapes.offsets.push_back(readOffsets(blocks, "offsets/" + name, 1 + components, vertices));
  }
  for (const io::JsonField& map : root["maps"].elements(0, kMostMaps)) {
    model.textures.push_back(readTexture(blocks, map));
  }
  return model;
}

}  // namespace facezip::learn
