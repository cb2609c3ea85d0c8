// The material that `facezip export --target blender` builds, baked by Blender: node blender_test.mjs FACEZIP BLENDER PACKAGES WORK
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { decode } from 'fast-png';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';
import { FloatType } from 'three';

const [facezip, blender, packages, work] = process.argv.slice(2);
const packagePath = join(packages, 'head');
const description = JSON.parse(readFileSync(join(packagePath, 'package.json')));
const names = description.expressions;
rmSync(work, { recursive: true, force: true });
execFileSync(facezip, ['export', packagePath, '--target', 'blender', '--output', work]);
const weights = `${names[0]}=0.6,${names[3]}=0.9`;
execFileSync(facezip, ['blend', packagePath, '--weights', weights, '--output', join(work, 'expected.{map}.png')]);
for (const map of description.maps) {
  const file = join(work, `${map.name}.exr`);
  execFileSync(blender, ['--background', '--factory-startup', '--python-exit-code', '1', '--python', join(work, 'facezip_blender.py'),
    '--', '--weights', weights, '--bake', `${map.name}=${file}`], { stdio: ['ignore', 'ignore', 'inherit'] });
  const loader = new EXRLoader();
  loader.setDataType(FloatType);
  const bytes = readFileSync(file);
  const baked = loader.parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
  const expected = decode(readFileSync(join(work, `expected.${map.name}.png`)));
  const channels = baked.data.length / (map.width * map.height);
  let largest = 0, compared = 0;
  for (let y = 0; y < map.height; ++y) {
    for (let x = 0; x < map.width; ++x) {
      const from = ((map.height - 1 - y) * map.width + x) * channels;  // the loader gives the last row first
      if (!(baked.data[from] + baked.data[from + 1] + baked.data[from + 2] > 0)) continue;  // outside the islands
      ++compared;
      for (let c = 0; c < 3; ++c) {
        const value = Math.min(Math.max(255 * baked.data[from + c], 0), 255);
        largest = Math.max(largest, Math.abs(value - expected.data[(y * map.width + x) * expected.channels + c]));
      }
    }
  }
  console.log(`${map.name}: largest difference ${largest.toFixed(3)}/255 at ${compared} texels`);
  assert.ok(compared > 0.5 * map.width * map.height, 'texels were baked');
  assert.ok(largest <= 1.5, `${largest}/255`);
}
