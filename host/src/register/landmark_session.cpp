// landmark_session.cpp - scans put down as a browser takes them: corners of triangles as floats, pictures of 8 bits.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "facezip/error.hpp"
#include "facezip/landmarks.hpp"
#include "image/averaged_image.hpp"
#include "image/set_sample.hpp"
#include "io/counts.hpp"
#include "io/json_field.hpp"
#include "io/scratch_directory.hpp"
#include "io/write_file.hpp"
#include "register/landmark_files.hpp"
#include "register/landmarks_page.hpp"
#include "register/registration_template.hpp"
#include "register/scan_files.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using namespace registration;
using nlohmann::json;

constexpr Eigen::Index kMostTriangles = Eigen::Index{1} << 22;  // 60 bytes each in the browser
constexpr int kMostTexels = 2048;                               // of a side
constexpr const char* kSceneFile = "scene.json";

json jsonOf(const Eigen::RowVector3d& point) { return {point.x(), point.y(), point.z()}; }

/// A texture of at most kMostTexels a side, of 8 bits. Returns its name.
std::string putTexture(const fs::path& folder, const std::string& name, const fs::path& texture) {
  const image::ImageShape shape = image::ImageReader(texture).shape();
  const image::Image read =
      image::readAveraged(texture, (std::max(shape.width, shape.height) + kMostTexels - 1) / kMostTexels);
  image::Image picture{read.shape, {}};
  picture.shape.type = image::SampleType::kUint8;
  picture.samples.resize(toSize(read.shape.width, read.shape.height, read.shape.channels));
  for (std::size_t i = 0; i < picture.samples.size(); ++i) image::setSample(picture, i, image::sampleAt(read, i));
  image::writeImage(folder / name, picture);
  return name;
}

/// What each corner of a triangle has: place less the origin, UVs, colour; one after the other for all.
class Corners {
 public:
  Corners(const fs::path& file, const geometry::TriangleMesh& mesh) : mesh_(mesh) {
    if (mesh.triangles.rows() > kMostTriangles) {
      throw InputError({file.string(), "", fmt::format("at most {} triangles, for a browser", kMostTriangles),
                        std::to_string(mesh.triangles.rows()),
                        "place landmarks on a copy of fewer triangles: they are coordinates, and serve both"});
    }
    origin_ = 0.5 * (mesh.positions.colwise().minCoeff() + mesh.positions.colwise().maxCoeff());
  }

  /// order  of the triangles; colours  of corners, or empty
  std::string bytes(const std::vector<int>& order, const Eigen::MatrixX3f& colours,
                    const Eigen::MatrixX3i& colour_triangles) const {
    std::vector<float> numbers;
    for (const int t : order) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::RowVector3d p = mesh_.positions.row(mesh_.triangles(t, k)) - origin_;
        for (int axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(p[axis]));
      }
    }
    for (const int t : order) {
      for (int k = 0; k < 3 && mesh_.uv_triangles.rows() > 0; ++k) {
        for (int axis = 0; axis < 2; ++axis) {
          numbers.push_back(static_cast<float>(mesh_.uvs(mesh_.uv_triangles(t, k), axis)));
        }
      }
    }
    for (const int t : order) {
      for (int k = 0; k < 3 && colours.rows() > 0; ++k) {
        for (int axis = 0; axis < 3; ++axis) numbers.push_back(colours(colour_triangles(t, k), axis));
      }
    }
    const auto bytes = std::as_bytes(std::span(numbers));
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  json about(const std::string& name, const std::string& file, bool coloured) const {
    return {{"name", name},
            {"mesh", file},
            {"triangles", mesh_.triangles.rows()},
            {"origin", jsonOf(origin_)},
            {"size", (mesh_.positions.colwise().maxCoeff() - mesh_.positions.colwise().minCoeff()).norm()},
            {"uvs", mesh_.uv_triangles.rows() > 0},
            {"colours", coloured},
            {"groups", json::array()}};
  }

 private:
  const geometry::TriangleMesh& mesh_;
  Eigen::RowVector3d origin_;
};

json putScan(const fs::path& folder, const std::string& number, const fs::path& file) {
  const Scan scan = readScan(file);
  const Corners corners(file, scan.mesh);
  json about = corners.about(scan.name, number + ".mesh", scan.isPainted());
  std::vector<int> order;
  for (std::size_t m = 0; m < scan.textures.size(); ++m) {
    const std::size_t first = order.size();
    for (std::size_t t = 0; t < scan.materials.size(); ++t) {
      if (scan.materials[t] == static_cast<int>(m)) order.push_back(static_cast<int>(t));
    }
    if (order.size() == first) continue;
    json group = {{"first", first}, {"count", order.size() - first}};
    if (!scan.textures[m].empty()) {
      group["texture"] = putTexture(folder, fmt::format("{}_{}.png", number, m), scan.textures[m]);
    }
    about["groups"].push_back(std::move(group));
  }
  io::writeTextFile(folder / (number + ".mesh"), corners.bytes(order, scan.colours, scan.colour_triangles));
  return about;
}

json putTemplate(const fs::path& folder, const RegistrationTemplate& source) {
  const Corners corners(source.neutral_file, source.neutral);
  json about = corners.about("template", "template.mesh", false);
  about["uvs"] = false;
  std::vector<int> order(toSize(source.neutral.triangles.rows()));
  for (std::size_t t = 0; t < order.size(); ++t) order[t] = static_cast<int>(t);
  about["groups"].push_back({{"first", 0}, {"count", order.size()}});
  geometry::TriangleMesh bare = source.neutral;
  bare.uv_triangles.resize(0, 3);
  io::writeTextFile(folder / "template.mesh", Corners(source.neutral_file, bare).bytes(order, {}, {}));
  json& places = about["landmarks"] = json::object();
  for (const auto& [name, vertex] : source.landmarks) places[name] = jsonOf(source.neutral.positions.row(vertex));
  return about;
}

json jsonOf(const ScanLandmarks& landmarks) {
  json all = json::object();
  for (const auto& [scan, points] : landmarks) {
    json& of_scan = all[scan] = json::object();
    for (const auto& [name, place] : points) of_scan[name] = jsonOf(place);
  }
  return all;
}

}  // namespace

struct LandmarkSession::State {
  fs::path landmark_file;
  std::set<std::string> scans;
  io::ScratchDirectory folder;
  std::vector<File> files;

  ScanLandmarks landmarks() const {
    std::error_code error;
    const bool there = fs::symlink_status(landmark_file, error).type() != fs::file_type::not_found;
    return there ? readScanLandmarks(landmark_file) : ScanLandmarks();
  }
};

const std::map<std::string_view, std::string_view>& landmarksPage() { return registration::embeddedLandmarksPage(); }

LandmarkSession::LandmarkSession(const fs::path& scans, const fs::path& template_directory, const fs::path& landmarks,
                                 Progress& progress)
    : state_(std::make_unique<State>()) {
  const ScanFolder found = findScans(scans);
  const RegistrationTemplate source = readRegistrationTemplate(template_directory);
  state_->landmark_file = landmarks.empty() ? scans / "landmarks.json" : landmarks;
  const fs::path folder = state_->folder.path();
  json scene = {{"landmarks", jsonOf(state_->landmarks())},
                {"template", putTemplate(folder, source)},
                {"file", state_->landmark_file.filename().string()},
                {"scans", json::array()}};
  progress.stage("reading scans", found.expressions.size() + 1);
  std::vector<fs::path> files = {found.neutral};
  files.insert(files.end(), found.expressions.begin(), found.expressions.end());
  for (const fs::path& file : files) {
    progress.checkCancelled();
    const std::size_t number = scene["scans"].size();
    scene["scans"].push_back(putScan(folder, std::to_string(number), file));
    state_->scans.insert(scene["scans"].back()["name"].get<std::string>());
    progress.advance(number + 1);
  }
  io::writeTextFile(folder / kSceneFile, scene.dump());
  std::vector<fs::path> put;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) put.push_back(entry.path());
  std::ranges::sort(put);
  for (const fs::path& file : put)
    state_->files.push_back({file.filename().string(), InputFile(file, "a file of ours")});
}

LandmarkSession::~LandmarkSession() = default;

const std::vector<LandmarkSession::File>& LandmarkSession::files() const { return state_->files; }

const fs::path& LandmarkSession::landmarkFile() const { return state_->landmark_file; }

void LandmarkSession::save(const std::string& text) const {
  ScanLandmarks all = state_->landmarks();
  for (auto& [scan, points] : parseScanLandmarks(text, "what the page sent")) {
    if (!state_->scans.contains(scan))
      throw InputError({"what the page sent", scan, "a scan of the folder", "none", ""});
    all[scan] = points;
  }
  io::writeTextFileAtomically(state_->landmark_file, jsonOf(all).dump(1) + "\n");
}

}  // namespace facezip
