// Textures of blocks as others read them: ktx-parse, three.js's KTX2Loader, and the decoders of a browser's WebGL.
// node block_test.mjs BLOCK_TEXTURES CHROMIUM WORK_DIRECTORY
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { dirname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { read, write } from 'ktx-parse';
import { launch, openPage, results, run } from './common.mjs';

const [writer, browserPath, work] = process.argv.slice(2);
rmSync(work, { recursive: true, force: true });
execFileSync(writer, [work]);
const textures = JSON.parse(readFileSync(join(work, 'textures.json')));

// How far others may be from what facezip decodes to, in 1/255. SwiftShader cuts what lies between the ends of BC1, BC4
// and BC5 to 8 bits; facezip rounds BC1's and keeps fractions of the others.
const bounds = { bc1: 1, bc4: 0.9, bc5: 0.9, bc7: 0, astc: 0.5 };
const boundOf = (texture) => bounds[texture.format.split('-')[0]];

const pageText = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
<script type="importmap">{"imports": {"three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}</script>
<script type="module">
  import * as THREE from 'three';
  import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
  import { read } from 'three/addons/libs/ktx-parse.module.js';
  const renderer = new THREE.WebGLRenderer();
  const loader = new KTX2Loader().detectSupport(renderer);
  const bytesOf = async (url) => (await fetch(url)).arrayBuffer();
  const astc = (name) => THREE['RGBA_ASTC_' + name.slice(5) + '_Format'];

  globalThis.byLoader = async (name) =>
    new Promise(async (resolve, reject) => loader.parse(await bytesOf(name + '.ktx2'), resolve, reject));
  // KTX2Loader knows two sizes of ASTC's blocks.
  globalThis.byHand = async (name, format) => {
    const container = read(new Uint8Array(await bytesOf(name + '.ktx2')));
    const levels = container.levels.map(({ levelData }, level) => ({ data: levelData,
      width: Math.max(1, container.pixelWidth >> level), height: Math.max(1, container.pixelHeight >> level) }));
    return new THREE.CompressedTexture(levels, container.pixelWidth, container.pixelHeight, astc(format));
  };
  globalThis.ofDds = async (name, blockBytes, format) => {
    const bytes = await bytesOf(name + '.dds');
    const view = new DataView(bytes);
    const [height, width, count] = [12, 16, 28].map((at) => view.getUint32(at, true));
    const levels = [];
    let at = 148;
    for (let level = 0; level < count; ++level) {
      const w = Math.max(1, width >> level), h = Math.max(1, height >> level);
      const size = Math.ceil(w / 4) * Math.ceil(h / 4) * blockBytes;
      levels.push({ data: new Uint8Array(bytes, at, size), width: w, height: h });
      at += size;
    }
    if (at !== bytes.byteLength) throw new Error('bytes are left');
    const formats = { bc1: THREE.RGB_S3TC_DXT1_Format, bc4: THREE.RED_RGTC1_Format,
      bc5: THREE.RED_GREEN_RGTC2_Format, bc7: THREE.RGBA_BPTC_Format };
    return new THREE.CompressedTexture(levels, width, height, formats[format]);
  };
  // Texels of a level as the sampler gives them, RGBA floats.
  globalThis.texels = (texture, level, width, height) => {
    texture.minFilter = THREE.NearestMipmapNearestFilter;
    texture.magFilter = THREE.NearestFilter;
    texture.needsUpdate = true;
    const target = new THREE.WebGLRenderTarget(width, height, { type: THREE.FloatType });
    const material = new THREE.ShaderMaterial({ glslVersion: THREE.GLSL3, depthTest: false,
      uniforms: { map: { value: texture }, level: { value: level } },
      vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader: \`precision highp float; uniform sampler2D map; uniform int level; out vec4 colour;
        void main() { colour = texelFetch(map, ivec2(gl_FragCoord.xy), level); }\` });
    const scene = new THREE.Scene();
    const quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
    quad.frustumCulled = false;
    scene.add(quad);
    renderer.setRenderTarget(target);
    renderer.render(scene, new THREE.Camera());
    const values = new Float32Array(4 * width * height);
    renderer.readRenderTargetPixels(target, 0, 0, width, height, values);
    renderer.setRenderTarget(null);
    target.dispose();
    return Array.from(values);
  };
  globalThis.ready = true;
</script>`;
const three = dirname(dirname(fileURLToPath(import.meta.resolve('three'))));
const server = createServer((request, response) => {
  const path = normalize(decodeURIComponent(new URL(request.url, 'http://x').pathname));
  if (path === '/') return response.setHeader('content-type', 'text/html').end(pageText);
  try {
    const file = path.startsWith('/three/') ? join(three, path.slice(7)) : join(work, path);
    response.setHeader('content-type', file.endsWith('.js') ? 'text/javascript' : 'application/octet-stream');
    response.end(readFileSync(file));
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
const browser = await launch(browserPath);
const page = await openPage(browser, `http://127.0.0.1:${server.address().port}/`);
await page.waitForFunction(() => globalThis.ready);

const sideOf = (side, level) => Math.max(1, side >> level);
// One channel of ASTC is luminance, two are luminance and alpha.
const channelsOf = ({ format, channels }) => (format.startsWith('astc') && channels === 2 ? [0, 3] : [0, 1, 2, 3].slice(0, channels));
const coded = (value) => (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055);

/** Largest and root mean square difference of a browser's texels to facezip's, over all levels, in 1/255. */
async function difference(texture, get) {
  const handle = await page.evaluateHandle(get, texture);
  let largest = 0, sum = 0, count = 0;
  for (let level = 0; level < texture.levels; ++level) {
    const [width, height] = [sideOf(texture.width, level), sideOf(texture.height, level)];
    const ours = new Float32Array(new Uint8Array(readFileSync(join(work, `${texture.name}.${level}.f32`))).buffer);
    const theirs = await page.evaluate(([map, l, w, h]) => globalThis.texels(map, l, w, h), [handle, level, width, height]);
    assert.equal(ours.length, width * height * texture.channels);
    for (let p = 0; p < width * height; ++p) {
      for (const [c, from] of channelsOf(texture).entries()) {
        const value = theirs[4 * p + from];
        const off = Math.abs(255 * (texture.srgb ? coded(value) : value) - ours[p * texture.channels + c]);
        largest = Math.max(largest, off);
        sum += off * off;
        ++count;
      }
    }
  }
  console.log(`  ${texture.name}: ${largest.toFixed(3)}/255 at most, ${Math.sqrt(sum / count).toFixed(3)} RMS`);
  return largest;
}

await run('ktx-parse reads what was written, and writes it the same', () => {
  for (const texture of textures) {
    const bytes = readFileSync(join(work, `${texture.name}.ktx2`));
    const container = read(new Uint8Array(bytes));
    assert.equal(container.vkFormat, texture.vkFormat);
    assert.deepEqual([container.pixelWidth, container.pixelHeight, container.levels.length], [texture.width, texture.height, texture.levels]);
    assert.equal(container.keyValue.KTXorientation, 'rd');
    assert.match(container.keyValue.KTXwriter, /^facezip \d+\.\d+\.\d+$/);
    const [descriptor] = container.dataFormatDescriptor;
    assert.deepEqual(descriptor.texelBlockDimension.slice(0, 2), [texture.blockWidth - 1, texture.blockHeight - 1]);
    assert.equal(descriptor.bytesPlane[0], texture.blockBytes);
    for (const [level, { levelData }] of container.levels.entries()) {
      const blocks = Math.ceil(sideOf(texture.width, level) / texture.blockWidth) * Math.ceil(sideOf(texture.height, level) / texture.blockHeight);
      assert.equal(levelData.length, blocks * texture.blockBytes);
    }
    assert.ok(Buffer.from(write(container, { keepWriter: true })).equals(bytes), texture.name);
  }
});
await run('three.js\'s KTX2Loader and the browser\'s decoders see the same texels', async () => {
  for (const texture of textures) {
    const known = !texture.format.startsWith('astc') || ['astc-4x4', 'astc-6x6'].includes(texture.format);
    const get = known ? ({ name }) => globalThis.byLoader(name) : ({ name, format }) => globalThis.byHand(name, format);
    const largest = await difference(texture, get);
    assert.ok(largest <= boundOf(texture) + 0.01, `${texture.name}: ${largest}/255`);
  }
});
await run('DDS holds the same blocks', async () => {
  for (const texture of textures.filter(({ format, srgb }) => !format.startsWith('astc') && !srgb)) {
    const bytes = readFileSync(join(work, `${texture.name}.dds`));
    assert.equal(bytes.readUInt32LE(128), texture.dxgiFormat);
    const largest = await difference(texture, ({ name, blockBytes, format }) => globalThis.ofDds(name, blockBytes, format));
    assert.ok(largest <= boundOf(texture) + 0.01, `${texture.name}: ${largest}/255`);
  }
});
await run('no console errors', () => assert.deepEqual(page.errors, []));
await browser.close();
server.close();
process.exit(results.failed ? 1 : 0);
