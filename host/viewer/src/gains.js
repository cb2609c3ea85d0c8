// Gains of expressions and regions, and the preset that `facezip blend --gain` takes (docs/blend.md).

import { composed } from './composed.js';

const kLargest = 16;

export function unitGains(description) {
  return {
    expressions: new Float32Array(description.expressions.length).fill(1),
    regions: new Float32Array((description.regions ?? []).length).fill(1),
  };
}

export function toPreset(description, gains) {
  const named = (names, values) =>
    Object.fromEntries(names.map((name, i) => [name, Number(values[i].toFixed(4))]).filter(([, gain]) => gain !== 1));
  return {
    format: 'facezip-gains',
    version: 1,
    package: description.name,
    expressions: named(description.expressions, gains.expressions),
    regions: named((description.regions ?? []).map((region) => region.name), gains.regions),
  };
}

/** The gains of a preset's text. Throws an Error that says what is wrong, as `facezip blend --gain` does. */
export function fromPreset(description, text) {
  const preset = JSON.parse(text);
  if (preset.format !== 'facezip-gains' || preset.version !== 1) throw new Error('this is not a preset of gains');
  if (preset.package !== description.name) {
    throw new Error(`the preset is of the package "${preset.package}", not of "${description.name}"`);
  }
  const gains = unitGains(description);
  const read = (factors, names, what, values) => {
    for (const [name, gain] of Object.entries(factors ?? {})) {
      const index = names.indexOf(composed(name));
      if (index < 0) throw new Error(`the package has no ${what} "${name}"`);
      if (!(gain >= 0 && gain <= kLargest)) throw new Error(`the gain of ${name} is not a number from 0 to ${kLargest}`);
      values[index] = gain;
    }
  };
  read(preset.expressions, description.expressions, 'expression', gains.expressions);
  read(preset.regions, (description.regions ?? []).map((region) => region.name), 'region', gains.regions);
  return gains;
}

/** 1 + sum over regions of (gain - 1) R on the cells of the masks. */
function gainOfMaskCells(description, masks, regions) {
  const cells = new Float32Array(description.masks.tile_width * description.masks.tile_height).fill(1);
  description.regions.forEach((region, r) => {
    for (const k of region.masks) masks[k].forEach((mask, q) => { cells[q] += (regions[r] - 1) * mask; });
  });
  return cells;
}

/** Gains of the cells of a weight set, row-major: bilinear where the masks have another number of cells. */
export function cellGains(description, masks, regions, set) {
  const { tile_width: columns, tile_height: rows } = set;
  const gains = new Float32Array(columns * rows).fill(1);
  if (!masks.length || regions.every((gain) => gain === 1)) return gains;
  const { tile_width, tile_height } = description.masks;
  const cells = gainOfMaskCells(description, masks, regions);
  const position = (cell, count, mask_count) =>
    Math.min(Math.max(((cell + 0.5) * mask_count) / count - 0.5, 0), mask_count - 1);
  const at = (x, y) => cells[Math.min(y, tile_height - 1) * tile_width + Math.min(x, tile_width - 1)];
  const mix = (a, b, t) => a + (b - a) * t;
  for (let y = 0; y < rows; ++y) {
    const v = position(y, rows, tile_height), j = Math.floor(v);
    for (let x = 0; x < columns; ++x) {
      const u = position(x, columns, tile_width), i = Math.floor(u);
      gains[y * columns + x] = mix(mix(at(i, j), at(i + 1, j), u - i), mix(at(i, j + 1), at(i + 1, j + 1), u - i), v - j);
    }
  }
  return gains;
}
