// align_capture.cpp - a capture whose textures slide, written again with each texture laid on the neutral's.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "align/texture_slide.hpp"
#include "capture/capture_meshes.hpp"
#include "face/face.hpp"
#include "facezip/alignment.hpp"
#include "facezip/error.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/uv_slide.hpp"
#include "image/set_sample.hpp"
#include "io/counts.hpp"
#include "io/read_file.hpp"
#include "io/stage_clock.hpp"
#include "io/staged_directory.hpp"
#include "register/resample.hpp"

namespace facezip {
namespace {
using namespace align;
namespace fs = std::filesystem;

constexpr const char* kManifest = "capture.json";
constexpr int kBandRows = 256;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{2} << 30;  // as of a mesh

/// What all expressions share.
struct Job {
  const Capture& capture;
  const AlignmentOptions& options;
  const CaptureMap& guide;
  const compress::Face face;
  const CaptureMeshes meshes;
  device::DeviceContext& context;
  Progress& progress;
  fs::path directory;
};

const CaptureMap& guideOf(const Capture& capture, const std::string& name) {
  const std::string wanted = name.empty() ? "albedo" : name;
  for (const CaptureMap& map : capture.maps) {
    if (map.name == wanted) return map;
  }
  if (name.empty()) return capture.maps.front();
  std::string names;
  for (const CaptureMap& map : capture.maps) names += (names.empty() ? "" : ", ") + map.name;
  throw InputError({"--map", name, "a map of the capture: " + names, "none of that name", ""});
}

void copyFile(const fs::path& from, const fs::path& to) {
  io::createDirectories(to.parent_path());
  io::writeTextFile(to, io::readFile(from, "a file of the capture", "", kMostBytes));
}

/// Meshes are copied as they are: not morph targets, nor UVs of another tile than the first.
bool isCopied(const Capture& capture) {
  return !scene::isSceneFile(capture.neutral_mesh) && capture.tile.value_or(kFirstTile) == kFirstTile;
}

/// Where a texture of the new capture goes: what is resampled is written as it can be without loss.
fs::path textureFile(const Job& job, const CaptureMap& map, const std::string& name, const fs::path& like,
                     bool written) {
  const bool is_float = written && image::ImageReader(like).shape().type == image::SampleType::kFloat32;
  const std::string extension = !written ? like.extension().string() : is_float ? ".exr" : ".png";
  return job.directory / map.name / (name + extension);
}

void writeSlid(const Job& job, const CaptureMap& map, const fs::path& from, const fs::path& to,
               const SlideField& field) {
  image::ImageReader reader(from);
  const std::string colours = map.colour_space.empty() ? reader.colours() : map.colour_space;
  const image::Image whole = image::readImage(std::move(reader));
  registration::TextureSampler sampler(job.context, whole);
  io::createDirectories(to.parent_path());
  image::ImageWriter writer(to, whole.shape, colours == "sRGB" || colours == "linear" ? colours : "");
  const float scale = image::unit255(whole.shape.type) / 255.0f;
  for (int begin = 0; begin < whole.shape.height; begin += kBandRows) {
    job.progress.checkCancelled();
    const int end = std::min(begin + kBandRows, whole.shape.height);
    image::Image rows{whole.shape, {}};
    rows.shape.height = end - begin;
    rows.samples.resize(toSize(end - begin) * whole.shape.rowBytes());
    std::vector<float> samples(toSize(end - begin, whole.shape.width, whole.shape.channels));
    sampler.sample(placesOf(field, begin, end, whole.shape.width, whole.shape.height), samples);
    for (std::size_t i = 0; i < samples.size(); ++i) image::setSample(rows, i, scale * samples[i]);
    writer.writeRows(rows.samples, end - begin);
  }
  writer.close();
}

void writeMesh(const Job& job, std::size_t expression, const Slide& slide) {
  const fs::path& from = job.capture.expression_meshes[expression];
  if (from.empty()) return;
  const fs::path to = job.directory / "expressions" / (slide.found.name + ".obj");
  const bool moved = slide.found.moved && !job.options.keep_meshes;
  if (!moved && isCopied(job.capture)) return copyFile(from, to);
  geometry::TriangleMesh mesh = job.face.mesh;  // expressions need no UVs of their own
  mesh.positions = job.meshes.positions(expression);
  io::createDirectories(to.parent_path());
  if (!moved) return geometry::writeObj(to, mesh);
  Eigen::MatrixX2d vectors(mesh.uvs.rows(), 2);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) {
    const Eigen::RowVector2d texels = slide.field.at(mesh.uvs(v, 0), mesh.uvs(v, 1));
    vectors.row(v) << texels.x() / slide.field.width, -texels.y() / slide.field.height;
  }
  mesh.positions = geometry::slideAlongUvs(mesh, vectors);
  geometry::writeObj(to, mesh);
}

AlignedExpression alignExpression(const Job& job, const TextureSlide& textures, std::size_t expression) {
  const std::string& name = job.capture.expressions[expression];
  const Slide slide = textures.slideOf(name, job.guide.expressions[expression]);
  for (const CaptureMap& map : job.capture.maps) {
    const fs::path& from = map.expressions[expression];
    const fs::path to = textureFile(job, map, name, from, slide.found.moved);
    if (slide.found.moved) {
      writeSlid(job, map, from, to, slide.field);
    } else {
      copyFile(from, to);
    }
  }
  writeMesh(job, expression, slide);
  return slide.found;
}

void copyRest(const Job& job) {
  const Capture& capture = job.capture;
  const fs::path neutral = job.directory / "neutral.obj";
  if (isCopied(capture)) {
    copyFile(capture.neutral_mesh, neutral);
  } else {
    geometry::writeObj(neutral, job.face.mesh);
  }
  for (const CaptureMap& map : capture.maps) {
    copyFile(map.neutral, textureFile(job, map, "neutral", map.neutral, false));
  }
  if (capture.importance) {
    copyFile(*capture.importance, job.directory / ("importance" + capture.importance->extension().string()));
  }
  fmt::memory_buffer text;
  for (const int triangle : job.face.region) fmt::format_to(std::back_inserter(text), "{}\n", triangle);
  io::writeTextFile(job.directory / "face_region.txt", fmt::to_string(text));
}

void writeManifest(const Job& job) {
  nlohmann::ordered_json manifest;
  manifest["name"] = job.capture.name;
  if (!job.capture.unit.empty()) manifest["unit"] = job.capture.unit;
  if (job.capture.importance) manifest["importance"] = "importance" + job.capture.importance->extension().string();
  for (const CaptureMap& map : job.capture.maps) {
    nlohmann::ordered_json& entry = manifest["maps"][map.name] = nlohmann::ordered_json::object();
    if (!map.colour_space.empty()) entry["colour_space"] = map.colour_space;
    if (map.metric_weight != 1.0) entry["weight"] = map.metric_weight;
  }
  manifest["expressions"] = job.capture.expressions;
  manifest["generator"] = "facezip align";
  io::writeTextFile(job.directory / kManifest, manifest.dump(2) + "\n");
}

/// Maps may have any name: all folders at the top of the new capture are its own.
std::vector<fs::path> everyFile(const fs::path& directory) {
  std::vector<fs::path> files = {kManifest, "neutral.obj", "expressions", "face_region.txt"};
  const auto add = [&files](const std::string& name) {
    if (fs::path(name).filename() == name) files.emplace_back(name);  // at the top, whatever the file says
  };
  const nlohmann::json manifest =
      nlohmann::json::parse(io::readFile(directory / kManifest, "a capture's description"), nullptr, false);
  if (!manifest.is_object()) return files;
  if (manifest.contains("maps") && manifest["maps"].is_object()) {
    for (const auto& [name, entry] : manifest["maps"].items()) add(name);
  }
  if (manifest.contains("importance") && manifest["importance"].is_string()) {
    add(manifest["importance"].get<std::string>());
  }
  return files;
}

}  // namespace

ProtectedPaths inputsOf(const Capture& capture, const AlignmentOptions& options) {
  ProtectedPaths paths = inputsOf(capture);
  return paths.addFile(options.region == "whole" ? "" : options.region, "the region");
}

AlignmentReport alignCapture(const Capture& capture, const fs::path& output, const AlignmentOptions& options,
                             const Device& device, Progress& progress) {
  io::StageClock clock;
  inputsOf(capture, options).requireApartFromFolder(output);
  const CaptureMap& guide = guideOf(capture, options.map);
  io::StagedDirectory staged(output, {kManifest, "\"generator\": \"facezip align\"", everyFile}, &progress);
  const Job job{
      capture,          options,  guide,        compress::readFace(capture, options.region), CaptureMeshes(capture),
      device.context(), progress, staged.path()};
  const TextureSlide textures(job.face.mesh, job.face.region, guide.neutral, job.context, progress);
  AlignmentReport report;
  report.map = guide.name;
  report.flow_width = textures.width();
  copyRest(job);
  clock.book("reading");
  progress.stage("aligning textures", capture.expressions.size());
  for (std::size_t n = 0; n < capture.expressions.size(); ++n) {
    report.expressions.push_back(alignExpression(job, textures, n));
    progress.advance(n + 1);
  }
  clock.book("expressions");
  writeManifest(job);
  staged.commit();
  clock.book("publishing");
  report.seconds = clock.seconds();
  return report;
}

}  // namespace facezip
