// Bundles the page: node build.mjs OUTPUT_DIRECTORY
import { build } from 'esbuild';
import { copyFileSync, mkdirSync } from 'node:fs';

const output = process.argv[2] ?? 'dist';
mkdirSync(output, { recursive: true });
const shared = {
  bundle: true,
  legalComments: 'inline',  // the licence notices of what is bundled
  target: 'es2020',
  charset: 'ascii',
  loader: { '.h': 'text' },
};
await build({
  ...shared,
  entryPoints: ['src/main.js'],
  outfile: `${output}/viewer.js`,
  minify: true,
  format: 'iife',  // a classic script works from file: too
});
// The page of `facezip landmarks`.
await build({
  ...shared,
  entryPoints: ['src/landmarks.js'],
  outfile: `${output}/landmarks.js`,
  minify: true,
  format: 'iife',
});
// What `facezip export --target three` writes: the page it goes into brings three.js.
await build({
  ...shared,
  entryPoints: ['src/three.js'],
  outfile: `${output}/facezip_three.js`,
  format: 'esm',
  external: ['three', 'three/*'],
});
for (const file of ['index.html', 'viewer.css', 'landmarks.html', 'landmarks.css']) copyFileSync(`src/${file}`, `${output}/${file}`);
