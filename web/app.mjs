// Makes scree.html, the page that computes in the browser: one file with the WebAssembly inside, allowed to run its own
// scripts and nothing else. usage: node app.mjs FOLDER OUT      FOLDER has scree_web.js and scree_web.wasm
import { readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { bundle, hash, licences } from './bundle.mjs';

// What draws is the report's script, which stands in the page once: the page's modules are imported from it, and the
// reports that it saves get it (app/loader.js).
const shared = {
  name: 'shared',
  setup: (build) => build.onResolve({ filter: /\/src\/\w+\.js$/ }, () => ({ path: 'scree-report', external: true })),
};
const [folder, out] = process.argv.slice(2);
const report = await bundle('src/main.js');
const main = await bundle('app/main.js', { plugins: [shared] });
const worker = await bundle('app/worker.js', { format: 'iife' });
const { script: loader } = await bundle('app/loader.js');
const style = report.style + main.style;
const pack = (content) => gzipSync(content, { level: 9 }).toString('base64');
const parts = {
  SCRIPT: hash(loader), STYLE: hash(style), CSS: style, LICENCES: licences(), LOADER: loader,
  REPORT: pack(report.script), MAIN: pack(main.script), WASM: pack(readFileSync(`${folder}/scree_web.wasm`)),
  WORKER: pack(`${readFileSync(`${folder}/scree_web.js`, 'utf8')}\n${worker.script}`),
};
writeFileSync(out, readFileSync('app/page.html', 'utf8').replace(/@([A-Z]+)@/g, (_, name) => parts[name]));
