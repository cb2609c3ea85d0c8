// The project of `facezip export --target godot` in Godot 3, drawn by software: node godot_test.mjs FACEZIP GODOT XVFB_RUN PACKAGES WORK
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { decode } from 'fast-png';
import { changedShare, results, run } from './common.mjs';

const [facezip, godot, xvfb, packages, workFolder] = process.argv.slice(2);
const work = resolve(workFolder);
const check = join(dirname(fileURLToPath(import.meta.url)), 'godot_check.gd');
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });

// What Godot 3.2.3 says of itself, with any scene: the importer frees nothing, and a script that ends leaves resources.
const noise = /free_static: Condition "p_ptr == __null"|~List: Condition|cleanup: |clear: Resources still in use/;

/** Runs Godot in a folder; returns what it printed. An error or a warning is a failure. */
function runGodot(folder, ...args) {
  const { status, stdout, stderr } = spawnSync(xvfb, ['-a', '-s', '-screen 0 1280x800x24', godot, '--audio-driver', 'Dummy', '--path', folder, ...args],
    // Its settings and caches stay here.
    { encoding: 'utf8', timeout: 180000, env: { ...process.env, LANG: 'en_US.UTF-8', HOME: work, XDG_CONFIG_HOME: work, XDG_DATA_HOME: work, XDG_CACHE_HOME: work } });
  const said = `${stdout}\n${stderr}`.split('\n');
  const wrong = said.filter((line) => /ERROR|WARNING/.test(line) && !noise.test(line));
  assert.deepEqual(wrong, [], said.join('\n'));
  assert.equal(status, 0, said.join('\n'));
  return said;
}

/** Exports and lets the editor import, as opening the project does. */
function exportProject(name) {
  const folder = join(work, name);
  execFileSync(facezip, ['export', join(packages, name), '--target', 'godot', '--output', folder]);
  writeFileSync(join(folder, 'export_presets.cfg'), `[preset.0]
name="check"
platform="Linux/X11"
runnable=true
export_filter="all_resources"
include_filter=""
exclude_filter=""
patch_list=PoolStringArray(  )
[preset.0.options]
texture_format/s3tc=true
`);
  runGodot(folder, '--export-pack', 'check', join(work, `${name}.pck`));
  return folder;
}

const head = exportProject('head');
const { expressions, differences, maps } = JSON.parse(readFileSync(join(packages, 'head', 'package.json')));
await run('the scene loads with blend shapes, uniforms, and weights that reach the shader', () => {
  const line = runGodot(head, '-s', check).find((text) => text.startsWith('RESULT '));
  const found = JSON.parse(line.slice(7));
  assert.deepEqual(found.shapes, expressions);
  assert.deepEqual(found.expressions, expressions);
  assert.deepEqual(found.uniforms, { facezip_active: 'ImageTexture', facezip_count: 0, weights_0_0: 'TextureArray',
    albedo_neutral: 'StreamTexture', albedo_differences: 'TextureArray',
    normal_neutral: 'StreamTexture', normal_differences: 'TextureArray' });
  for (const map of maps) assert.deepEqual(found.layers[`${map.name}_differences`], [map.width, map.height, differences]);
  assert.ok(found.layers.weights_0_0[2] >= expressions.length);
  // Nothing, one expression, two of either sign, and a blend shape that an animation moves.
  assert.deepEqual(found.given, [[], [[0, 1]], [[1, 0.25], [3, -0.5]], [[1, 0.25], [2, 0.75], [3, -0.5]]]);
  assert.equal(found.half_uvs, false);
});

/** Draws every map of a package at some weights and compares with `facezip blend`. */
function drawn(name, folder, weights) {
  const description = JSON.parse(readFileSync(join(packages, name, 'package.json')));
  const pictures = join(work, `${name}_pictures`);
  mkdirSync(pictures, { recursive: true });
  writeFileSync(join(work, 'request.json'), JSON.stringify({ weights, folder: pictures, maps: description.maps }));
  runGodot(folder, '-s', check, `--blend=${join(work, 'request.json')}`);
  execFileSync(facezip, ['blend', join(packages, name), '--weights', Object.entries(weights).map(([n, w]) => `${n}=${w}`).join(','),
    '--output', join(pictures, 'expected.{map}.png')]);
  for (const map of description.maps) {
    const actual = decode(readFileSync(join(pictures, `${map.name}.png`)));
    const expected = decode(readFileSync(join(pictures, `expected.${map.name}.png`)));
    let largest = 0;
    for (let p = 0; p < map.width * map.height; ++p) {
      for (let c = 0; c < map.channels; ++c) {
        const difference = actual.data[p * actual.channels + c] - expected.data[p * expected.channels + c];
        largest = Math.max(largest, Math.abs(difference));
      }
    }
    console.log(`  ${name}, ${map.name}: largest difference ${largest}/255`);
    assert.ok(largest <= 1.5, `${largest}/255`);
  }
  return readFileSync(join(pictures, 'demo.png'));
}

await run('the shader computes what facezip blend does', () => {
  const neutral = drawn('head', head, { [expressions[0]]: 0 });
  const moved = drawn('head', head, { [expressions[0]]: 0.6, [expressions[3]]: 0.9 });
  assert.ok(changedShare(neutral, moved, 0) > 0.005, 'the demo shows the expression');
});
await run('100 expressions, without normals', () => {
  const names = JSON.parse(readFileSync(join(packages, 'many', 'package.json'))).expressions;
  drawn('many', exportProject('many'), { [names[99]]: 0.8, [names[50]]: 0.4 });
});
await run('eyes and teeth are surfaces of the same mesh', () => {
  const folder = exportProject('parts');
  const line = runGodot(folder, '-s', check).find((text) => text.startsWith('RESULT '));
  assert.deepEqual(JSON.parse(line.slice(7)).surfaces, ['ShaderMaterial', 'SpatialMaterial', 'SpatialMaterial']);
  drawn('parts', folder, { jawOpen: 0.7 });
});
process.exit(results.failed ? 1 : 0);
