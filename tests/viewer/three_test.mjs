// The folder of `facezip export --target three` in a page of somebody's own: node three_test.mjs FACEZIP CHROMIUM PACKAGES WORK_DIRECTORY
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { decode, encode } from 'fast-png';
import { blendDifference, changedShare, launch, limitDriver, openPage, results, run, tooMuch } from './common.mjs';

const [facezip, browserPath, packages, work] = process.argv.slice(2);
const packagePath = join(packages, 'head');
const description = JSON.parse(readFileSync(join(packagePath, 'package.json')));
const names = description.expressions;
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
execFileSync(facezip, ['export', packagePath, '--target', 'three', '--output', join(work, 'face')]);

// As the README says, with a renderer, a camera and a light of the page's.
const pageText = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><body style="margin:0">
<script type="importmap">{"imports": {"three": "/three/build/three.module.js", "three/": "/three/"}}</script>
<script type="module">
  import * as THREE from 'three';
  import { loadFace } from '/face/facezip_three.js';
  const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
  renderer.setSize(640, 480);
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.add(new THREE.HemisphereLight(0xffffff, 0x555555, 2));
  globalThis.load = async (folder) => {
    if (globalThis.face) scene.remove(globalThis.face.object);
    const face = await loadFace(renderer, folder);
    scene.add(face.object);
    face.object.geometry.computeBoundingSphere();
    const { center, radius } = face.object.geometry.boundingSphere;
    const camera = new THREE.PerspectiveCamera(30, 640 / 480, radius / 100, 100 * radius);
    camera.position.set(center.x, center.y, center.z + 4 * radius);
    globalThis.draw = (weights) => { face.setWeights(weights); renderer.render(scene, camera); };
    globalThis.face = face;
  };
  globalThis.loadFace = (folder) => loadFace(renderer, folder);
  globalThis.bake = (face, weights, map) => {
    face.setWeights(weights);
    return Array.from(face.textures.bake(renderer, map), (byte) => String.fromCharCode(byte)).join('');
  };
  globalThis.ready = globalThis.load('/face/');
</script>`;
const types = { '.js': 'text/javascript', '.png': 'image/png', '.json': 'application/json' };
const three = dirname(dirname(fileURLToPath(import.meta.resolve('three'))));
const server = createServer((request, response) => {
  const path = normalize(decodeURIComponent(new URL(request.url, 'http://x').pathname));
  if (path === '/') return response.setHeader('content-type', 'text/html').end(pageText);
  try {
    const file = path.startsWith('/three/') ? join(three, path.slice(7)) : join(work, path);
    response.setHeader('content-type', types[extname(file)] ?? 'application/octet-stream').end(readFileSync(file));
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
const browser = await launch(browserPath);
const page = await openPage(browser, `http://127.0.0.1:${server.address().port}/`);
const shoot = async (weights, name) => {
  await page.evaluate((given) => globalThis.draw(given), weights);
  return page.screenshot({ path: join(work, `${name}.png`) });
};

await run('the module loads with the page\'s three.js', async () => {
  await page.evaluate(() => globalThis.ready);
  assert.deepEqual(await page.evaluate(() => globalThis.face.expressions), names);
});
await run('the shader computes what facezip blend does', async () => {
  const bake = (from, weights, map) => from.evaluate(([given, i]) => globalThis.bake(globalThis.face, given, i), [weights, map]);
  for (const weights of [{}, { [names[0]]: 1 }, { [names[1]]: 0.37, [names[3]]: 0.8 }]) {
    const largest = await blendDifference({ facezip, packagePath, description, work }, page, bake, weights);
    console.log(`  largest difference ${largest}/255 at ${JSON.stringify(weights)}`);
    assert.ok(largest <= (Object.keys(weights).length ? 1.5 : 0), `${largest}/255`);
  }
});
for (const format of ['bc7', 'astc-5x5']) {
  await run(`blocks of ${format} are blended as they are`, async () => {
    const other = join(packages, format);
    execFileSync(facezip, ['export', other, '--target', 'three', '--output', join(work, format)]);
    await page.evaluate(async (folder) => { globalThis.blocks = await globalThis.loadFace(folder); }, `/${format}/`);
    const bake = (from, weights, map) => from.evaluate(([given, i]) => globalThis.bake(globalThis.blocks, given, i), [weights, map]);
    const own = JSON.parse(readFileSync(join(other, 'package.json')));
    const largest = await blendDifference({ facezip, packagePath: other, description: own, work }, page, bake, { [names[1]]: 0.7 });
    assert.ok(largest <= 2, `${largest}/255`);
  });
}
await run('two faces at once keep to their own packages', async () => {
  const other = join(packages, 'many');
  execFileSync(facezip, ['export', other, '--target', 'three', '--output', join(work, 'other')]);
  await page.evaluate(async () => {
    globalThis.two = await Promise.all(['/face/', '/other/'].map((folder) => globalThis.loadFace(folder)));
  });
  const compare = async (which, path, gain) => {
    const bake = (from, weights, map) =>
      from.evaluate(([face, given, i]) => globalThis.bake(globalThis.two[face], given, i), [which, weights, map]);
    const own = JSON.parse(readFileSync(join(path, 'package.json')));
    const largest = await blendDifference({ facezip, packagePath: path, description: own, work }, page, bake,
      { [own.expressions.at(-1)]: 0.8 }, gain);
    assert.ok(largest <= 1.5, `${largest}/255`);
  };
  await compare(0, packagePath);
  await compare(1, other);
  // Gains read masks, long after both were loaded.
  const preset = join(work, 'gains.json');
  const regions = { [description.regions[0].name]: 0.25, [description.regions[1].name]: 2 };
  writeFileSync(preset, JSON.stringify({ format: 'facezip-gains', version: 1, package: description.name, regions }));
  const text = readFileSync(preset, 'utf8');
  await page.evaluate((given) => globalThis.two[0].setGains(given), text);
  await compare(0, packagePath, ['--gain', preset]);
  await compare(1, other);
});
await run('weights move the face', async () => {
  const neutral = await shoot({}, 'neutral');
  assert.ok(changedShare(neutral, await shoot({ [names[0]]: 1 }, 'expression'), 0) > 0.005);
  assert.equal(changedShare(neutral, await shoot({}, 'neutral_again'), 0), 0);
});
await run('a linear albedo is shaded as it is', async () => {
  // The same colours, stored as linear light.
  const other = join(work, 'linear', 'package');
  cpSync(join(work, 'face', 'package'), other, { recursive: true });
  const albedo = description.maps.find((map) => map.name === 'albedo');
  const image = decode(readFileSync(join(other, albedo.neutral.file)));
  const light = (code) => (code / 255 <= 0.04045 ? code / 255 / 12.92 : ((code / 255 + 0.055) / 1.055) ** 2.4);
  const data = Uint16Array.from(image.data, (code) => Math.round(65535 * light(code)));
  writeFileSync(join(other, albedo.neutral.file), encode({ ...image, data, depth: 16 }));
  const maps = description.maps.map((map) =>
    (map === albedo ? { ...map, colour_space: 'linear', sample_type: '16-bit' } : map));
  writeFileSync(join(other, 'package.json'), JSON.stringify({ ...description, maps }));
  const expected = await shoot({}, 'neutral');
  await page.evaluate(() => globalThis.load('/linear/'));
  const changed = changedShare(expected, await shoot({}, 'neutral_linear'), 0);
  assert.ok(changed < 0.001, `${changed} of the picture changed`);
});
await run('the first map of a role has it', async () => {
  const other = join(work, 'roles', 'package');
  cpSync(join(work, 'face', 'package'), other, { recursive: true });
  const [albedo, normal] = ['albedo', 'normal'].map((name) => description.maps.find((map) => map.name === name));
  const maps = [{ ...albedo, name: 'diffuse' }, { ...normal, name: 'albedo' }, normal, { ...albedo, name: 'normal_2' }];
  writeFileSync(join(other, 'package.json'), JSON.stringify({ ...description, maps }));
  await page.evaluate(() => globalThis.load('/face/'));
  const expected = await shoot({}, 'neutral');
  await page.evaluate(() => globalThis.load('/roles/'));
  assert.equal(changedShare(expected, await shoot({}, 'neutral_roles'), 0), 0);
});
await run('it says what a graphics driver takes too little of', async () => {
  for (const [limits, text] of tooMuch) {
    await page.evaluate(limitDriver, limits);
    const said = await page.evaluate(() => globalThis.loadFace('/other/').then(() => 'loaded', (error) => error.message));
    await page.evaluate(() => globalThis.unlimited());
    assert.equal(said, text);
  }
});
await run('no console errors', () => assert.deepEqual(page.errors, []));
await browser.close();
server.close();
process.exit(results.failed ? 1 : 0);
