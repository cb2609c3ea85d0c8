// sample_package.hpp - small packages with known contents, written by PackageWriter.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "facezip/package.hpp"
#include "package/package_writer.hpp"

namespace facezip::test {

/// A description and every sample of its images, as they were given to the writer.
struct SamplePackage {
  PackageDescription description;
  std::vector<std::vector<std::byte>> neutrals;                  // per map
  std::vector<std::vector<std::vector<std::byte>>> differences;  // per map, C
  std::vector<std::vector<std::byte>> weights;                   // per set, [N][tile_height][tile_width][C]
};

struct SampleMap {
  std::string name = "albedo";
  int width = 40;
  int height = 24;
  int channels = 3;
  SampleType type = SampleType::kUint8;
  int weight_scale = 8;
  int weight_set = 0;
  int difference_bits = 8;
};

inline std::vector<std::byte> randomBytes(std::size_t count, std::mt19937_64& random) {
  std::vector<std::byte> bytes(count);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random() >> 32);
  return bytes;
}

/// Neutral samples in [-0.5, 0.5) for float maps; any value for the others.
inline std::vector<std::byte> randomNeutral(const PackageMap& map, std::mt19937_64& random) {
  std::vector<std::byte> bytes = randomBytes(map.frameBytes(), random);
  if (map.sample_type != SampleType::kFloat32) return bytes;
  for (std::size_t s = 0; s < bytes.size() / 4; ++s) {
    const float value = s % 7 == 0 ? -0.0f : static_cast<float>(random() % 1000) * 1e-3f - 0.5f;
    std::memcpy(bytes.data() + 4 * s, &value, 4);
  }
  return bytes;
}

/// Random weight maps on the grid of the first map of each set, each set with an encoding of its own.
inline void addWeightSets(SamplePackage& sample, const std::vector<SampleMap>& maps, std::mt19937_64& random) {
  PackageDescription& description = sample.description;
  for (int set = 0;; ++set) {
    const auto map = std::find_if(maps.begin(), maps.end(), [set](const SampleMap& m) { return m.weight_set == set; });
    if (map == maps.end()) return;
    PackageWeights& weights = description.weights.emplace_back();
    for (int i = 0; i < description.differences; ++i) {
      weights.scale.push_back((1.0 + 0.1 * i + 0.07 * set) / 255.0);
      weights.offset.push_back(-0.1 * i + 0.2 * set);
    }
    const int cells =
        package::weightCells(map->width, map->weight_scale) * package::weightCells(map->height, map->weight_scale);
    const auto expressions = static_cast<int>(description.expressions.size());
    sample.weights.push_back(
        randomBytes(static_cast<std::size_t>(cells * expressions * description.differences), random));
  }
}

inline SamplePackage makeSample(const std::vector<SampleMap>& maps = {{}}, int expressions = 5, int differences = 4) {
  SamplePackage sample;
  std::mt19937_64 random(5);
  sample.description.name = "sample";
  for (int n = 0; n < expressions; ++n) sample.description.expressions.push_back(fmt::format("expression_{}", n));
  sample.description.differences = differences;
  sample.description.method_json = R"({"name":"test","seed":5})";
  for (const SampleMap& shape : maps) {
    PackageMap map;
    map.name = shape.name;
    map.width = shape.width;
    map.height = shape.height;
    map.channels = shape.channels;
    map.sample_type = shape.type;
    map.weight_scale = shape.weight_scale;
    map.weight_set = shape.weight_set;
    map.difference_bits = shape.difference_bits;
    const int codes_per_step = shape.difference_bits == 16 ? 256 : 1;  // so that both span the same differences
    sample.differences.emplace_back();
    for (int i = 0; i < differences; ++i) {
      PackageDifference difference;
      for (int c = 0; c < shape.channels; ++c) {
        difference.scale.push_back((0.4 + 0.1 * i + 0.03 * c) / codes_per_step);
        difference.offset.push_back(-difference.scale.back() * (codes_per_step * (128 - 9 * i + c)));
      }
      map.differences.push_back(difference);
      const auto samples =
          static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.height * shape.channels);
      sample.differences.back().push_back(
          randomBytes(samples * static_cast<std::size_t>(shape.difference_bits / 8), random));
    }
    sample.neutrals.push_back(randomNeutral(map, random));
    sample.description.maps.push_back(map);
  }
  addWeightSets(sample, maps, random);
  return sample;
}

/// Writes the sample's images in bands of `band` rows and fills in what the writer fills in.
inline void writeSample(SamplePackage& sample, const std::filesystem::path& directory, int band = 7) {
  std::filesystem::create_directories(directory);
  package::PackageWriter writer(sample.description, directory);
  sample.description = writer.description();
  for (std::size_t m = 0; m < sample.description.maps.size(); ++m) {
    const PackageMap& map = sample.description.maps[m];
    const int index = static_cast<int>(m);
    for (int begin = 0; begin < map.height; begin += band) {
      const int rows = std::min(band, map.height - begin);
      const auto rowsOf = [&](const std::vector<std::byte>& image) {
        const std::size_t row_bytes = image.size() / static_cast<std::size_t>(map.height);
        return std::span(image).subspan(static_cast<std::size_t>(begin) * row_bytes,
                                        static_cast<std::size_t>(rows) * row_bytes);
      };
      writer.writeNeutralRows(index, rowsOf(sample.neutrals[m]), rows);
      for (std::size_t i = 0; i < sample.differences[m].size(); ++i) {
        writer.writeDifferenceRows(index, static_cast<int>(i), rowsOf(sample.differences[m][i]), rows);
      }
    }
  }
  for (std::size_t set = 0; set < sample.weights.size(); ++set) {
    writer.writeWeights(static_cast<int>(set), sample.weights[set]);
  }
  writer.finish();
}

/// The files of a package's images, from its directory.
inline std::vector<std::string> imagesOf(const PackageDescription& description) {
  std::vector<std::string> files;
  for (const PackageWeights& weights : description.weights) {
    files.insert(files.end(), weights.files.begin(), weights.files.end());
  }
  for (const PackageMap& map : description.maps) {
    files.push_back(map.neutral_file);
    for (const PackageDifference& difference : map.differences) files.push_back(difference.file);
  }
  return files;
}

}  // namespace facezip::test
