// What the browser tests share: Chromium, pages that keep their errors, pictures and textures compared.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { decode } from 'fast-png';
import { chromium } from 'playwright-core';

/** Software rendering: no machine that runs tests needs a GPU. */
export function launch(executablePath) {
  return chromium.launch({ executablePath,
    args: ['--no-sandbox', '--use-angle=swiftshader', '--use-gl=angle', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'] });
}

/** Opens a page; console errors, and loads from anywhere but here, are kept in page.errors. */
export async function openPage(browser, url) {
  const page = await browser.newPage({ viewport: { width: 900, height: 640 } });
  page.errors = [];
  page.on('console', (message) => { if (message.type() === 'error') page.errors.push(message.text()); });
  page.on('pageerror', (error) => page.errors.push(String(error)));
  page.on('request', (request) => {
    const { protocol, hostname } = new URL(request.url());
    const local = protocol === 'data:' || protocol === 'blob:' || protocol === 'file:' || hostname === '127.0.0.1';
    if (!local) page.errors.push(`loads ${request.url()}`);
  });
  await page.goto(url);
  return page;
}

/**
 * Largest difference of what a shader computes to what `facezip blend` writes, over all maps, in 1/255.
 * bake(page, weights, map index): the texture as RGBA bytes, row 0 first, each as a character.
 */
export async function blendDifference({ facezip, packagePath, description, work }, page, bake, weights, gain = []) {
  const pattern = join(work, 'blend', '{map}.png');
  const given = Object.entries(weights).map(([name, weight]) => `${name}=${weight}`).join(',');
  execFileSync(facezip, ['blend', packagePath, '--weights', given, '--output', pattern, ...gain]);
  let largest = 0;
  for (const [index, map] of description.maps.entries()) {
    const expected = decode(readFileSync(pattern.replace('{map}', map.name)));
    const baked = Buffer.from(await bake(page, weights, index), 'latin1');
    assert.equal(baked.length, 4 * map.width * map.height);
    const most = map.sample_type === '16-bit' ? 65535 : 255;
    for (let p = 0; p < map.width * map.height; ++p) {
      for (let c = 0; c < Math.min(map.channels, 3); ++c) {
        const wanted = (expected.data[p * expected.channels + c] * 255) / most;
        largest = Math.max(largest, Math.abs(wanted - baked[4 * p + c]));
      }
    }
  }
  return largest;
}

/** In a page: its graphics driver says to take no more than `values`, by names of WebGL; unlimited() undoes it. */
export function limitDriver(values) {
  const context = WebGL2RenderingContext.prototype;
  const get = context.getParameter;
  context.getParameter = function (what) {
    const name = Object.keys(values).find((each) => this[each] === what);
    return name ? values[name] : get.call(this, what);
  };
  globalThis.unlimited = () => { context.getParameter = get; };
}

/** Limits, and what is said where a package of 100 expressions of 5 differences asks for more. */
export const tooMuch = [
  [{ MAX_FRAGMENT_UNIFORM_VECTORS: 64 },
    'expressions: expected at most 60 (this graphics driver takes 64 uniform vectors in a fragment shader), got 100: compress fewer expressions'],
  [{ MAX_ARRAY_TEXTURE_LAYERS: 128 },
    'expressions: expected at most 64 (this graphics driver takes 128 layers in a texture array), got 100: compress fewer expressions'],
  [{ MAX_TEXTURE_SIZE: 32 },
    'textures: expected at most 32 (texels a side that this graphics driver takes), got 64: compress smaller textures'],
];

/** Share of pixels that differ, left of a panel and above a line of text. */
export function changedShare(before, after, panel = 330) {
  const [a, b] = [decode(before), decode(after)];
  let changed = 0, count = 0;
  for (let y = 0; y < a.height - 40; ++y) {
    for (let x = 0; x < a.width - panel; ++x, ++count) {
      const i = (y * a.width + x) * a.channels;
      if (Math.abs(a.data[i] - b.data[i]) + Math.abs(a.data[i + 1] - b.data[i + 1]) > 8) ++changed;
    }
  }
  return changed / count;
}

/** Runs tests one after the other; `failed` counts. */
export const results = { failed: 0 };
export async function run(name, body) {
  try {
    await body();
    console.log(`ok   ${name}`);
  } catch (error) {
    ++results.failed;
    console.log(`FAIL ${name}\n${error.stack}`);
  }
}
