// Bundles the page: node build.mjs OUTPUT_DIRECTORY
import { build } from 'esbuild';
import { copyFileSync, mkdirSync } from 'node:fs';

const output = process.argv[2] ?? 'dist';
mkdirSync(output, { recursive: true });
await build({
  entryPoints: ['src/main.js'],
  outfile: `${output}/viewer.js`,
  bundle: true,
  minify: true,
  legalComments: 'inline',  // the licence notices of what is bundled
  format: 'iife',           // a classic script works from file: too
  target: 'es2020',
  charset: 'ascii',
  loader: { '.h': 'text' },
});
for (const file of ['index.html', 'viewer.css']) copyFileSync(`src/${file}`, `${output}/${file}`);
