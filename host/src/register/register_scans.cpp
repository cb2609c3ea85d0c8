// register_scans.cpp - from raw scans to a capture, scan by scan: meshes, then textures in the template's layout.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "facezip/error.hpp"
#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/length.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/registration.hpp"
#include "io/counts.hpp"
#include "io/stage_clock.hpp"
#include "io/staged_directory.hpp"
#include "register/baked_files.hpp"
#include "register/colour_drift.hpp"
#include "register/detail_maps.hpp"
#include "register/mesh_registration.hpp"
#include "register/registration_picture.hpp"
#include "register/skin_flow.hpp"
#include "register/texture_baking.hpp"

namespace facezip {
namespace {
using namespace registration;
namespace fs = std::filesystem;

constexpr const char* kManifest = "capture.json";
constexpr const char* kMap = "albedo";
constexpr const char* kNormal = "normal";
constexpr const char* kDisplacement = "displacement";
constexpr float kHeights = 4.0f;  // millimetres from black to white, as in the built-in capture
constexpr const char* kConfidence = "confidence";
constexpr const char* kPictures = "registration";
constexpr double kShownReach = 3.0;   // millimetres: as far as textures are baked from
constexpr double kLittleShown = 0.9;  // of what the neutral's scan shows

/// What all scans of a registration share.
struct Job {
  ScanFolder folder;
  RegistrationTemplate source;
  double millimetres_per_unit = 1.0;  ///< of the scans, and of the capture
  double template_unit = 1.0;         ///< millimetres
  const RegistrationOptions& options;
  device::DeviceContext& context;
  Progress& progress;
  fs::path directory;  ///< where the capture is written
};

void requireSaneOptions(const RegistrationOptions& options) {
  const auto count = [&options](const char* name) {
    return std::count(options.maps.begin(), options.maps.end(), name);
  };
  const bool known =
      count(kMap) + count(kNormal) + count(kDisplacement) == static_cast<std::ptrdiff_t>(options.maps.size());
  if (!known || count(kMap) != 1 || count(kNormal) > 1 || count(kDisplacement) > 1) {
    throw InputError({"--maps", "", "albedo, and with it normal, displacement or both, each once",
                      fmt::format("{}", fmt::join(options.maps, ",")), ""});
  }
  if (options.resolution >= 64 && options.resolution <= 16384) return;
  throw InputError({"--resolution", "", "64 to 16384", std::to_string(options.resolution), ""});
}

/// Unit of the scans; notes a guess.
geometry::LengthUnit unitOf(const RegistrationOptions& options, const fs::path& neutral, Progress& progress) {
  if (!options.unit.empty()) return geometry::parseUnit(options.unit);
  try {
    const geometry::UnitGuess guess = geometry::guessUnit(readScanMesh(neutral));
    progress.note(guess.explanation);
    return guess.unit;
  } catch (const InputError& error) {
    throw error.in(neutral.string());
  }
}

void writeMesh(const Job& job, const fs::path& file, const Eigen::MatrixX3d& positions) {
  geometry::TriangleMesh mesh = job.source.neutral;
  mesh.positions = positions / job.millimetres_per_unit;
  geometry::writeObj(file, mesh);
}

/// All of the mesh gets texels, and a gutter; what the scan does not show is filled.
raster::UvRaster layoutOf(const Job& job) {
  const int side = job.options.resolution;
  return {job.source.neutral, geometry::wholeMeshRegion(job.source.neutral), side, side, std::max(4, side / 128)};
}

bool wants(const Job& job, const char* map) {
  return std::find(job.options.maps.begin(), job.options.maps.end(), map) != job.options.maps.end();
}

/// What the scan's shape has beyond the mesh's, of the maps that are wanted.
void writeDetail(const Job& job, const std::string& name, const Eigen::MatrixX3d& mesh, const PlacedScan& placed) {
  if (!wants(job, kNormal) && !wants(job, kDisplacement)) return;
  DetailMaps maps =
      bakeDetail(layoutOf(job), job.source.neutral, mesh, placed.scan.mesh.triangles, placed.surface, job.progress);
  for (float& n : maps.normals) n = 0.5f * n + 0.5f;
  for (float& height : maps.heights) height = 0.5f + height / kHeights;
  if (wants(job, kNormal)) {
    writeTexture(job.directory / kNormal, name, {maps.side, 3, image::SampleType::kUint8, std::move(maps.normals), {}});
  }
  if (wants(job, kDisplacement)) {
    writeTexture(job.directory / kDisplacement, name,
                 {maps.side, 1, image::SampleType::kUint16, std::move(maps.heights), {}});
  }
}

/// Triangles whose textures the capture is about.
std::vector<int> regionOf(const Job& job, const RegisteredSubject& subject) {
  if (!job.source.region.empty()) return job.source.region;
  std::vector<int> region;
  for (std::size_t t = 0; t < subject.surface.seen.size(); ++t) {
    if (subject.surface.seen[t]) region.push_back(static_cast<int>(t));
  }
  return region;
}

/// Which texels of the layout lie in the region.
std::vector<bool> texelsOf(const Job& job, const std::vector<int>& region) {
  const int side = job.options.resolution;
  const raster::UvRaster raster(job.source.neutral, region, side, side, 0);
  std::vector<bool> texels;
  for (const raster::TexelSample& sample : raster.coveredRows(0, side)) {
    texels.push_back(sample.kind == raster::TexelSample::Kind::kCovered);
  }
  return texels;
}

RegisteredScan reportOf(const PlacedScan& placed, const geometry::ScanResidual& model,
                        const geometry::ScanResidual& residual, const Eigen::MatrixX3d& mesh, double coverage) {
  RegisteredScan report;
  report.name = placed.scan.name;
  report.triangles = static_cast<int>(placed.scan.mesh.triangles.rows());
  report.spikes = placed.surface.judged().spikes;
  report.roughness = placed.surface.judged().roughness;
  report.landmarks = static_cast<int>(placed.landmarks.size());
  report.landmark_rms = landmarkRms(placed.landmarks, mesh);
  report.model_mean = model.mean;
  report.model_p99 = model.percentile_99;
  report.mean = residual.mean;
  report.p99 = residual.percentile_99;
  report.matched = residual.matched;
  report.coverage = coverage;
  return report;
}

void addFlow(const FlowRounds& rounds, RegisteredScan& report) {
  report.flow_rounds = rounds.rounds;
  report.flow_before_mean = rounds.before.mean;
  report.flow_before_p95 = rounds.before.percentile_95;
  report.flow_mean = rounds.after.mean;
  report.flow_p95 = rounds.after.percentile_95;
  report.flow_trusted = rounds.after.trusted;
}

/// Millimetres from each vertex to the scan; NaN where that shows nothing.
std::vector<float> distancesFrom(const geometry::ScanSurface& scan, const Eigen::MatrixX3d& mesh) {
  std::vector<float> distances(toSize(mesh.rows()));
  tbb::parallel_for(Eigen::Index{0}, mesh.rows(), [&](Eigen::Index v) {
    const geometry::SurfacePoint point = scan.surface().closest(mesh.row(v).transpose(), kShownReach);
    const bool shown = point.found() && !scan.surface().onBorder(point);
    distances[toSize(v)] = shown ? static_cast<float>(point.distance) : std::nanf("");
  });
  return distances;
}

/// upright  the mesh as the template stands; mesh: where the scan is
void writePicture(const Job& job, const FrontView& view, const std::string& name, const Eigen::MatrixX3d& upright,
                  const Eigen::MatrixX3d& mesh, const PlacedScan& placed, const BakedTexture& texture) {
  io::createDirectories(job.directory / kPictures);
  image::writeImage(job.directory / kPictures / (name + ".png"),
                    pictureOf(view, job.source.neutral, upright, distancesFrom(placed.surface, mesh), texture));
}

/// The neutral, its texture without holes, and what they are judged by.
struct Neutral {
  RegisteredSubject subject;
  BakedTexture texture;
  std::vector<int> region;
  std::vector<bool> texels;
  std::unique_ptr<SkinFlow> flow;  ///< null without it
  FrontView view;
};

PlacedScan place(const Job& job, const fs::path& file, const geometry::TriangleMesh& mesh) {
  return placeScan(file, job.millimetres_per_unit, job.folder.landmarks, job.folder.landmark_file, job.source.landmarks,
                   mesh, job.progress);
}

BakedTexture bake(const Job& job, const Eigen::MatrixX3d& mesh, const PlacedScan& placed) {
  ScanTextures textures(job.source.neutral, mesh, job.options.resolution, placed.scan, placed.surface, job.context);
  return bakeTexture(layoutOf(job), job.source.neutral, mesh, placed.surface, textures, job.progress);
}

Neutral registerNeutralScan(Job& job, RegistrationReport& report) {
  const PlacedScan placed = place(job, job.folder.neutral, job.source.neutral);
  job.template_unit = unitOfTemplate(job.source, placed);
  Neutral neutral{
      registerNeutral(job.source, job.template_unit, placed, job.options.last_step, job.progress), {}, {}, {}, {}, {}};
  const RegisteredSubject& subject = neutral.subject;
  const Eigen::MatrixX3d mesh = subject.motion.apply(subject.neutral);
  neutral.texture = bake(job, mesh, placed);
  neutral.region = regionOf(job, subject);
  neutral.texels = texelsOf(job, neutral.region);
  report.scans.push_back(
      reportOf(placed, subject.model_residual, subject.residual, mesh, coverageOf(neutral.texture, neutral.texels)));
  report.template_scale = subject.scale;
  writeConfidence(job.directory / kConfidence, "neutral", neutral.texture);
  fillTexture(neutral.texture, nullptr);
  writeMesh(job, job.directory / "neutral.obj", subject.neutral);
  writeTexture(job.directory / kMap, "neutral", neutral.texture);
  writeDetail(job, "neutral", mesh, placed);
  neutral.view = frontOf(job.source.neutral, subject.neutral, neutral.region);
  writePicture(job, neutral.view, "neutral", subject.neutral, mesh, placed, neutral.texture);
  if (job.options.last_step >= RegistrationStep::kFlow) {
    neutral.flow =
        std::make_unique<SkinFlow>(subject.surface, job.source.neutral, placed, mesh, job.context, job.progress);
    report.flow_side = neutral.flow->side();
  }
  return neutral;
}

RegisteredScan registerExpressionScan(const Job& job, const Neutral& neutral, const fs::path& file) {
  geometry::TriangleMesh mesh = job.source.neutral;
  mesh.positions = neutral.subject.neutral;
  const PlacedScan placed = place(job, file, mesh);
  RegisteredExpression expression = registerExpression(neutral.subject, placed, job.options.last_step, job.progress);
  FlowRounds rounds;
  if (neutral.flow) {
    rounds = neutral.flow->draw(expression.pose.place(neutral.subject.expressions), expression.mesh, placed);
    expression.mesh = rounds.mesh;
    expression.residual = geometry::residualOf(neutral.subject.surface, expression.mesh, placed.surface);
  }
  const geometry::Similarity motion = headMotionOf(neutral.subject, expression.pose, expression.mesh);
  BakedTexture texture = bake(job, expression.mesh, placed);
  requireSameChannels(texture, neutral.texture, file);
  const Eigen::MatrixX3d moved = (expression.mesh.rowwise() - motion.shift) * motion.turn;
  RegisteredScan report = reportOf(placed, expression.model_residual, expression.residual, expression.mesh,
                                   coverageOf(texture, neutral.texels));
  addFlow(rounds, report);
  if (!job.options.keep_colour) {
    report.colour_gain =
        colourGains(layoutOf(job), job.source.neutral, neutral.subject.neutral, moved, neutral.texture, texture);
    takeOut(report.colour_gain, texture);
  }
  // Against the neutral's scan, which has a motion of its own from the template's place.
  const Eigen::Matrix3d turn = motion.turn * neutral.subject.motion.turn.transpose();
  report.degrees = Eigen::AngleAxisd(turn).angle() * 180.0 / std::numbers::pi;
  report.millimetres = (motion.apply(neutral.subject.neutral) - neutral.subject.motion.apply(neutral.subject.neutral))
                           .rowwise()
                           .norm()
                           .mean();
  writeConfidence(job.directory / kConfidence, report.name, texture);
  fillTexture(texture, &neutral.texture);
  writeMesh(job, job.directory / "expressions" / (report.name + ".obj"), moved);
  writeTexture(job.directory / kMap, report.name, texture);
  writeDetail(job, report.name, expression.mesh, placed);
  writePicture(job, neutral.view, report.name, moved, expression.mesh, placed, texture);
  return report;
}

void writeRegion(const fs::path& file, const std::vector<int>& region) {
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "# triangles whose textures change, from 0\n");
  for (const int triangle : region) fmt::format_to(std::back_inserter(text), "{}\n", triangle);
  io::writeTextFile(file, fmt::to_string(text));
}

void writeManifest(const Job& job, const RegistrationReport& report, const std::string& name) {
  nlohmann::ordered_json manifest;
  manifest["name"] = name;
  manifest["unit"] = report.unit;
  for (const std::string& map : job.options.maps) {  // what else holds images is no map
    manifest["maps"][map] = nlohmann::ordered_json::object();
    if (map != kMap) manifest["maps"][map]["colour_space"] = "linear";
  }
  for (std::size_t n = 1; n < report.scans.size(); ++n) manifest["expressions"].push_back(report.scans[n].name);
  manifest["generator"] = "facezip register";
  io::writeTextFile(job.directory / kManifest, manifest.dump(2) + "\n");
}

std::vector<fs::path> everyFile(const fs::path&) {
  return {kManifest, "neutral.obj", "expressions", "face_region.txt", kMap,
          kNormal,   kDisplacement, kConfidence,   kPictures};
}

}  // namespace

template <>
const std::vector<NamedValue<RegistrationStep>>& namesOf() {
  static const std::vector<NamedValue<RegistrationStep>> names = {
      {RegistrationStep::kLandmarks, "landmarks", "landmarks"},
      {RegistrationStep::kModel, "model", "model by closest points"},
      {RegistrationStep::kBending, "bending", "bending"},
      {RegistrationStep::kFlow, "flow", "optical flow"},
  };
  return names;
}

ProtectedPaths inputsOf(const fs::path& scans, const fs::path& template_directory, const RegistrationOptions& options) {
  ProtectedPaths paths;
  paths.add(scans, "the scans").add(template_directory, "the template");
  return paths.add(options.landmarks, "the landmarks");
}

RegistrationReport registerScans(const fs::path& scans, const fs::path& template_directory, const fs::path& capture,
                                 const RegistrationOptions& options, const Device& device, Progress& progress) {
  requireSaneOptions(options);
  io::StageClock clock;
  inputsOf(scans, template_directory, options).requireApartFromFolder(capture);
  io::StagedDirectory staged(capture, {kManifest, "\"generator\": \"facezip register\"", everyFile}, &progress);
  progress.stage("reading the template", 0);
  Job job{openScans(scans, options.landmarks),
          readRegistrationTemplate(template_directory),
          1.0,
          1.0,
          options,
          device.context(),
          progress,
          staged.path()};
  const geometry::LengthUnit unit = unitOf(options, job.folder.neutral, progress);
  job.millimetres_per_unit = 1000.0 * geometry::metresPerUnit(unit);
  RegistrationReport report;
  report.unit = geometry::unitSymbol(unit);
  report.unit_guessed = options.unit.empty();
  report.vertices = static_cast<int>(job.source.neutral.positions.rows());
  clock.book("reading the template");

  progress.stage("registering scans", job.folder.expressions.size() + 1);
  const Neutral neutral = registerNeutralScan(job, report);
  report.region_triangles = static_cast<int>(neutral.region.size());
  progress.advance(1);
  clock.book("neutral");
  io::createDirectories(staged.path() / "expressions");
  for (const fs::path& file : job.folder.expressions) {
    report.scans.push_back(registerExpressionScan(job, neutral, file));
    if (report.scans.back().coverage < kLittleShown) {
      progress.note(fmt::format("{}: the scan shows {:.0f} % of the region; the rest is filled from the neutral",
                                report.scans.back().name, 100.0 * report.scans.back().coverage));
    }
    progress.advance(report.scans.size());
  }
  clock.book("expressions");
  writeRegion(staged.path() / "face_region.txt", neutral.region);
  writeManifest(job, report, fs::absolute(scans).lexically_normal().filename().string());
  staged.commit();
  clock.book("publishing");
  report.seconds = clock.seconds();
  return report;
}

}  // namespace facezip
