// difference.hpp - differences to the neutral, Delta_n = I_n - I_0 (in FaceZip, Eq. 1 and 2), cut into tiles.
#pragma once

#include <cstddef>
#include <string>

#include "bands/device_tiles.hpp"
#include "bands/tile_band.hpp"
#include "device/device_context.hpp"

namespace facezip::compress {

/// Bytes of the differences of `tile_count` tiles: [tile][expression][channel][256], 16-bit integers for 8-bit samples
/// and floats for all others.
std::size_t differenceBufferBytes(const BandShape& shape, std::size_t tile_count);

/// Computes the differences of every tile, in units of 1/255 of full scale (8-bit samples: exact).
/// times the fades of the tiles where they have such (8-bit: rounded). Texels that hang over the image are 0. Returns
/// the event of the kernel; does not wait. shape        what `samples` holds samples      shape.sampleBytes() bytes:
/// [image][row][column][channel], image 0 is the neutral, n + 1 expression n differences  at least
/// differenceBufferBytes(shape, tiles.tileCount()) bytes Throws DeviceError if a buffer is too small or the device
/// fails.
cl::Event computeDifferences(device::DeviceContext& context, const DeviceTiles& tiles, const BandShape& shape,
                             const cl::Buffer& samples, const cl::Buffer& differences);

/// The same to what a coded neutral decodes to. shape.neutral_decoded is set; image 0 of the samples is not looked at.
/// neutral  shape.neutralBytes(): [row][column][channel] float in units of 1/255 of full scale
cl::Event computeDifferences(device::DeviceContext& context, const DeviceTiles& tiles, const BandShape& shape,
                             const cl::Buffer& samples, const cl::Buffer& neutral, const cl::Buffer& differences);

/// "-D DIFF_T=... -D CHANNELS=..." for the kernels that read differences of `shape`.
std::string differenceDefines(const BandShape& shape);

}  // namespace facezip::compress
