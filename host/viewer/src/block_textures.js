// Textures in blocks as GPUs hold them: the blocks of KTX2 files, uploaded as they are, with the mip levels of the file.
import * as THREE from 'three';
import { read } from 'three/examples/jsm/libs/ktx-parse.module.js';

/** By name: the extension of WebGL that samples such blocks, three.js's format, and KTX2's (VkFormat). */
const formats = {
  bc1: ['WEBGL_compressed_texture_s3tc', THREE.RGB_S3TC_DXT1_Format, 131],
  bc4: ['EXT_texture_compression_rgtc', THREE.RED_RGTC1_Format, 139],
  bc5: ['EXT_texture_compression_rgtc', THREE.RED_GREEN_RGTC2_Format, 141],
  bc7: ['EXT_texture_compression_bptc', THREE.RGBA_BPTC_Format, 145],
};
['4x4', '5x4', '5x5', '6x5', '6x6', '8x5', '8x6', '8x8', '10x5', '10x6', '10x8', '10x10', '12x10', '12x12'].forEach(
  (side, i) => { formats[`astc-${side}`] = ['WEBGL_compressed_texture_astc', THREE[`RGBA_ASTC_${side}_Format`], 157 + 2 * i]; });

/** All textures of a map that are in blocks, as { format } fields of package.json name them. */
const texturesOf = (map) => [map.neutral, ...map.differences];
export const inBlocks = (texture) => texture.format !== undefined;

/** Throws what a user can act on where the driver, or this page, cannot show the blocks of a map. */
export function requireBlocks(map, renderer) {
  for (const texture of texturesOf(map).filter(inBlocks)) {
    const known = formats[texture.format];
    if (!known) throw new Error(`${texture.file}: this page does not know blocks in ${texture.format}`);
    if (!renderer.extensions.has(known[0])) {
      throw new Error(`${map.name} is in ${texture.format} blocks, which this graphics driver does not sample (${known[0]}): ` +
        'compress with another --texture-format, or png');
    }
    if (map.channels === 2 && texture.format.startsWith('astc')) {
      throw new Error(`${map.name} has two channels in ASTC blocks, which this page does not show: compress it as png or bc5`);
    }
  }
  const others = map.differences.filter((difference) => difference.format !== map.differences[0].format);
  if (others.length > 0) throw new Error(`${map.name}: this page shows difference textures of one format only`);
}

/** { width, height, levels }: blocks of each mip level. */
async function readLevels(readFile, texture, map) {
  const container = read(await readFile(texture.file));
  const [, , vkFormat] = formats[texture.format];
  const { pixelWidth, pixelHeight, levels } = container;
  if (container.vkFormat !== vkFormat || pixelWidth !== map.width || pixelHeight !== map.height) {
    throw new Error(`${texture.file} is not what package.json says`);
  }
  return levels.map(({ levelData }, level) => ({
    data: levelData, width: Math.max(1, map.width >> level), height: Math.max(1, map.height >> level) }));
}

function finish(texture, levels) {
  texture.colorSpace = THREE.NoColorSpace;  // blending comes before any curve
  texture.wrapS = texture.wrapT = THREE.ClampToEdgeWrapping;
  texture.magFilter = THREE.LinearFilter;
  texture.minFilter = THREE.LinearMipmapLinearFilter;
  texture.generateMipmaps = false;
  texture.needsUpdate = true;
  return { texture, bytes: levels.reduce((sum, { data }) => sum + data.length, 0) };
}

/** { texture, bytes }: one texture. */
export async function readBlockTexture(readFile, texture, map) {
  const levels = await readLevels(readFile, texture, map);
  return finish(new THREE.CompressedTexture(levels, map.width, map.height, formats[texture.format][1]), levels);
}

/** { texture, bytes }: textures of one format as layers of an array. */
export async function readBlockArray(readFile, textures, map) {
  const layers = [];
  for (const texture of textures) layers.push(await readLevels(readFile, texture, map));
  const levels = layers[0].map(({ width, height, data }, level) => {
    const joined = new Uint8Array(data.length * layers.length);
    layers.forEach((layer, i) => joined.set(layer[level].data, i * data.length));
    return { data: joined, width, height };
  });
  return finish(new THREE.CompressedArrayTexture(levels, map.width, map.height, layers.length,
    formats[textures[0].format][1]), levels);
}
