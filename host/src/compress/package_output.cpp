#include "compress/package_output.hpp"

#include <tbb/parallel_for.h>

#include <span>

#include "compress/codes/texture_encoder.hpp"
#include "facezip/package.hpp"
#include "package/guides.hpp"
#include "package/package_writer.hpp"

namespace facezip::compress {
namespace {

PackageMap describeMap(const MapSolution& solution, int differences) {
  const OpenMap& map = *solution.map;
  const image::ImageShape& shape = map.samples->shape();
  PackageMap described;
  described.name = map.source->name;
  described.width = shape.width;
  described.height = shape.height;
  described.channels = shape.channels;
  described.sample_type = shape.type;
  described.colour_space = map.source->colour_space;
  described.weight_scale = map.weight_scale;
  described.weight_set = solution.weight_set;
  described.metric_weight = map.source->metric_weight;
  described.difference_bits = solution.bits;
  for (int i = 0; i < differences; ++i) {
    PackageDifference difference;
    for (int c = 0; c < shape.channels; ++c) {
      const TextureEncoding& e = solution.encoding[static_cast<std::size_t>(i * shape.channels + c)];
      difference.scale.push_back(e.scale);
      difference.offset.push_back(e.offset);
    }
    described.differences.push_back(std::move(difference));
  }
  return described;
}

PackageDescription describe(const Capture& capture, const PackageSolution& solution) {
  PackageDescription description;
  description.name = capture.name;
  description.expressions = capture.expressions;
  description.differences = solution.differences;
  for (const EncodedWeights& weights : solution.weights) {
    PackageWeights& set = description.weights.emplace_back();
    set.scale = weights.scale;
    set.offset = weights.offset;
  }
  for (const MapSolution& map : solution.maps) description.maps.push_back(describeMap(map, solution.differences));
  description.method_json = solution.method_json;
  if (solution.has_mesh) description.mesh_file = package::kMeshFile;
  description.masks = solution.guides.masks;
  description.regions = solution.guides.regions;
  return description;
}

void writeMap(device::DeviceContext& context, const MapSolution& solution, int index, int differences,
              const BandPass& pass, package::PackageWriter& writer) {
  TextureEncoder encoder(context, differences);
  std::vector<std::byte> codes;
  pass(*solution.map, *solution.source, [&](const MapBand& band) {
    const int rows = band.end - band.begin;
    const std::size_t bytes = static_cast<std::size_t>(rows) *
                              static_cast<std::size_t>(band.shape.width * band.shape.channels * solution.bits / 8);
    codes.resize(bytes * static_cast<std::size_t>(differences));
    const cl::Buffer& textures = solution.source->compute(*solution.map, band);
    encoder.encode(band.tiles, band.shape, textures, solution.encoding, solution.bits, codes);
    const std::size_t neutral_bytes = static_cast<std::size_t>(rows) * solution.map->samples->shape().rowBytes();
    tbb::parallel_for(-1, differences, [&](int i) {
      if (i < 0) {
        writer.writeNeutralRows(index, band.samples.first(neutral_bytes), rows);
      } else {
        writer.writeDifferenceRows(index, i, std::span(codes).subspan(static_cast<std::size_t>(i) * bytes, bytes),
                                   rows);
      }
    });
  });
}

}  // namespace

void writePackage(device::DeviceContext& context, const Capture& capture, const PackageSolution& solution,
                  const BandPass& pass, const std::filesystem::path& directory) {
  package::PackageWriter writer(describe(capture, solution), directory);
  for (std::size_t set = 0; set < solution.weights.size(); ++set) {
    writer.writeWeights(static_cast<int>(set), std::as_bytes(std::span(solution.weights[set].codes)));
  }
  for (std::size_t m = 0; m < solution.maps.size(); ++m) {
    writeMap(context, solution.maps[m], static_cast<int>(m), solution.differences, pass, writer);
  }
  image::writeImage(directory / package::kMasksFile, solution.guides.picture);
  writer.finish();
}

}  // namespace facezip::compress
