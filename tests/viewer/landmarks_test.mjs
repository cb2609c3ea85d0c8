// The page of `facezip landmarks` in Chromium: node landmarks_test.mjs FACEZIP CHROMIUM WORK_DIRECTORY
// Screenshots stay in WORK_DIRECTORY.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { request } from 'node:http';
import { join } from 'node:path';
import { encode } from 'fast-png';
import { launch, openPage, results, run } from './common.mjs';

const [facezip, browserPath, work] = process.argv.slice(2);
rmSync(work, { recursive: true, force: true });
const [scans, template] = [join(work, 'scans'), join(work, 'template')];
for (const folder of [scans, template]) mkdirSync(folder, { recursive: true });

const side = 31;
/** A bump, as somebody's nose; far from the origin, as scanners put them. */
function place(i, shift) {
  const [s, t] = [(i % side) / (side - 1), Math.floor(i / side) / (side - 1)];
  return [1000 + 200 * s + shift, 250 * t, 60 * Math.exp(-12 * ((s - 0.5) ** 2 + (t - 0.5) ** 2))];
}
function obj(shift, material = '') {
  let text = material;
  for (let i = 0; i < side * side; ++i) text += `v ${place(i, shift).join(' ')}\n`;
  for (let i = 0; i < side * side; ++i) text += `vt ${(i % side) / (side - 1)} ${Math.floor(i / side) / (side - 1)}\n`;
  for (let y = 0; y + 1 < side; ++y) {
    for (let x = 0; x + 1 < side; ++x) {
      const corner = (dx, dy) => { const v = (y + dy) * side + x + dx + 1; return `${v}/${v}`; };
      text += `f ${corner(0, 0)} ${corner(1, 0)} ${corner(1, 1)} ${corner(0, 1)}\n`;
    }
  }
  return text;
}
const at = (x, y) => y * side + x;
const vertices = { noseTip: at(15, 15), leftEye: at(20, 22), rightEye: at(10, 22), toString: at(15, 4) };
writeFileSync(join(template, 'neutral.obj'), obj(0));
writeFileSync(join(template, 'landmarks.json'), JSON.stringify(vertices));
for (const [name, shift] of [['neutral', 3], ['smile', 5]]) {
  writeFileSync(join(scans, `${name}.obj`), obj(shift));
  const data = new Uint8Array(3 * 64 * 64).map((_, i) => [180, 40, 40][i % 3] + (Math.floor(i / 3) % 64));
  writeFileSync(join(scans, `${name}.png`), encode({ width: 64, height: 64, data, channels: 3, depth: 8 }));
}
const other = { toString: [1, 2, 3] };
writeFileSync(join(scans, 'landmarks.json'), JSON.stringify({ smile: other }));
const saved = () => JSON.parse(readFileSync(join(scans, 'landmarks.json')));

/** Serves the scans on a free port; { url, stop }. */
async function serve() {
  const server = spawn(facezip, ['landmarks', scans, '--template', template, '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  const line = await new Promise((resolve, reject) => {
    server.stdout.once('data', (data) => resolve(String(data)));
    server.once('exit', (code) => reject(new Error(`facezip landmarks ended with ${code}`)));
  });
  server.stdout.resume();
  return { url: line.match(/http:[^ ]+/)[0], stop: () => server.kill('SIGINT') };
}

/** Clicks where a vertex of the scan is seen. */
async function click(page, vertex, shift) {
  const [x, y] = await page.evaluate(async (point) => {
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const seen = globalThis.facezip.page.panes.scan.project(point);
    return [seen.x, seen.y];
  }, place(vertex, shift));
  await page.mouse.click(x, y);
}
function assertNear(got, vertex, shift) {
  const wanted = place(vertex, shift);
  const distance = Math.hypot(...wanted.map((w, axis) => w - got[axis]));
  assert.ok(distance < 2, `${got} is ${distance} from ${wanted}`);  // of 200: a pixel is half of that
}
const current = (page) => page.evaluate(() => globalThis.facezip.page.state.name);

const tests = {
  async 'clicks place landmarks, one after the other, and are saved'(page) {
    await page.screenshot({ path: join(work, 'start.png') });
    assert.equal(await page.locator('#save').isDisabled(), true);
    for (const [name, vertex] of Object.entries(vertices).sort()) {
      assert.equal(await current(page), name);
      await click(page, vertex, 3);
    }
    await page.screenshot({ path: join(work, 'placed.png') });
    assert.deepEqual(saved(), { smile: other }, 'nothing is saved before it is asked for');
    await page.locator('#save').click();
    await page.waitForFunction(() => document.getElementById('note').textContent === 'Saved to landmarks.json');
    const now = saved();
    for (const [name, vertex] of Object.entries(vertices)) assertNear(now.neutral[name], vertex, 3);
    assert.deepEqual(now.smile, other);
    assert.deepEqual(readdirSync(scans).sort(), ['landmarks.json', 'neutral.obj', 'neutral.png', 'smile.obj', 'smile.png']);
  },

  async 'drags turn the scan, and place nothing'(page) {
    const before = await page.evaluate(() => JSON.stringify(globalThis.facezip.page.landmarks.scans));
    await page.mouse.move(420, 300);
    await page.mouse.down();
    await page.mouse.move(470, 320, { steps: 5 });
    await page.mouse.up();
    assert.equal(await page.evaluate(() => JSON.stringify(globalThis.facezip.page.landmarks.scans)), before);
    const turned = await page.evaluate(() => globalThis.facezip.page.panes.scan.camera.position.x
      - globalThis.facezip.page.panes.scan.controls.target.x);
    assert.ok(Math.abs(turned) > 1, `turned by ${turned}`);
    await click(page, at(15, 15), 3);  // still where it is seen
    assertNear(await page.evaluate(() => Object.values(globalThis.facezip.page.landmarks.past).length
      && globalThis.facezip.page.landmarks.scans.neutral.noseTip), vertices.noseTip, 3);
  },

  async 'another scan, corrections and their undoing'(page) {
    await page.locator('#scans').selectOption('smile');
    await page.waitForFunction(() => globalThis.facezip.page.panes.scan.about.name === 'smile');
    await page.waitForFunction(() => !document.getElementById('note').textContent.startsWith('Reading'));
    await page.locator('#landmarks button', { hasText: 'leftEye' }).click();
    await click(page, vertices.leftEye, 5);
    const placed = () => page.evaluate(() => globalThis.facezip.page.landmarks.scans.smile);
    assertNear((await placed()).leftEye, vertices.leftEye, 5);
    await page.keyboard.press('Control+z');
    assert.deepEqual(await placed(), other);
    await page.locator('#landmarks button', { hasText: 'toString' }).click();
    await page.keyboard.press('Delete');
    assert.deepEqual(await placed(), {});
    await page.locator('#undo').click();
    assert.deepEqual(await placed(), other);
    await page.screenshot({ path: join(work, 'smile.png') });
  },

  async 'what is no landmarks is not saved, and said'(page) {
    const before = readFileSync(join(scans, 'landmarks.json'), 'utf8');
    await page.evaluate(() => { globalThis.facezip.page.landmarks.scans.smile.leftEye = ['x', 0, 0]; });
    await page.keyboard.press('Control+s');
    await page.waitForFunction(() => document.getElementById('note').textContent.startsWith('Not saved: '));
    assert.match(await page.locator('#note').textContent(), /smile\.leftEye/);
    assert.equal(readFileSync(join(scans, 'landmarks.json'), 'utf8'), before);
  },

  async 'strangers save nothing'(page, url) {
    const before = readFileSync(join(scans, 'landmarks.json'), 'utf8');
    const { port } = new URL(url);
    const put = (headers, body = '{"smile": {}}') => new Promise((resolve, reject) => {
      const sent = request({ port, host: '127.0.0.1', path: '/landmarks', method: 'PUT', headers }, (answer) => {
        answer.resume();
        resolve(answer.statusCode);
      });
      sent.on('error', reject);
      sent.end(body);
    });
    const ours = { Host: `127.0.0.1:${port}`, Origin: `http://127.0.0.1:${port}` };
    assert.equal(await put({ ...ours, Origin: 'http://evil.example' }), 403);
    assert.equal(await put({ ...ours, Host: 'evil.example' }), 403);
    assert.equal(await put({ Host: ours.Host }), 405);
    assert.equal(readFileSync(join(scans, 'landmarks.json'), 'utf8'), before);
    assert.equal(await put(ours, '{"stranger": {"a": [0, 0, 0]}}'), 200);
    assert.equal(readFileSync(join(scans, 'landmarks.json'), 'utf8'), before, 'a scan that is not there');
  },
};

const missing = spawnSync(facezip, ['landmarks', join(work, 'none'), '--template', template, '--port', '0'], { encoding: 'utf8' });
assert.equal(missing.status, 3);
assert.match(missing.stderr, /no such directory/);
assert.ok(!existsSync(join(work, 'none')));

const server = await serve();
const browser = await launch(browserPath);
try {
  const page = await openPage(browser, server.url);
  await page.evaluate(() => globalThis.facezip.ready.then(() => true));
  for (const [name, test] of Object.entries(tests)) await run(name, () => test(page, server.url));
  assert.deepEqual(page.errors, []);
} finally {
  await browser.close();
  server.stop();
}
process.exit(results.failed ? 1 : 0);
