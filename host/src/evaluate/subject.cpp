#include "evaluate/subject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "bands/map_bands.hpp"
#include "compress/band_plan.hpp"
#include "compress/method_record.hpp"
#include "facezip/rig.hpp"
#include "io/quoted.hpp"

namespace facezip::evaluate {
namespace {

std::string packageFile(const Package& package) { return (package.directory() / "package.json").string(); }

/// What each expression of a capture is in a rig's package.
struct RiggedExpressions {
  std::vector<std::size_t> kept;              ///< expressions of the capture that the package has
  std::vector<std::vector<float>> as_packed;  ///< of these
  std::vector<std::vector<float>> as_rigged;
};

RiggedExpressions riggedExpressions(const Capture& capture, const Package& package, bool shapes) {
  const Rig rig = openRig(package);
  const auto indexIn = [](const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - names.begin()));
  };
  std::unordered_map<std::string, std::size_t> packed_index;  // a million weights are looked up in the worst case
  for (const std::string& name : package.expressions()) packed_index.emplace(name, packed_index.size());
  const auto inPackage = [&](const std::string& name) {
    const auto index = packed_index.find(name);
    if (index == packed_index.end()) {
      throw InputError({packageFile(package), "expressions", "the names of rig.json", "no " + name, "make it again"});
    }
    return index->second;
  };
  RiggedExpressions found;
  for (std::size_t e = 0; e < capture.expressions.size(); ++e) {
    const std::optional<std::size_t> n = indexIn(shapes ? rig.shapes : rig.expressions, capture.expressions[e]);
    if (!n) continue;
    found.kept.push_back(e);
    std::vector<float>& packed = found.as_packed.emplace_back(package.expressions().size(), 0.0f);
    packed[inPackage(shapes ? rig.shapes[*n] : rig.package_expressions[*n])] = 1.0f;
    if (shapes) continue;
    std::vector<float>& rigged = found.as_rigged.emplace_back(package.expressions().size(), 0.0f);
    for (std::size_t m = 0; m < rig.shapes.size(); ++m) {
      rigged[inPackage(rig.shapes[m])] = static_cast<float>(rig.weights[*n][m]);
    }
  }
  if (found.kept.empty()) {
    throw InputError({packageFile(package), shapes ? "shapes" : "expressions",
                      fmt::format("some of the expressions of {}", capture.directory.string()), "none of these names",
                      shapes ? "" : "--shapes evaluates single shapes of a rig"});
  }
  return found;
}

/// The capture with these expressions alone.
Capture withExpressions(const Capture& capture, const std::vector<std::size_t>& kept) {
  Capture part = capture;
  part.expressions.clear();
  part.expression_meshes.clear();
  for (CaptureMap& map : part.maps) map.expressions.clear();
  for (const std::size_t e : kept) {
    part.expressions.push_back(capture.expressions[e]);
    part.expression_meshes.push_back(capture.expression_meshes[e]);
    for (std::size_t m = 0; m < part.maps.size(); ++m) {
      part.maps[m].expressions.push_back(capture.maps[m].expressions[e]);
    }
  }
  return part;
}

/// The capture's maps that the package has, in the package's order; refuses a package of another capture.
Capture matchingCapture(const Capture& capture, const Package& package, bool rigged) {
  if (!rigged && capture.expressions != package.expressions()) {
    const auto [captured, packed] = std::ranges::mismatch(capture.expressions, package.expressions());
    const auto named = [](const auto& name, const auto& end) { return name == end ? "none" : io::quoted(*name); };
    throw InputError(
        {packageFile(package), fmt::format("expressions[{}]", packed - package.expressions().begin()),
         fmt::format("{}, as {} has it", named(captured, capture.expressions.end()), capture.directory.string()),
         named(packed, package.expressions().end()), "evaluate against the capture it was made of"});
  }
  Capture matching = capture;
  matching.maps.clear();
  for (const PackageMap& map : package.maps()) {
    const auto found =
        std::find_if(capture.maps.begin(), capture.maps.end(), [&](const CaptureMap& m) { return m.name == map.name; });
    if (found == capture.maps.end()) {
      throw InputError({packageFile(package), fmt::format("map \"{}\"", map.name),
                        fmt::format("a map of {}", capture.directory.string()), "none of that name", ""});
    }
    matching.maps.push_back(*found);
  }
  return matching;
}

}  // namespace

Subject makeSubject(const Capture& capture, const Package& package, std::uint64_t memory_bytes, bool shapes,
                    const Device& device, Progress& progress) {
  const bool rigged = isRig(package);
  if (shapes && !rigged) {
    throw InputError({package.directory().string(), "--shapes", "a package that `facezip rig` made", "another", ""});
  }
  RiggedExpressions expressions;
  if (rigged) expressions = riggedExpressions(capture, package, shapes);
  Subject subject{matchingCapture(rigged ? withExpressions(capture, expressions.kept) : capture, package, rigged),
                  compress::optionsFromMethodJson(package.methodJson(), packageFile(package)),
                  device,
                  progress,
                  {},
                  std::move(expressions.as_packed),
                  std::move(expressions.as_rigged)};
  subject.recorded.memory_bytes = memory_bytes;
  subject.recorded.mesh = false;  // baselines are for their errors alone
  subject.face = compress::readFace(subject.capture, subject.recorded.region);
  return subject;
}

void requireSameShape(const compress::OpenMap& map, const PackageMap& packed, const Package& package) {
  const image::ImageShape& shape = map.samples->shape();
  const image::ImageShape got{packed.width, packed.height, packed.channels, packed.sample_type};
  if (shape == got) return;
  throw InputError({packageFile(package), fmt::format("map \"{}\"", packed.name),
                    fmt::format("{} x {}, {} channels as in the capture", shape.width, shape.height, shape.channels),
                    fmt::format("{} x {}, {} channels", got.width, got.height, got.channels),
                    "compress the capture again"});
}

compress::MapSet openMaps(const Subject& subject) {
  compress::MapSet maps = compress::openMaps(subject.capture);
  compress::makeRasters(maps, subject.face.mesh, subject.face.region, {.gutter = 0});
  return maps;
}

int bandRows(const Subject& subject, const compress::OpenMap& map, const std::vector<PackageDecoder*>& decoders,
             std::uint64_t beside_bytes) {
  int textures = 2;  // captured and decoded values
  std::uint64_t resident = beside_bytes;
  for (const PackageDecoder* decoder : decoders) {
    textures += decoder->package().differences() + 1;
    resident += decoder->residentBytes();
  }
  const compress::BandCost cost = compress::bandCost(compress::bandShape(*map.samples, 0), textures, 0);
  return compress::planBandRows(cost, map.samples->shape().height, subject.recorded.memory_bytes, resident,
                                subject.device.info());
}

}  // namespace facezip::evaluate
