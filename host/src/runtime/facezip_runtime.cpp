// facezip_runtime.cpp - the C interface over Package and Blender: checks arguments, turns exceptions into a status.
#include "facezip/facezip_runtime.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <span>
#include <string>

#include "blend/shape_names.hpp"
#include "facezip/blend.hpp"
#include "facezip/version.hpp"
#include "io/composed.hpp"

struct facezip_package {
  facezip::PackageDescription description;  // no Package, whose files would stay open
  facezip::Blender blender;
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
      return new facezip_package{opened.description(), std::move(blender)};
    });
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

facezip_status facezip_set_weights(facezip_package* package, const float* weights, size_t count) {
  return guarded([&] {
    const std::span<const float> beta = checkedWeights(package, weights, count);
    package->blender.setWeights(beta);
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
    package->blender.blend(map, std::span(static_cast<std::byte*>(frame), bytes));
  });
}
