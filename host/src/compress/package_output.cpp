#include "compress/package_output.hpp"

#include <fmt/format.h>
#include <tbb/task_group.h>

#include <span>
#include <utility>

#include "bands/map_bands.hpp"
#include "blocks/mipped_texture_writer.hpp"
#include "codes/block_weights.hpp"
#include "codes/difference_texture_encode.hpp"
#include "facezip/package.hpp"
#include "package/guides.hpp"
#include "package/package_writer.hpp"

namespace facezip::compress {
namespace {

PackageMap describeMap(const MapSolution& solution, int differences) {
  const OpenMap& map = *solution.map.map;
  const image::ImageShape& shape = map.samples->shape();
  PackageMap described;
  described.name = map.source->name;
  described.width = shape.width;
  described.height = shape.height;
  described.channels = shape.channels;
  described.sample_type = shape.type;
  described.colour_space = map.source->colour_space;
  described.weight_scale = solution.map.weight_scale;
  described.weight_set = solution.weight_set;
  described.metric_weight = map.source->metric_weight;
  described.difference_bits = solution.codes.bits;
  if (solution.neutral != nullptr) described.neutral_format = solution.neutral->format;
  for (int i = 0; i < differences; ++i) {
    PackageDifference difference;
    if (solution.neutral != nullptr) difference.format = solution.codes.formats[static_cast<std::size_t>(i)];
    for (int c = 0; c < shape.channels; ++c) {
      const TextureEncoding& e = solution.codes.encoding[static_cast<std::size_t>(i * shape.channels + c)];
      difference.scale.push_back(e.scale);
      difference.offset.push_back(e.offset);
    }
    described.differences.push_back(std::move(difference));
  }
  return described;
}

PackageDescription describe(const PackageSolution& solution) {
  PackageDescription description;
  description.name = solution.capture.name;
  description.expressions = solution.capture.expressions;
  description.differences = solution.differences;
  for (const EncodedWeights* weights : solution.weights) {
    PackageWeights& set = description.weights.emplace_back();
    set.scale = weights->scale;
    set.offset = weights->offset;
  }
  for (const MapSolution& map : solution.maps) description.maps.push_back(describeMap(map, solution.differences));
  description.method_json = solution.method_json;
  if (solution.has_mesh) description.mesh_file = package::kMeshFile;
  description.masks = solution.guides.masks;
  description.regions = solution.guides.regions;
  return description;
}

/// What the files of a map get of one band.
struct BandRows {
  int rows = 0;
  std::vector<std::byte> neutral;
  std::vector<std::byte> codes;  // [C][rows]
};

/// The files are written while the device works on the band that follows.
void writeMap(const MapSolution& solution, int index, int differences, int band_rows, BandBuffers& buffers,
              package::PackageWriter& writer, const device::Run& run) {
  const OpenMap& map = *solution.map.map;
  TextureEncoder encoder(run.context, differences);
  BandRows at_device, at_files;
  tbb::task_group files;
  const auto write = [&](const MapBand& band) {
    at_device.rows = band.end - band.begin;
    const auto rows = static_cast<std::size_t>(at_device.rows);
    const std::size_t code_bytes =
        rows * static_cast<std::size_t>(band.shape.width * band.shape.channels * solution.codes.bits / 8);
    at_device.codes.resize(code_bytes * static_cast<std::size_t>(differences));
    const cl::Buffer& textures = solution.textures->compute(solution.map, band);
    encoder.encode(band.tiles, band.shape, textures, solution.codes.encoding, solution.codes.bits, at_device.codes);
    const auto neutral = band.samples.first(rows * map.samples->shape().rowBytes());
    at_device.neutral.assign(neutral.begin(), neutral.end());
    files.wait();
    std::swap(at_device, at_files);
    files.run([&] { writer.writeNeutralRows(index, at_files.neutral, at_files.rows); });
    for (int i = 0; i < differences; ++i) {
      const auto codes = std::span(at_files.codes).subspan(static_cast<std::size_t>(i) * code_bytes, code_bytes);
      files.run([&, i, codes] { writer.writeDifferenceRows(index, i, codes, at_files.rows); });
    }
  };
  const auto make_tiles = [&](int begin, int end) { return solution.textures->tiles(map, begin, end); };
  forEachMapBand(*map.samples, band_rows, buffers, make_tiles, fmt::format("writing: {}", map.source->name),
                 run.progress, write);
  files.wait();
}

blocks::EncoderOptions mipOptions(BlockFormat format, int channels) {
  blocks::EncoderOptions options;
  options.format = format;
  options.channels = channels;
  return options;
}

}  // namespace

void writeBlockMap(const MapSolution& solution, const PackageMap& described, const std::filesystem::path& directory,
                   int band_rows, BandBuffers& buffers, const device::Run& run) {
  const OpenMap& map = *solution.map.map;
  const int width = described.width;
  const auto open = [&](const std::string& file, BlockFormat format) {
    return std::make_unique<blocks::MippedTextureWriter>(run.context, directory / file, width, described.height,
                                                         mipOptions(format, described.channels));
  };
  const auto neutral = open(described.neutral_file, solution.neutral->format);
  std::vector<std::unique_ptr<blocks::MippedTextureWriter>> differences;
  for (const PackageDifference& difference : described.differences) {
    differences.push_back(open(difference.file, *difference.format));
  }
  const auto write = [&](const MapBand& band) {
    solution.block_textures->compute(solution.map, band);
    const std::vector<float> coverage = coverageRows(*map.classes, band.begin, band.end);
    const int rows = band.end - band.begin;
    neutral->append(rows, solution.neutral->rows(band.begin, band.end), coverage);
    for (std::size_t i = 0; i < differences.size(); ++i) {
      differences[i]->append(rows, solution.block_textures->blocks(static_cast<int>(i)), coverage);
    }
  };
  const auto make_tiles = [&](int begin, int end) { return solution.block_textures->tiles(map, begin, end); };
  DecodedNeutral decoded(*solution.neutral);
  forEachMapBand(*map.samples, band_rows, buffers, make_tiles, fmt::format("writing: {}", map.source->name),
                 run.progress, write, [&](int begin, int end) { return decoded.rows(begin, end); });
  neutral->close();
  for (const auto& difference : differences) difference->close();
}

void writePackageFiles(const PackageSolution& solution, const std::filesystem::path& directory, int band_rows,
                       const device::Run& run) {
  package::PackageWriter writer(describe(solution), directory);
  tbb::task_group weights;  // beside the maps
  for (std::size_t set = 0; set < solution.weights.size(); ++set) {
    weights.run([&, set] {
      writer.writeWeights(static_cast<int>(set), std::as_bytes(std::span(solution.weights[set]->codes)));
    });
  }
  BandBuffers buffers(run.context);
  for (std::size_t m = 0; m < solution.maps.size(); ++m) {
    if (solution.maps[m].neutral != nullptr) {
      writeBlockMap(solution.maps[m], writer.description().maps[m], directory, band_rows, buffers, run);
    } else {
      writeMap(solution.maps[m], static_cast<int>(m), solution.differences, band_rows, buffers, writer, run);
    }
  }
  weights.wait();
  image::writeImage(directory / package::kMasksFile, solution.guides.picture);
  writer.finish();
}

}  // namespace facezip::compress
