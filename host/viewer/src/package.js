// A package, read: docs/package_format.md. `readFile` is of files.js.
import { composed } from './composed.js';
import { cut, readImage } from './images.js';

/** package.json, after the checks that a page needs; `facezip view` has made all of them. */
export async function readDescription(readFile) {
  const description = JSON.parse(new TextDecoder().decode(await readFile('package.json')));
  if (description.format !== 'facezip-package') throw new Error('package.json is not of a facezip package');
  if (![2, 3].includes(description.version)) {
    throw new Error(`package.json has version ${description.version}; this page reads 2 and 3`);
  }
  description.expressions = description.expressions.map(composed);
  return description;
}

/** Weight maps of a set as images of a tile each, layer n * groups + group, without borders. */
export async function readWeights(readFile, description, set) {
  const images = await Promise.all(set.files.map((file) => readImage(readFile, file)));
  const layers = [];
  for (let n = 0; n < description.expressions.length; ++n) {
    const x = (n % set.columns) * (set.tile_width + 2 * set.border) + set.border;
    const y = Math.floor(n / set.columns) * (set.tile_height + 2 * set.border) + set.border;
    for (const image of images) layers.push(cut(image, x, y, set.tile_width, set.tile_height));
  }
  return layers;
}

/** Masks as arrays of cells, 0..1; none where the package has none. */
export async function readMasks(readFile, description) {
  const { masks } = description;
  if (!masks) return [];
  const image = await readImage(readFile, masks.file);
  const tiles = [];
  for (let k = 0; k < masks.count; ++k) {
    const x = (k % masks.columns) * masks.tile_width;
    const y = Math.floor(k / masks.columns) * masks.tile_height;
    tiles.push(Float32Array.from(cut(image, x, y, masks.tile_width, masks.tile_height).data, (code) => code / 255));
  }
  return tiles;
}
