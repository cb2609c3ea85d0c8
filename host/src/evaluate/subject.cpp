#include "evaluate/subject.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "compress/band_plan.hpp"
#include "compress/map_bands.hpp"
#include "compress/method_record.hpp"

namespace facezip::evaluate {
namespace {

std::string packageFile(const Package& package) { return (package.directory() / "package.json").string(); }

/// The capture's maps that the package has, in the package's order; refuses a package of another capture.
Capture matchingCapture(const Capture& capture, const Package& package) {
  if (capture.expressions != package.expressions()) {
    throw InputError(
        {packageFile(package), "expressions",
         fmt::format("the {} expressions of {}, in its order", capture.expressions.size(), capture.directory.string()),
         fmt::format("{} expressions", package.expressions().size()), "evaluate against the capture it was made of"});
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

Subject makeSubject(const Capture& capture, const Package& package, std::uint64_t memory_bytes, const Device& device,
                    Progress& progress) {
  Subject subject{matchingCapture(capture, package),
                  compress::optionsFromMethodJson(package.methodJson(), packageFile(package)),
                  device,
                  progress,
                  {}};
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
  compress::makeRasters(maps, subject.face, 0);
  assignWeightScales(maps, subject.recorded.weight_scale);
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
