// The pictures of the README, from `facezip view` in Chromium: node pictures.mjs FACEZIP CHROMIUM PACKAGE OUTPUT
import { spawn } from 'node:child_process';
import { join } from 'node:path';
import { launch } from './common.mjs';

const [facezip, browserPath, packagePath, output] = process.argv.slice(2);
const server = spawn(facezip, ['view', packagePath, '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
const url = String(await new Promise((resolve) => server.stdout.once('data', resolve))).match(/http:\S+/)[0];
const browser = await launch(browserPath);
const page = await browser.newPage({ viewport: { width: 840, height: 580 }, deviceScaleFactor: 1.5 });
await page.goto(url);
await page.evaluate(() => globalThis.facezip.ready);
await page.addStyleTag({ content: '#stats { visibility: hidden }' });  // of software rendering
async function shoot(name, mode, weights) {
  await page.selectOption('#mode', mode);
  await page.evaluate((byName) => globalThis.facezip.setWeights(byName), weights);
  await page.waitForFunction(() => globalThis.facezip.settled);
  // The head alone: sliders would be too small to read.
  await page.screenshot({ path: join(output, `${name}.jpg`), type: 'jpeg', quality: 82, clip: { x: 50, y: 0, width: 420, height: 580 } });
}
await shoot('neutral', 'shaded', {});
await shoot('expression', 'shaded', { disgust_nose_sneer: 0.8, brow_raise: 0.6 });
await shoot('change', 'change', { disgust_nose_sneer: 0.8, brow_raise: 0.6 });
await browser.close();
server.kill('SIGINT');
