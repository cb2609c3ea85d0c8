// facezip_runtime.cpp - the C interface over Package and Blender: checks arguments, turns exceptions into a status.
#include "facezip/facezip_runtime.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "blend/shape_names.hpp"
#include "blocks/block_format.hpp"
#include "blocks/block_texture.hpp"
#include "blocks/texture_file.hpp"
#include "facezip/blend.hpp"
#include "facezip/version.hpp"
#include "io/composed.hpp"
#include "io/counts.hpp"
#include "io/folder.hpp"
#include "package/package_textures.hpp"
#include "package/weight_atlas.hpp"

struct facezip_package {
  facezip::PackageDescription description;
  std::optional<facezip::Blender> blender;   // one of the two
  std::optional<facezip::Package> files;     // stay open
  std::vector<std::vector<int32_t>> levels;  // of every map's textures, the neutral first
};

namespace {

thread_local std::string g_last_error;

/// An argument that the caller should not have given.
class ArgumentError : public facezip::Error {
 public:
  using facezip::Error::Error;
};

facezip_status fail(facezip_status status, const char* text) noexcept {
  try {
    g_last_error = text;
  } catch (const std::bad_alloc&) {
    g_last_error.clear();
  }
  return status;
}

/// Runs `step` and turns what it throws into a status.
template <typename Step>
facezip_status guarded(const Step& step) noexcept {
  try {
    step();
    return FACEZIP_OK;
  } catch (const ArgumentError& error) {
    return fail(FACEZIP_ERROR_ARGUMENT, error.what());
  } catch (const facezip::DeviceError& error) {
    return fail(FACEZIP_ERROR_DEVICE, error.what());
  } catch (const facezip::InputError& error) {
    return fail(FACEZIP_ERROR_INPUT, error.what());
  } catch (const std::bad_alloc&) {
    return fail(FACEZIP_ERROR_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return fail(FACEZIP_ERROR_OTHER, error.what());
  } catch (...) {
    return fail(FACEZIP_ERROR_OTHER, "unknown failure");
  }
}

void require(bool holds, const char* message) {
  if (!holds) throw ArgumentError(message);
}

const facezip::PackageMap& mapOf(const facezip_package* package, int32_t map) {
  require(package != nullptr, "package is null");
  const auto& maps = package->description.maps;
  if (map < 0 || static_cast<std::size_t>(map) >= maps.size()) {
    throw ArgumentError(fmt::format("map: expected 0 to {}, got {}", maps.size() - 1, map));
  }
  return maps[static_cast<std::size_t>(map)];
}

/// A texture as the package stores it; its levels are in its file.
facezip::package::StoredTexture textureOf(const facezip_package* package, int32_t map, int32_t texture) {
  const facezip::PackageMap& found = mapOf(package, map);
  const auto count = static_cast<int32_t>(found.differences.size());
  if (texture < 0 || texture > count)
    throw ArgumentError(fmt::format("texture: expected 0 to {}, got {}", count, texture));
  return texture == 0 ? facezip::package::neutralTexture(found)
                      : facezip::package::differenceTexture(found, texture - 1);
}

int32_t levelsOf(const facezip_package* package, int32_t map, int32_t texture) {
  return package->levels[static_cast<std::size_t>(map)][static_cast<std::size_t>(texture)];
}

/// Mip levels as the files have them; images have one.
std::vector<std::vector<int32_t>> levelsIn(const facezip::Package& package) {
  std::vector<std::vector<int32_t>> levels;
  for (const facezip::PackageMap& map : package.maps()) {
    std::vector<int32_t>& of_map = levels.emplace_back();
    const auto add = [&](const facezip::package::StoredTexture& texture) {
      of_map.push_back(texture.format ? facezip::package::openBlocks(package.folder(), texture).texture().levels : 1);
    };
    add(facezip::package::neutralTexture(map));
    for (int i = 0; i < package.differences(); ++i) add(facezip::package::differenceTexture(map, i));
  }
  return levels;
}

std::size_t levelBytes(const facezip::package::StoredTexture& texture, int32_t level) {
  const facezip::image::ImageShape& shape = texture.shape;
  if (!texture.format) return facezip::toSize(shape.height) * shape.rowBytes();
  return facezip::blocks::blockBytes(*texture.format, facezip::blocks::levelSide(shape.width, level),
                                     facezip::blocks::levelSide(shape.height, level));
}

std::size_t weightBytes(const facezip_package* package, const facezip::PackageMap& map) {
  const facezip::PackageDescription& description = package->description;
  const facezip::PackageWeights& weights = description.weights[static_cast<std::size_t>(map.weight_set)];
  return description.expressions.size() * facezip::toSize(weights.tile_height, weights.tile_width) *
         facezip::toSize(description.differences);
}

const facezip::Package& filesOf(const facezip_package* package) {
  require(package->files.has_value(), "package: expected one that facezip_open() gave, its files are not open");
  return *package->files;
}

facezip::Blender& blenderOf(facezip_package* package) {
  require(package != nullptr, "package is null");
  require(package->blender.has_value(), "package: expected one that facezip_load() gave, it is on no device");
  return *package->blender;
}

facezip_sample_type sampleType(facezip::SampleType type) {
  switch (type) {
    case facezip::SampleType::kUint8:
      return FACEZIP_UINT8;
    case facezip::SampleType::kUint16:
      return FACEZIP_UINT16;
    case facezip::SampleType::kFloat32:
      break;
  }
  return FACEZIP_FLOAT32;
}

/// The weights, checked here so that the text names arguments of this interface.
std::span<const float> checkedWeights(const facezip_package* package, const float* weights, std::size_t count) {
  require(package != nullptr, "package is null");
  const auto& names = package->description.expressions;
  if (count != names.size()) {
    throw ArgumentError(fmt::format("count: expected {}, one weight per expression, got {}", names.size(), count));
  }
  require(weights != nullptr, "weights is null");
  for (std::size_t n = 0; n < count; ++n) {
    if (!(std::abs(weights[n]) <= facezip::kLargestWeight)) {
      throw ArgumentError(fmt::format("weights[{}] ({}): expected a number of at most {:g} either way, got {}", n,
                                      names[n], facezip::kLargestWeight, weights[n]));
    }
  }
  return {weights, count};
}

}  // namespace

int32_t facezip_runtime_abi(void) { return FACEZIP_RUNTIME_ABI; }

const char* facezip_runtime_version(void) { return FACEZIP_VERSION; }

const char* facezip_last_error(void) { return g_last_error.c_str(); }

facezip_status facezip_load(const char* directory, const char* device, facezip_package** package) {
  if (package != nullptr) *package = nullptr;
  return guarded([&] {
    require(package != nullptr, "package is null");
    require(directory != nullptr, "directory is null");
    *package = facezip::withPackage(directory, [&](const facezip::Package& opened) {
      facezip::Blender blender(opened, facezip::openDevice(device == nullptr ? "auto" : device));
      return new facezip_package{opened.description(), std::move(blender), std::nullopt, levelsIn(opened)};
    });
  });
}

facezip_status facezip_open(const char* directory, facezip_package** package) {
  if (package != nullptr) *package = nullptr;
  return guarded([&] {
    require(package != nullptr, "package is null");
    require(directory != nullptr, "directory is null");
    facezip::Package opened = facezip::Package::open(directory);
    facezip::PackageDescription description = opened.description();
    std::vector<std::vector<int32_t>> levels = levelsIn(opened);
    *package = new facezip_package{std::move(description), std::nullopt, std::move(opened), std::move(levels)};
  });
}

void facezip_free(facezip_package* package) { delete package; }

int32_t facezip_expression_count(const facezip_package* package) {
  return package == nullptr ? 0 : static_cast<int32_t>(package->description.expressions.size());
}

const char* facezip_expression_name(const facezip_package* package, int32_t expression) {
  if (expression < 0 || expression >= facezip_expression_count(package)) return nullptr;
  return package->description.expressions[static_cast<std::size_t>(expression)].c_str();
}

int32_t facezip_find_expression(const facezip_package* package, const char* name) {
  if (package == nullptr || name == nullptr) return -1;
  int32_t index = -1;
  guarded([&] {
    if (const auto found = facezip::blend::findName(name, package->description.expressions)) {
      index = static_cast<int32_t>(*found);
    }
  });
  return index;
}

int32_t facezip_map_count(const facezip_package* package) {
  return package == nullptr ? 0 : static_cast<int32_t>(package->description.maps.size());
}

int32_t facezip_find_map(const facezip_package* package, const char* name) {
  if (package == nullptr || name == nullptr) return -1;
  const auto& maps = package->description.maps;
  const auto found = std::find_if(
      maps.begin(), maps.end(), [wanted = facezip::io::composed(name)](const auto& map) { return map.name == wanted; });
  return found == maps.end() ? -1 : static_cast<int32_t>(found - maps.begin());
}

facezip_status facezip_get_map_info(const facezip_package* package, int32_t map, facezip_map_info* info) {
  return guarded([&] {
    const facezip::PackageMap& found = mapOf(package, map);
    require(info != nullptr, "info is null");
    // The first version of the structure; a later one fills in as much as struct_size has room for.
    require(info->struct_size == sizeof(facezip_map_info), "info->struct_size: expected sizeof(facezip_map_info)");
    info->name = found.name.c_str();
    info->colour_space = found.colour_space.c_str();
    info->width = found.width;
    info->height = found.height;
    info->channels = found.channels;
    info->sample_type = sampleType(found.sample_type);
    info->frame_bytes = found.frameBytes();
  });
}

facezip_status facezip_get_texture_info(const facezip_package* package, int32_t map, int32_t texture,
                                        facezip_texture_info* info) {
  return guarded([&] {
    const facezip::package::StoredTexture stored = textureOf(package, map, texture);
    require(info != nullptr, "info is null");
    require(info->struct_size == sizeof(facezip_texture_info),
            "info->struct_size: expected sizeof(facezip_texture_info)");
    *info = {};
    info->struct_size = sizeof(facezip_texture_info);
    info->format = "";
    info->width = stored.shape.width;
    info->height = stored.shape.height;
    info->channels = stored.shape.channels;
    info->sample_type = stored.format ? FACEZIP_UINT8 : sampleType(stored.shape.type);
    info->block_width = info->block_height = 1;
    info->block_bytes = stored.shape.channels * static_cast<int32_t>(facezip::image::sampleBytes(stored.shape.type));
    if (stored.format) {
      const facezip::blocks::BlockFormatInfo& format = facezip::blocks::infoOf(*stored.format);
      info->format = format.name.data();  // of a literal
      info->vk_format = format.vk_unorm;
      info->dxgi_format = format.dxgi_unorm;
      info->block_width = format.block_width;
      info->block_height = format.block_height;
      info->block_bytes = format.block_bytes;
    }
    info->levels = levelsOf(package, map, texture);
    for (int32_t level = 0; level < info->levels; ++level) info->bytes += levelBytes(stored, level);
    std::fill_n(info->scale, 4, 1.0);
    if (texture == 0) return;
    const facezip::PackageDifference& difference =
        mapOf(package, map).differences[static_cast<std::size_t>(texture - 1)];
    std::ranges::copy(difference.scale, info->scale);
    std::ranges::copy(difference.offset, info->offset);
  });
}

size_t facezip_level_bytes(const facezip_package* package, int32_t map, int32_t texture, int32_t level) {
  std::size_t bytes = 0;
  guarded([&] {
    const facezip::package::StoredTexture stored = textureOf(package, map, texture);
    if (0 <= level && level < levelsOf(package, map, texture)) bytes = levelBytes(stored, level);
  });
  return bytes;
}

facezip_status facezip_read_level(const facezip_package* package, int32_t map, int32_t texture, int32_t level,
                                  void* data, size_t bytes) {
  return guarded([&] {
    const facezip::package::StoredTexture stored = textureOf(package, map, texture);
    if (level < 0 || level >= levelsOf(package, map, texture)) {
      throw ArgumentError(fmt::format("level: expected 0 to {}, got {}", levelsOf(package, map, texture) - 1, level));
    }
    require(data != nullptr, "data is null");
    if (bytes != levelBytes(stored, level)) {
      throw ArgumentError(fmt::format("bytes: expected {}, got {}", levelBytes(stored, level), bytes));
    }
    const std::span out(static_cast<std::byte*>(data), bytes);
    const facezip::io::Folder& folder = filesOf(package).folder();
    if (!stored.format) return facezip::package::TextureReader(folder, stored).readRows(0, stored.shape.height, out);
    const facezip::blocks::TextureFileReader reader = facezip::package::openBlocks(folder, stored);
    reader.readRows(level, 0, static_cast<int>(bytes / facezip::blocks::blockRowBytes(reader.texture(), level)), out);
  });
}

facezip_status facezip_get_weights_info(const facezip_package* package, int32_t map, facezip_weights_info* info) {
  return guarded([&] {
    const facezip::PackageMap& found = mapOf(package, map);
    require(info != nullptr, "info is null");
    require(info->struct_size == sizeof(facezip_weights_info),
            "info->struct_size: expected sizeof(facezip_weights_info)");
    const facezip::PackageWeights& weights = package->description.weights[static_cast<std::size_t>(found.weight_set)];
    *info = {};
    info->struct_size = sizeof(facezip_weights_info);
    info->set = found.weight_set;
    info->columns = weights.tile_width;
    info->rows = weights.tile_height;
    info->channels = package->description.differences;
    info->weight_scale = found.weight_scale;
    info->bytes = weightBytes(package, found);
    std::ranges::copy(weights.scale, info->scale);
    std::ranges::copy(weights.offset, info->offset);
  });
}

facezip_status facezip_read_weights(const facezip_package* package, int32_t map, void* codes, size_t bytes) {
  return guarded([&] {
    const facezip::PackageMap& found = mapOf(package, map);
    require(codes != nullptr, "codes is null");
    if (bytes != weightBytes(package, found)) {
      throw ArgumentError(fmt::format("bytes: expected {}, got {}", weightBytes(package, found), bytes));
    }
    const facezip::Package& files = filesOf(package);
    facezip::package::readWeightCodes(files.description(), found.weight_set, files.folder(),
                                      std::span(static_cast<std::byte*>(codes), bytes));
  });
}

facezip_status facezip_set_weights(facezip_package* package, const float* weights, size_t count) {
  return guarded([&] {
    const std::span<const float> beta = checkedWeights(package, weights, count);
    blenderOf(package).setWeights(beta);
  });
}

facezip_status facezip_blend(facezip_package* package, int32_t map, void* frame, size_t bytes) {
  return guarded([&] {
    const facezip::PackageMap& found = mapOf(package, map);
    require(frame != nullptr, "frame is null");
    if (bytes != found.frameBytes()) {
      throw ArgumentError(
          fmt::format("bytes: expected {}, a frame of {}, got {}", found.frameBytes(), found.name, bytes));
    }
    blenderOf(package).blend(map, std::span(static_cast<std::byte*>(frame), bytes));
  });
}
