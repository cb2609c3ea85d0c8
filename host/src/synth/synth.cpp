#include "facezip/synth.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "facezip/error.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "synth/actions.hpp"
#include "synth/expressions.hpp"
#include "synth/head_mesh.hpp"
#include "synth/noise.hpp"
#include "synth/texture_painter.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

// Each band recomputes a margin of ten rows of skin: 64 keeps that at a sixth, and 16384 texels of width below 200 MB.
constexpr int kBandRows = 64;
constexpr const char* kManifest = "capture.json";

std::string knownMaps() {
  std::string names;
  for (const synth::MapFormat& format : synth::mapFormats())
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

void requireRange(const char* option, int value, int low, int high) {
  if (value >= low && value <= high) return;
  throw InputError({option, "", fmt::format("{} to {}", low, high), std::to_string(value), ""});
}

/// The formats that `options.maps` names, in its order.
std::vector<synth::MapFormat> chosenFormats(const SynthOptions& options) {
  requireRange("--resolution", options.resolution, 64, 16384);
  requireRange("--expressions", options.expressions, 1, 100);
  if (options.maps.empty()) throw InputError({"--maps", "", "at least one of " + knownMaps(), "none", ""});
  std::vector<synth::MapFormat> formats;
  for (const std::string& name : options.maps) {
    const auto& known = synth::mapFormats();
    const auto format = std::find_if(known.begin(), known.end(), [&](const auto& f) { return f.name == name; });
    if (format == known.end()) throw InputError({"--maps", name, "one of " + knownMaps(), "an unknown map", ""});
    const bool repeated = std::any_of(formats.begin(), formats.end(), [&](const auto& f) { return f.name == name; });
    if (repeated) throw InputError({"--maps", name, "each map once", "the map twice", "remove one"});
    formats.push_back(*format);
  }
  return formats;
}

/// Texture coordinates and faces are the same in every file, so their text is made once.
std::string objTail(const geometry::TriangleMesh& mesh) {
  fmt::memory_buffer text;
  for (Eigen::Index v = 0; v < mesh.uvs.rows(); ++v) {
    fmt::format_to(std::back_inserter(text), "vt {:.8f} {:.8f}\n", mesh.uvs(v, 0), mesh.uvs(v, 1));
  }
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    fmt::format_to(std::back_inserter(text), "f {0}/{0} {1}/{1} {2}/{2}\n", mesh.triangles(f, 0) + 1,
                   mesh.triangles(f, 1) + 1, mesh.triangles(f, 2) + 1);
  }
  return fmt::to_string(text);
}

/// A tenth of a micrometre is far below what a scanner resolves.
void writeObj(const fs::path& path, const Eigen::MatrixX3d& positions, const std::string& tail) {
  fmt::memory_buffer text;
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    fmt::format_to(std::back_inserter(text), "v {:.7f} {:.7f} {:.7f}\n", positions(v, 0), positions(v, 1),
                   positions(v, 2));
  }
  io::writeTextFile(path, fmt::to_string(text) + tail);
}

void writeManifest(const fs::path& folder, const SynthOptions& options, const std::vector<synth::MapFormat>& formats,
                   const std::vector<synth::Expression>& expressions) {
  nlohmann::ordered_json manifest;
  manifest["name"] = fmt::format("synthetic head {}", options.seed);
  manifest["unit"] = "m";
  for (const synth::MapFormat& format : formats) manifest["maps"][format.name]["colour_space"] = format.colour_space;
  for (const synth::Expression& expression : expressions) manifest["expressions"].push_back(expression.name);
  manifest["generator"] = "facezip synth";
  manifest["seed"] = options.seed;
  io::writeTextFile(folder / kManifest, manifest.dump(2) + "\n");
}

/// What the subject performed, by the template's names; a strong performer goes beyond 1.
void writeWeights(const fs::path& folder, const std::vector<synth::Expression>& expressions) {
  nlohmann::ordered_json weights;
  for (const synth::Expression& expression : expressions) {
    for (const auto& [action, weight] : expression.actions) weights[expression.name][action->name] = weight;
  }
  io::writeTextFile(folder / "weights.json", weights.dump(2) + "\n");
}

/// Makes the meshes, writes them, and returns what painting needs of each: the neutral first.
std::vector<synth::Performance> performAll(const fs::path& folder, const synth::HeadShape& shape,
                                           const synth::HeadMesh& head,
                                           const std::vector<synth::Expression>& expressions, std::uint64_t seed,
                                           Progress& progress) {
  using Subject = synth::Scanner::Subject;
  const std::string tail = objTail(head.mesh);
  io::createDirectories(folder / "expressions");
  std::vector<synth::Performance> performances(
      1, {"neutral", {}, 0.0, synth::Scanner(synth::deriveSeed(seed, "neutral"), Subject::kNeutral)});
  for (const synth::Expression& expression : expressions) {
    performances.push_back(
        {expression.name, {}, expression.flush, synth::Scanner(expression.take, Subject::kExpression)});
  }
  progress.stage("meshes", performances.size());
  tbb::parallel_for(std::size_t{0}, performances.size(), [&](std::size_t i) {
    progress.checkCancelled();
    const bool neutral = i == 0;
    const Eigen::MatrixX3d positions =
        neutral ? head.mesh.positions : synth::deform(head, shape, expressions[i - 1].actions, expressions[i - 1].take);
    writeObj(neutral ? folder / "neutral.obj" : folder / "expressions" / (expressions[i - 1].name + ".obj"), positions,
             tail);
    performances[i].states = synth::skinStates(head, positions);
  });
  progress.advance(performances.size());
  return performances;
}

/// Paints every texture of the capture from top to bottom, all side by side: what they share of a band is made once.
void paintAll(const fs::path& folder, const synth::TexturePainter& painter,
              const std::vector<synth::Performance>& performances, const std::vector<synth::MapFormat>& formats,
              Progress& progress) {
  const int resolution = painter.resolution();
  std::vector<std::vector<image::ImageWriter>> writers(performances.size());
  for (const synth::MapFormat& format : formats) {
    io::createDirectories(folder / format.name);
    for (std::size_t i = 0; i < performances.size(); ++i) {
      writers[i].emplace_back(folder / format.name / (performances[i].name + ".png"),
                              image::ImageShape{resolution, resolution, format.channels, format.type},
                              format.colour_space);
    }
  }
  progress.stage("textures", static_cast<std::size_t>((resolution + kBandRows - 1) / kBandRows));
  std::size_t bands_done = 0;
  for (int begin = 0; begin < resolution; begin += kBandRows) {
    progress.checkCancelled();
    const int end = std::min(begin + kBandRows, resolution);
    const synth::SkinBand skin = painter.skinBand(begin, end);
    tbb::parallel_for(std::size_t{0}, performances.size(), [&](std::size_t i) {
      const std::vector<std::vector<std::byte>> bands = painter.paint(performances[i], skin, begin, end, formats);
      for (std::size_t m = 0; m < formats.size(); ++m) writers[i][m].writeRows(bands[m], end - begin);
    });
    progress.advance(++bands_done);
  }
  for (std::vector<image::ImageWriter>& of_one : writers) {
    for (image::ImageWriter& writer : of_one) writer.close();
  }
}

/// A template to rig with: every single action, by a face of other proportions in the same topology.
void writeRigTemplate(const fs::path& folder, std::uint64_t seed, Progress& progress) {
  const std::uint64_t template_seed = synth::deriveSeed(seed, "rig template");
  const synth::HeadShape shape(template_seed);
  const synth::HeadMesh head(shape);
  const std::string tail = objTail(head.mesh);
  const std::vector<synth::Action>& actions = synth::actionBasis();
  io::createDirectories(folder);
  writeObj(folder / "neutral.obj", head.mesh.positions, tail);
  progress.stage("template", actions.size());
  tbb::parallel_for(std::size_t{0}, actions.size(), [&](std::size_t i) {
    progress.checkCancelled();
    writeObj(folder / (actions[i].name + ".obj"), synth::deform(head, shape, {{&actions[i], 1.0}}, template_seed),
             tail);
  });
  progress.advance(actions.size());
}

/// What this may have written with any options.
std::vector<fs::path> everyFile(const fs::path&) {
  std::vector<fs::path> files = {kManifest, "neutral.obj", "expressions", "template", "weights.json"};
  for (const synth::MapFormat& format : synth::mapFormats()) files.emplace_back(format.name);
  return files;
}

}  // namespace

void synthesizeCapture(const fs::path& output, const SynthOptions& options, Progress& progress) {
  const std::vector<synth::MapFormat> formats = chosenFormats(options);
  io::StagedDirectory staged(output, {kManifest, "\"generator\": \"facezip synth\"", everyFile}, &progress);
  const synth::HeadShape shape(options.seed);
  const synth::HeadMesh head(shape);
  const std::vector<synth::Expression> expressions = synth::makeExpressions(options.expressions, options.seed);
  const std::vector<synth::Performance> performances =
      performAll(staged.path(), shape, head, expressions, options.seed, progress);
  const synth::TexturePainter painter(head, options.seed, options.resolution);
  paintAll(staged.path(), painter, performances, formats, progress);
  if (options.rig_template) {
    writeRigTemplate(staged.path() / "template", options.seed, progress);
    writeWeights(staged.path(), expressions);
  }
  writeManifest(staged.path(), options, formats, expressions);
  staged.commit();
}

}  // namespace facezip
