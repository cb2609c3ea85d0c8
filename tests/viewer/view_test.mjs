// The page of `facezip view` in Chromium: node view_test.mjs FACEZIP CHROMIUM PACKAGES WORK_DIRECTORY
// PACKAGES holds what make_packages.cmake made: head, bare (no mesh, no normals), many (100 expressions) and rig.
// Screenshots stay in WORK_DIRECTORY.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { blendDifference, changedShare, launch, limitDriver, openPage, results, run, tooMuch } from './common.mjs';

const [facezip, browserPath, packages, work] = process.argv.slice(2);
const packagePath = join(packages, 'head');
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
const description = JSON.parse(readFileSync(join(packagePath, 'package.json')));
const names = description.expressions;

/** Serves a package on a free port; { url, stop }. */
async function serve(path) {
  const server = spawn(facezip, ['view', path, '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  const line = await new Promise((resolve, reject) => {
    server.stdout.once('data', (data) => resolve(String(data)));
    server.once('exit', (code) => reject(new Error(`facezip view ended with ${code}`)));
  });
  server.stdout.resume();
  return { url: line.match(/http:\S+/)[0], stop: () => server.kill('SIGINT') };
}

/** Opens a page and waits until it shows the package. */
async function open(browser, url) {
  const page = await openPage(browser, url);
  await page.evaluate(() => globalThis.facezip.ready);
  return page;
}

const bake = (page, weights, index) => page.evaluate(([beta, i]) => {
  globalThis.facezip.setWeights(beta);
  // As text: an array of a million numbers takes minutes to come over.
  return Array.from(globalThis.facezip.bake(i), (byte) => String.fromCharCode(byte)).join('');
}, [weights, index]);
const difference = (page, weights, gain) =>
  blendDifference({ facezip, packagePath, description, work }, page, bake, weights, gain);

async function screenshot(page, name) {
  await page.waitForFunction(() => globalThis.facezip.settled);
  return page.screenshot({ path: join(work, `${name}.png`) });
}

async function moveSlider(page, parent, name, value) {
  await page.locator(`${parent} input[name="${name}"]`).evaluate((input, to) => {
    input.value = to;
    input.dispatchEvent(new Event('input'));
  }, value);
}

const tests = {
  async 'sliders move the picture'(page) {
    const neutral = await screenshot(page, 'neutral');
    await moveSlider(page, '#expressions', names[0], 1);
    const moved = await screenshot(page, 'expression');
    assert.ok(changedShare(neutral, moved) > 0.005, `only ${changedShare(neutral, moved)} of the picture changed`);
    await page.click('#neutral');
    assert.equal(changedShare(neutral, await screenshot(page, 'neutral_again')), 0);
    await page.click('#random');
    assert.ok((await page.locator('#expressions output').allTextContents()).some((value) => Number(value) > 0));
    await page.selectOption('#preset', names[1]);
    assert.equal(await page.locator(`#expressions input[name="${names[1]}"]`).inputValue(), '1');
  },

  async 'the shader computes what facezip blend does'(page) {
    const vectors = [{}, { [names[0]]: 1 }, { [names[1]]: 0.37, [names[3]]: 0.8 },
      Object.fromEntries(names.map((name, n) => [name, ((n * 37) % 100) / 250]))];
    for (const weights of vectors) {
      const largest = await difference(page, weights);
      console.log(`  largest difference ${largest}/255 at ${JSON.stringify(weights).slice(0, 60)}`);
      assert.ok(largest <= 1.5, `${largest}/255`);
      if (Object.keys(weights).length === 0) assert.equal(largest, 0);
    }
  },

  async 'gains are saved, and blend --gain agrees'(page) {
    await moveSlider(page, '#gains', names[0], 1.8);
    const regions = (description.regions ?? []).map((region) => region.name);
    for (const [r, name] of regions.entries()) await moveSlider(page, '#regions', name, 0.25 * (r % 7));
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
    const preset = join(work, 'gains.json');
    await download.saveAs(preset);
    const saved = JSON.parse(readFileSync(preset));
    assert.equal(saved.expressions[names[0]], 1.8);
    assert.equal(saved.regions[regions[1]], 0.25);
    const largest = await difference(page, { [names[0]]: 0.5, [names[2]]: 0.9 }, ['--gain', preset]);
    console.log(`  largest difference with gains ${largest}/255`);
    assert.ok(largest <= 1.5, `${largest}/255`);
    await page.click('#reset');
    assert.ok(await difference(page, { [names[0]]: 0.5, [names[2]]: 0.9 }, ['--gain', preset]) > 4);
    await page.setInputFiles('#load', preset);
    await page.waitForFunction(() => document.getElementById('note').textContent.includes('in force'));
    assert.deepEqual(await page.evaluate(() => globalThis.facezip.preset), saved);
    writeFileSync(join(work, 'other.json'), JSON.stringify({ ...saved, package: 'another face' }));
    await page.setInputFiles('#load', join(work, 'other.json'));
    await page.waitForFunction(() => document.getElementById('note').textContent.includes('another face'));
    await page.click('#reset');
  },

  async 'a clip plays'(page) {
    const clip = join(work, 'clip.csv');
    writeFileSync(clip, `frame,${names[2]},${names[0]}\n0,0.25,0.5\n1,0.25,0.5\n`);
    await page.setInputFiles('#clip', clip);
    await page.waitForFunction(([name]) => document.querySelector(`#expressions input[name="${name}"]`).value === '0.25', [names[2]]);
    assert.equal(await page.locator(`#expressions input[name="${names[0]}"]`).inputValue(), '0.5');
    writeFileSync(clip, 'nobody\n1\n');
    await page.setInputFiles('#clip', clip);
    await page.waitForFunction(() => document.getElementById('note').textContent.includes('"nobody"'));
    await page.click('#neutral');
  },

  async 'a clip is one that blend --animation takes'(page) {
    const clip = join(work, 'strict.csv');
    const taken = (text) => {
      writeFileSync(clip, text);
      return spawnSync(facezip, ['blend', packagePath, '--animation', clip, '--output', join(work, 'strict', '%04d.{map}.png')]).status === 0;
    };
    const said = async (text) => {
      writeFileSync(clip, text);
      await page.evaluate(() => { document.getElementById('note').textContent = ''; });
      await page.setInputFiles('#clip', clip);
      await page.waitForFunction(() => document.getElementById('note').textContent !== '');
      return page.locator('#note').textContent();
    };
    const weights = ['0.5', '"0.5"', ' "+.5" ', '5.', '-1e-50', '+-1', '0x10', '0b1', '1e39', '1e400', '1_0', '1e', '.', '+', '-+1', '', '""', 'inf',
      'nan', '\u00a00.5', '1;5'];
    for (const text of [...weights.map((weight) => `${names[0]}\n${weight}\n`), `"frame", "${names[0]}"\r\n1,1\r\n`, `"${names[0]}\n1\n`]) {
      const wanted = taken(text);
      assert.equal((await said(text)).includes('1 frames'), wanted, JSON.stringify(text));
    }
    assert.match(await said(`${names[0]}\n-1000000\n`), /1 frames/);
    // Of face trackers: time and turns of the head, columns of nobody, per cent, rows without a face.
    const tracked = 'Timecode,BlendShapeCount,' + names[0].toUpperCase() + ',nobody,HeadYaw\n00:00:01:02.3,61,70,x,0.1\n00:00:01:03.3,0\n';
    assert.ok(taken(tracked));
    assert.match(await said(tracked), /2 frames; no expression is called nobody; weights up to 70: 1 is the whole/);
    for (const weight of ['1000001', '-2e6', '1e39', '0x10']) {
      assert.match(await said(`${names[0]}\n${weight}\n`), /line 2, column 1: ".*" is not a number from -1000000 to 1000000/);
    }
    await page.click('#neutral');
  },

  async 'sliders say what is in force beyond their ends'(page) {
    const shown = (parent, name) => page.locator(`${parent} label:has(input[name="${name}"]) output`).textContent();
    const clip = join(work, 'beyond.csv');
    writeFileSync(clip, `${names[0]},${names[1]}\n-0.5,1.25\n`);
    await page.setInputFiles('#clip', clip);
    await page.waitForFunction(() => document.getElementById('note').textContent.includes('beyond.csv: 1 frames'));
    await page.waitForFunction((name) => document.querySelector(`#expressions input[name="${name}"]`).value === '1', names[1]);
    assert.equal(await shown('#expressions', names[0]), '-0.50');
    assert.equal(await shown('#expressions', names[1]), '1.25');
    await page.click('#neutral');
    const preset = { format: 'facezip-gains', version: 1, package: description.name, expressions: { [names[0]]: 16 } };
    await page.evaluate((text) => globalThis.facezip.setPreset(text), JSON.stringify(preset));
    assert.equal(await shown('#gains', names[0]), '16.00');
    await page.click('#reset');
    assert.equal(await shown('#gains', names[0]), '1.00');
    await moveSlider(page, '#expressions', names[0], 0.3);
    assert.equal(await shown('#expressions', names[0]), '0.30');
    await page.click('#neutral');
  },

  async 'every view draws something of its own'(page) {
    await moveSlider(page, '#expressions', names[0], 1);
    let before = await screenshot(page, 'shaded');
    for (const mode of await page.locator('#mode option').evaluateAll((all) => all.map((option) => option.value))) {
      if (mode === 'shaded') continue;
      await page.selectOption('#mode', mode);
      const shown = await screenshot(page, mode);
      assert.ok(changedShare(before, shown) > 0.02, `${mode} looks like the view before it`);
      before = shown;
    }
    await page.check('#flat');
    await screenshot(page, 'flat');
    await page.selectOption('#mode', 'shaded');
    await page.uncheck('#flat');
  },

  async 'it says what it costs'(page) {
    await page.waitForFunction(() => /\d+ frames\/s\s+[\d.]+ MB/.test(document.getElementById('stats').textContent));
    console.log(`  ${await page.locator('#stats').textContent()}`);
  },
};

const browser = await launch(browserPath);
const server = await serve(packagePath);
const page = await open(browser, server.url);
for (const [name, body] of Object.entries(tests)) await run(name, () => body(page));
await run('no console errors, nothing loaded from elsewhere', () => assert.deepEqual(page.errors, []));
await page.close();

await run('it says when there is no WebGL 2', async () => {
  const without = await browser.newPage();
  await without.addInitScript(() => {
    const get = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind === 'webgl2' ? null : get.call(this, kind, ...rest);
    };
  });
  await without.goto(server.url);
  await without.waitForSelector('#message:not([hidden])');
  assert.match(await without.locator('#message').textContent(), /needs WebGL 2/);
  await without.close();
});
server.stop();

await run('a folder opens without a server', async () => {
  execFileSync(facezip, ['view', packagePath, '--output', join(work, 'page')]);
  const local = await open(browser, pathToFileURL(join(work, 'page', 'index.html')).href);
  await local.evaluate((name) => globalThis.facezip.setWeights({ [name]: 1 }), names[0]);
  await screenshot(local, 'from_disk');
  assert.deepEqual(local.errors, []);
  await local.close();
});
await run('a package without mesh and normals is shown flat', async () => {
  const bare = await serve(join(packages, 'bare'));
  const flat = await open(browser, bare.url);
  assert.match(await flat.locator('#note').textContent(), /no mesh/);
  const before = await screenshot(flat, 'bare');
  await moveSlider(flat, '#expressions', names[0], 1);
  assert.ok(changedShare(before, await screenshot(flat, 'bare_moved')) > 0.005);
  assert.deepEqual(flat.errors, []);
  await flat.close();
  bare.stop();
});

await run('textures in blocks go to the GPU, and give what blend gives', async () => {
  for (const format of ['bc7', 'astc-5x5']) {
    const path = join(packages, format);
    const shown = await serve(path);
    const page = await open(browser, shown.url);
    const own = JSON.parse(readFileSync(join(path, 'package.json')));
    for (const weights of [{}, { [names[1]]: 0.37, [names[3]]: 0.8 }]) {
      const largest = await blendDifference({ facezip, packagePath: path, description: own, work }, page, bake, weights);
      console.log(`  ${format}: largest difference ${largest}/255 at ${JSON.stringify(weights)}`);
      assert.ok(largest <= 1.5, `${largest}/255`);
    }
    await screenshot(page, `blocks_${format}`);
    assert.deepEqual(page.errors, []);
    await page.close();
    shown.stop();
  }
});
await run('it says which blocks a graphics driver lacks', async () => {
  const shown = await serve(join(packages, 'astc-5x5'));
  const refused = await browser.newPage();
  await refused.addInitScript(() => {
    const get = WebGL2RenderingContext.prototype.getExtension;
    WebGL2RenderingContext.prototype.getExtension = function (name) { return /astc/.test(name) ? null : get.call(this, name); };
  });
  await refused.goto(shown.url);
  await refused.waitForSelector('#message:not([hidden])');
  assert.match(await refused.locator('#message').textContent(), /astc-5x5 blocks, which this graphics driver does not sample/);
  await refused.close();
  shown.stop();
});

await run('a clip weighs an expression called time', async () => {
  const timed = join(work, 'timed');
  cpSync(join(packages, 'bare'), timed, { recursive: true });
  writeFileSync(join(timed, 'package.json'),
    JSON.stringify({ ...JSON.parse(readFileSync(join(timed, 'package.json'))), expressions: ['time', ...names.slice(1)] }));
  const clip = join(work, 'timed.csv');
  writeFileSync(clip, `frame,time\n7,0.25\n7,0.25\n`);
  const shown = await serve(timed);
  try {
    const clock = await open(browser, shown.url);
    await clock.setInputFiles('#clip', clip);
    await clock.waitForFunction(() => document.getElementById('note').textContent.includes('2 frames'));
    await clock.waitForFunction(() => document.querySelector('#expressions input[name="time"]').value === '0.25');
    await clock.close();
  } finally {
    shown.stop();
  }
});

await run('100 expressions', async () => {
  const many = await serve(join(packages, 'many'));
  const crowd = await open(browser, many.url);
  assert.equal(await crowd.locator('#expressions input').count(), 100);
  const before = await screenshot(crowd, 'many');
  await crowd.evaluate(() => globalThis.facezip.setWeights({ [globalThis.facezip.expressions[99]]: 1 }));
  assert.ok(changedShare(before, await screenshot(crowd, 'many_last')) > 0.001);
  assert.deepEqual(crowd.errors, []);
  await crowd.close();
  many.stop();
});
await run('it says what a graphics driver takes too little of', async () => {
  const many = await serve(join(packages, 'many'));
  for (const [limits, text] of tooMuch) {
    const refused = await browser.newPage();
    await refused.addInitScript(limitDriver, limits);
    await refused.goto(many.url);
    await refused.waitForSelector('#message:not([hidden])');
    assert.equal(await refused.locator('#message').textContent(), text);
    await refused.close();
  }
  many.stop();
});
await run('a rig is posed by its shapes, mesh and textures', async () => {
  const rig = await serve(join(packages, 'rig'));
  const posed = await open(browser, rig.url);
  const shapes = await posed.evaluate(() => globalThis.facezip.expressions.length - globalThis.facezip.morphs.length);
  assert.equal(shapes, 0, 'expressions without a morph target');
  const name = 'browInnerUp';
  for (const [mode, flat] of [['neutral', false], ['texture', true]]) {  // mesh alone, texture alone
    await posed.selectOption('#mode', mode);
    await posed.setChecked('#flat', flat);
    await moveSlider(posed, '#expressions', name, 0);
    const before = await screenshot(posed, `rig_${mode}`);
    await moveSlider(posed, '#expressions', name, 1);
    assert.ok(changedShare(before, await screenshot(posed, `rig_${mode}_moved`)) > 0.005, mode);
  }
  assert.deepEqual(posed.errors, []);
  await posed.close();
  rig.stop();
});
await run('bad input gets one clear error', async () => {
  const fails = (code, wanted, ...args) => {
    const { status, stderr } = spawnSync(facezip, args, { encoding: 'utf8' });
    assert.equal(status, code, `${args.join(' ')}: ${stderr}`);
    assert.match(stderr, wanted);
    assert.equal(stderr.trim().split('\n').length, 1, stderr);
  };
  const busy = createServer();
  await new Promise((done) => busy.listen(0, '127.0.0.1', done));
  fails(3, /--port: expected a port that is free/, 'view', packagePath, '--port', String(busy.address().port));
  busy.close();
  fails(3, /no such file/, 'view', join(work, 'nowhere'));
  const exported = join(work, 'exported');
  fails(3, /mesh: expected a package with meshes/, 'export', join(packages, 'bare'), '--target', 'gltf', '--output', exported);
  assert.ok(!existsSync(exported));
  mkdirSync(exported);
  writeFileSync(join(exported, 'thesis.txt'), 'not to be lost');
  fails(5, /exported/, 'export', packagePath, '--target', 'gltf', '--output', exported);
  fails(5, /exported/, 'view', packagePath, '--output', exported);
  assert.ok(existsSync(join(exported, 'thesis.txt')));
  fails(3, /another face/, 'blend', packagePath, '--weights', `${names[0]}=1`, '--gain', join(work, 'other.json'),
    '--output', join(work, 'x.png'));
  fails(3, /ends in \.html/, 'report', join(packages, 'capture'), packagePath, '--output', join(work, 'report.pdf'));
});

await run('the report shows plots, pictures and sliders without a network', async () => {
  const report = await openPage(browser, pathToFileURL(join(packages, 'report.html')).href);
  assert.ok(await report.locator('svg.plot path').count() > 8);
  const images = await report.locator('img').evaluateAll((all) => all.map((image) => image.naturalWidth));
  assert.ok(images.length > 3 * names.length * description.maps.length && images.every((width) => width > 0), `${images}`);
  await report.locator('.expression input').first().fill('80');
  assert.match(await report.locator('.pair .over').first().getAttribute('style'), /80%/);
  for (const heading of ['Quality and memory', 'Expressions: albedo, captured and decoded', 'Expressions: normal, captured and decoded', 'Convergence of the permutation search', 'Error against the number of masks: albedo']) {
    assert.equal(await report.getByRole('heading', { name: heading }).count(), 1, heading);
  }
  await report.screenshot({ path: join(work, 'report.png'), fullPage: true });
  await report.setViewportSize({ width: 380, height: 700 });
  assert.ok(await report.evaluate(() => document.documentElement.scrollWidth) <= 380, 'wider than a phone');
  assert.deepEqual(report.errors, []);
  await report.close();
});
await browser.close();
process.exit(results.failed ? 1 : 0);
