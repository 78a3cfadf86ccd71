// Makes scree.html, the page that computes in the browser: one file with the WebAssembly inside, allowed to run its own
// scripts and nothing else. usage: node app.mjs FOLDER OUT      FOLDER has scree_web.js and scree_web.wasm
import { readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { bundle, hash, licences } from './bundle.mjs';

const [folder, out] = process.argv.slice(2);
const main = await bundle('app/main.js');
const worker = await bundle('app/worker.js', { format: 'iife' });
const { script: loader } = await bundle('app/loader.js');
const pack = (content) => gzipSync(content, { level: 9 }).toString('base64');
const parts = {
  SCRIPT: hash(loader), STYLE: hash(main.style), CSS: main.style, LICENCES: licences(), LOADER: loader,
  MAIN: pack(main.script), WASM: pack(readFileSync(`${folder}/scree_web.wasm`)),
  WORKER: pack(`${readFileSync(`${folder}/scree_web.js`, 'utf8')}\n${worker.script}`),
};
writeFileSync(out, readFileSync('app/page.html', 'utf8').replace(/@([A-Z]+)@/g, (_, name) => parts[name]));
