// The material that `facezip export --target blender` builds, baked by Blender: node blender_test.mjs FACEZIP BLENDER PACKAGES WORK
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { decode, encode } from 'fast-png';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';
import { FloatType } from 'three';

const [facezip, blender, packages, work] = process.argv.slice(2);
const check = join(dirname(fileURLToPath(import.meta.url)), 'blender_check.py');
const read = (path) => JSON.parse(readFileSync(join(path, 'package.json')));
const names = read(join(packages, 'head')).expressions;
const weights = `${names[0]}=0.6,${names[3]}=0.9`;
rmSync(work, { recursive: true, force: true });

/** Runs a script in Blender; the texture that it bakes into `file`, row 0 first. */
function bake(file, script, ...args) {
  execFileSync(blender, ['--background', '--factory-startup', '--python-exit-code', '1', '--python', script, '--', ...args],
    { stdio: ['ignore', 'ignore', 'inherit'] });
  const loader = new EXRLoader();
  loader.setDataType(FloatType);
  const bytes = readFileSync(file);
  const { data, width, height } = loader.parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
  const channels = data.length / (width * height);
  return (x, y, c) => data[((height - 1 - y) * width + x) * channels + c];  // the loader gives the last row first
}

/** Baked texels are what `facezip blend` writes; of gray maps, as three equal channels. */
function compare(title, map, baked, expected, encoded = (value) => value) {
  let largest = 0, compared = 0;
  for (let y = 0; y < map.height; ++y) {
    for (let x = 0; x < map.width; ++x) {
      if (!(baked(x, y, 0) + baked(x, y, 1) + baked(x, y, 2) > 0)) continue;  // outside the islands
      ++compared;
      for (let c = 0; c < 3; ++c) {
        const value = Math.min(Math.max(255 * encoded(baked(x, y, c)), 0), 255);
        const channel = map.channels < 3 ? 0 : c;
        largest = Math.max(largest, Math.abs(value - expected.data[(y * map.width + x) * expected.channels + channel]));
      }
    }
  }
  console.log(`${title}: largest difference ${largest.toFixed(3)}/255 at ${compared} texels`);
  assert.ok(compared > 0.5 * map.width * map.height, 'texels were baked');
  assert.ok(largest <= 1.5, `${largest}/255`);
}

/** Exports a package and compares every map, and the base colour with what the albedo says. */
function checkExport(packagePath, folder) {
  const description = read(packagePath);
  execFileSync(facezip, ['export', packagePath, '--target', 'blender', '--output', folder]);
  execFileSync(facezip, ['blend', packagePath, '--weights', weights, '--output', join(folder, 'expected.{map}.png')]);
  const expected = (map) => decode(readFileSync(join(folder, `expected.${map.name}.png`)));
  for (const map of description.maps) {
    const file = join(folder, `${map.name}.exr`);
    const baked = bake(file, join(folder, 'facezip_blender.py'), '--weights', weights, '--bake', `${map.name}=${file}`);
    compare(map.name, map, baked, expected(map));
  }
  const albedo = description.maps.find((map) => map.name === 'albedo');
  const file = join(folder, 'base_colour.exr');
  const toSrgb = (c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
  compare(`base colour of an albedo that is ${albedo.colour_space}`, albedo, bake(file, check, folder, weights, file),
    expected(albedo), albedo.colour_space === 'linear' ? undefined : toSrgb);
}

/** The first channels of a map of three, as a map of its own. */
function withFewerChannels(packagePath, map, channels) {
  const name = `gray_${channels}`;
  const reduce = (file) => {
    const { width, height, data, ...image } = decode(readFileSync(join(packagePath, file)));
    const kept = data.filter((_, i) => i % image.channels < channels);
    const to = file.replace('.png', `_${channels}.png`);
    writeFileSync(join(packagePath, to), encode({ width, height, data: kept, channels, depth: image.depth }));
    return to;
  };
  return { ...map, name, channels, neutral: { file: reduce(map.neutral.file) },
    differences: map.differences.map(({ file, scale, offset }) =>
      ({ file: reduce(file), scale: scale.slice(0, channels), offset: offset.slice(0, channels) })) };
}

checkExport(join(packages, 'head'), join(work, 'head'));
checkExport(join(packages, 'parts'), join(work, 'parts'));  // whose eyes and teeth lie in the same layout
checkExport(join(packages, 'bc7'), join(work, 'bc7'));

const variant = join(work, 'variant_package');
cpSync(join(packages, 'head'), variant, { recursive: true });
const description = read(variant);
const albedo = { ...description.maps.find((map) => map.name === 'albedo'), colour_space: 'linear' };
const scatter = { ...description.maps.find((map) => map.name === 'normal'), name: 'albedo_scatter' };  // the second of its role
const maps = [albedo, scatter, withFewerChannels(variant, albedo, 1), withFewerChannels(variant, albedo, 2)];
writeFileSync(join(variant, 'package.json'), JSON.stringify({ ...description, maps }));
checkExport(variant, join(work, 'variant'));

/** Names of 164 bytes, alike for longer than Blender's 63: two of shape keys, two of properties. */
function checkLongNames(packagePath, folder) {
  const stem = `${'a'.repeat(62)}\u00e9${'b'.repeat(98)}`;
  const renamed = names.map((name, n) => (n < 4 ? `${stem}=${n}` : name));
  cpSync(join(packages, 'head'), packagePath, { recursive: true });
  const { maps, ...rest } = read(packagePath);
  const map = maps.find((each) => each.name === 'albedo');
  writeFileSync(join(packagePath, 'package.json'), JSON.stringify({ ...rest, expressions: renamed, maps: [map] }));
  execFileSync(facezip, ['export', packagePath, '--target', 'blender', '--output', folder]);
  const scene = JSON.parse(readFileSync(join(folder, 'scene.gltf')));
  scene.meshes[0].extras.targetNames = names.map((name, n) => (n === 0 || n === 3 ? renamed[n] : name));
  writeFileSync(join(folder, 'scene.gltf'), JSON.stringify(scene));
  const given = [0.6, 0.3, 0.5, 0.4].map((weight, n) => `${renamed[n]}=${weight}`).join(',');
  execFileSync(facezip, ['blend', packagePath, '--weights', given, '--output', join(folder, 'expected.png')]);
  const file = join(folder, 'albedo.exr');
  compare('long names', map, bake(file, join(folder, 'facezip_blender.py'), '--weights', given, '--bake', `albedo=${file}`),
    decode(readFileSync(join(folder, 'expected.png'))));
}
checkLongNames(join(work, 'long_package'), join(work, 'long'));
