// What both pages are bundled with: the report's (build.mjs) and the browser's (app.mjs).
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { build } from 'esbuild';

export const names = ['three', 'meshoptimizer'];

// {script, style} of a module and all that it imports, fit to stand in a page.
export async function bundle(entry, options = {}) {
  const { outputFiles } = await build({
    entryPoints: [entry], bundle: true, minify: true, format: 'esm', target: 'es2022', write: false,
    outdir: 'out', legalComments: 'none', charset: 'ascii', ...options,
  });
  const text = (ending) => outputFiles.find((file) => file.path.endsWith(ending))?.text.trim() ?? '';
  return { script: inPage(text('.js')), style: text('.css') };
}

const inPage = (script) => script.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
export const hash = (content) => createHash('sha256').update(content).digest('base64');
export const licences = () => names.map((name) => `${name}: ${readFileSync(`licences/${name}.txt`, 'utf8').trim()}`).join('\n\n').replaceAll('--', '- -');
