/* facezip_runtime.h - loads packages and blends frames, from C and from whatever calls C (engines, Python's ctypes).
 *
 * Frames are those of facezip's C++ Blender, bit for bit. No C++ type and no exception crosses this interface: calls
 * return a status, and facezip_last_error() says in words what went wrong.
 *
 * Threads    A facezip_package may be used by one thread at a time, any thread; different ones by different threads at
 *            once. The functions without a facezip_package may be called at any time.
 * Memory     All memory of textures and weights, on host and device, is taken in facezip_load(). A frame takes none.
 * Versions   Functions are added, not changed or removed, as long as FACEZIP_RUNTIME_ABI stays the same; structures
 *            grow at their end and carry their size. The library's soname ends in FACEZIP_RUNTIME_ABI.
 */
#ifndef FACEZIP_RUNTIME_H
#define FACEZIP_RUNTIME_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define FACEZIP_RUNTIME_API __attribute__((visibility("default")))
#else
#define FACEZIP_RUNTIME_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Of the interface in this header; facezip_runtime_abi() is that of the library that was loaded. */
#define FACEZIP_RUNTIME_ABI 1

/** What a call returns; those that are not FACEZIP_OK leave text for facezip_last_error(). */
typedef enum facezip_status {
  FACEZIP_OK = 0,
  FACEZIP_ERROR_ARGUMENT =
      1,                    /**< a null pointer, an index out of range, a size that does not fit, a weight beyond 1e6 */
  FACEZIP_ERROR_INPUT = 3,  /**< the package is missing, damaged or of a version that is not known */
  FACEZIP_ERROR_DEVICE = 4, /**< no OpenCL device answers to the selector, or it failed, or has not the memory */
  FACEZIP_ERROR_MEMORY = 5, /**< the host has not the memory */
  FACEZIP_ERROR_OTHER = 6   /**< a failure that facezip does not understand */
} facezip_status;

/** How a sample of a frame is stored. */
typedef enum facezip_sample_type {
  FACEZIP_UINT8 = 0,
  FACEZIP_UINT16 = 1, /**< of the host's byte order */
  FACEZIP_FLOAT32 = 2
} facezip_sample_type;

/** A package whose textures lie on an OpenCL device, and the weights that frames are blended with. */
typedef struct facezip_package facezip_package;

/** One map of a package (albedo, normal, ...). */
typedef struct facezip_map_info {
  size_t struct_size;       /**< to be set by the caller: sizeof(facezip_map_info) */
  const char* name;         /**< lives as long as the package, as colour_space does */
  const char* colour_space; /**< "sRGB", "linear" or "" (not said) */
  int32_t width;            /**< texels */
  int32_t height;           /**< texels; row 0 is v = 1 */
  int32_t channels;         /**< 1 to 4, interleaved */
  int32_t sample_type;      /**< facezip_sample_type */
  size_t frame_bytes;       /**< height x width x channels samples, no padding */
} facezip_map_info;

/** A texture of a map, as the package stores it: an image, or blocks that GPUs sample as they are. */
typedef struct facezip_texture_info {
  size_t struct_size;   /**< to be set by the caller: sizeof(facezip_texture_info) */
  const char* format;   /**< of blocks: "bc7", "astc-6x6", ...; "" of images. Lives for ever */
  uint32_t vk_format;   /**< VkFormat of the blocks, UNORM: samplers must give what is stored; 0 of images */
  uint32_t dxgi_format; /**< DXGI_FORMAT likewise; 0 of images, and of ASTC */
  int32_t width;        /**< texels of level 0; row 0 is v = 1 */
  int32_t height;
  int32_t channels;    /**< that mean something: 1 to 4. Of two, BC5 has red and green, ASTC red and alpha */
  int32_t sample_type; /**< facezip_sample_type of an image's samples; FACEZIP_UINT8 of blocks */
  int32_t block_width; /**< texels of a block; 1 of images */
  int32_t block_height;
  int32_t block_bytes; /**< of a block; of images, of a texel */
  int32_t levels;      /**< mip levels, the largest first; 1 of images */
  size_t bytes;        /**< of all levels */
  double
      scale[4]; /**< of a difference texture: D = scale x code + offset, in 1/255 of full scale. A code of blocks is */
  double offset[4]; /**< 255 times what a sampler returns, of images the sample. Of a neutral 1 and 0 */
} facezip_texture_info;

/** The weight maps that a map is blended with (docs/package_format.md of facezip). Maps may share them. */
typedef struct facezip_weights_info {
  size_t struct_size; /**< to be set by the caller: sizeof(facezip_weights_info) */
  int32_t set;        /**< maps of one set have the same */
  int32_t columns;    /**< cells */
  int32_t rows;
  int32_t channels;     /**< C, difference textures of a map: 1 to 8 */
  int32_t weight_scale; /**< texels of this map to a cell, along each axis */
  size_t bytes;         /**< expressions x rows x columns x channels */
  double scale[8];      /**< W = scale x code + offset, by channel */
  double offset[8];
} facezip_weights_info;

/** FACEZIP_RUNTIME_ABI of the library. */
FACEZIP_RUNTIME_API int32_t facezip_runtime_abi(void);

/** The library's version, "0.1.0". */
FACEZIP_RUNTIME_API const char* facezip_runtime_version(void);

/** What was wrong with the last call of this thread that failed, a line or more; "" before the first. Valid until the
 *  next one fails. */
FACEZIP_RUNTIME_API const char* facezip_last_error(void);

/** Loads every texel of a package onto a device; weights are all zero. Takes seconds for large packages, and a second
 *  more the first time on a device, when kernels are compiled.
 *  directory  of the package, UTF-8
 *  device     as `facezip --device` takes it: "auto" (as null is), "gpu", "cpu", "PLATFORM:DEVICE", part of a name
 *  package    set to the package, to be given to facezip_free(); to null on failure
 */
FACEZIP_RUNTIME_API facezip_status facezip_load(const char* directory, const char* device, facezip_package** package);

/** Opens a package to read its textures, for programs that blend on a GPU of their own: no device is asked for, and
 *  facezip_set_weights() and facezip_blend() refuse it. Its files stay open until facezip_free().
 *  directory  of the package, UTF-8
 *  package    set to the package, to be given to facezip_free(); to null on failure
 */
FACEZIP_RUNTIME_API facezip_status facezip_open(const char* directory, facezip_package** package);

/** Frees a package; null is ignored. */
FACEZIP_RUNTIME_API void facezip_free(facezip_package* package);

/** N, the number of weights; 0 for null. */
FACEZIP_RUNTIME_API int32_t facezip_expression_count(const facezip_package* package);

/** Name of expression 0 .. N - 1; null out of range. Lives as long as the package. */
FACEZIP_RUNTIME_API const char* facezip_expression_name(const facezip_package* package, int32_t expression);

/** Index of the expression of that name, or of the one that shows the same blendshape: mouthSmileLeft is mouthSmile_L;
 * -1 if there is none. */
FACEZIP_RUNTIME_API int32_t facezip_find_expression(const facezip_package* package, const char* name);

/** Number of maps; 0 for null. */
FACEZIP_RUNTIME_API int32_t facezip_map_count(const facezip_package* package);

/** Index of the map of that name, -1 if there is none. */
FACEZIP_RUNTIME_API int32_t facezip_find_map(const facezip_package* package, const char* name);

/** Describes a map.  info  with struct_size set */
FACEZIP_RUNTIME_API facezip_status facezip_get_map_info(const facezip_package* package, int32_t map,
                                                        facezip_map_info* info);

/** Describes a texture of a map, also of a package that facezip_load() gave.
 *  texture  0: the neutral; 1 to C: a difference texture, in the order of the weight channels
 *  info     with struct_size set
 */
FACEZIP_RUNTIME_API facezip_status facezip_get_texture_info(const facezip_package* package, int32_t map,
                                                            int32_t texture, facezip_texture_info* info);

/** Bytes of a level of a texture; 0 where there is no such. Level l has max(1, side >> l) texels a side. */
FACEZIP_RUNTIME_API size_t facezip_level_bytes(const facezip_package* package, int32_t map, int32_t texture,
                                               int32_t level);

/** Reads a level of a texture of a package that facezip_open() gave: rows of blocks from the top as the file holds
 * them, without padding, as graphics APIs take them; of images rows of samples, channels interleaved. bytes  size of
 * `data`, which must be facezip_level_bytes()
 */
FACEZIP_RUNTIME_API facezip_status facezip_read_level(const facezip_package* package, int32_t map, int32_t texture,
                                                      int32_t level, void* data, size_t bytes);

/** Describes the weight maps of a map, also of a package that facezip_load() gave.  info  with struct_size set */
FACEZIP_RUNTIME_API facezip_status facezip_get_weights_info(const facezip_package* package, int32_t map,
                                                            facezip_weights_info* info);

/** Reads the weight maps of a map of a package that facezip_open() gave: codes of 8 bits,
 * [expression][row][column][channel]. bytes  size of `codes`, which must be facezip_weights_info's
 */
FACEZIP_RUNTIME_API facezip_status facezip_read_weights(const facezip_package* package, int32_t map, void* codes,
                                                        size_t bytes);

/** Sets the weights that the following frames, of every map, are blended with. Costs a pass over the weight maps of the
 *  expressions whose weight is not zero. On failure the weights stay as they were.
 *  weights  count values of any sign, at most 1e6 either way, in the order of the expressions
 *  count    N
 */
FACEZIP_RUNTIME_API facezip_status facezip_set_weights(facezip_package* package, const float* weights, size_t count);

/** Blends a frame of one map into memory of the caller, and waits for it:
 *      frame = neutral + sum_i D_i * sum_n weight_n W_in     (FaceZip, Eq. 8)
 *  Integers are rounded and clamped, floats are neither. With all weights zero the frame is the neutral, bit for bit.
 *  frame  frame_bytes bytes. A CPU device writes straight into it when it is aligned to 64 bytes, the width is a
 *         multiple of 16 and the height of 8; otherwise the frame is copied once
 *  bytes  size of `frame`, which must be frame_bytes
 */
FACEZIP_RUNTIME_API facezip_status facezip_blend(facezip_package* package, int32_t map, void* frame, size_t bytes);

#ifdef __cplusplus
}
#endif

#endif
