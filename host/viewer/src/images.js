// Images of a package as arrays for textures: RGBA, row 0 first, no colour conversion and no premultiplied alpha, which
// a browser's own decoders do not promise.
import { decode } from 'fast-png';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';
import { FloatType } from 'three';

/** { width, height, channels, data, most }: samples as they are stored, and the largest one (1 of floats). */
export async function readImage(readFile, name) {
  const bytes = await readFile(name);
  return name.endsWith('.exr') ? decodeExr(bytes) : decodePng(bytes);
}

function decodePng(bytes) {
  const { width, height, channels, depth, data } = decode(bytes);
  return { width, height, channels, data, most: depth === 16 ? 65535 : 255 };
}

function decodeExr(bytes) {
  const loader = new EXRLoader();
  loader.setDataType(FloatType);
  const { width, height, data } = loader.parse(bytes.buffer);
  const channels = data.length / (width * height);
  const flipped = new Float32Array(data.length);  // the loader gives the last row first
  const row = width * channels;
  for (let y = 0; y < height; ++y) flipped.set(data.subarray((height - 1 - y) * row, (height - y) * row), y * row);
  return { width, height, channels, data: flipped, most: 1 };
}

/** Widens samples to RGBA as a shader reads them: bytes for 8 bits, floats (0..1 of full scale) for others. */
export function toRgba(image, into, offset = 0) {
  const { channels, data, most } = image;
  const texels = image.width * image.height;
  const scale = into instanceof Uint8Array ? 1 : 1 / most;
  for (let c = 0; c < 4; ++c) {
    for (let i = 0; i < texels; ++i) into[offset + 4 * i + c] = c < channels ? data[i * channels + c] * scale : 0;
  }
  return into;
}

/** Copies tile (x, y, width, height) of an image. */
export function cut(image, x, y, width, height) {
  const { channels } = image;
  const data = new image.data.constructor(width * height * channels);
  for (let row = 0; row < height; ++row) {
    const from = ((y + row) * image.width + x) * channels;
    data.set(image.data.subarray(from, from + width * channels), row * width * channels);
  }
  return { width, height, channels, data, most: image.most };
}
