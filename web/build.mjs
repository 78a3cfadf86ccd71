// Bundles the page into ../src/report: C string literals in page.inc of the page up to the summary for readers without
// JavaScript and of what follows up to the data, in page_script.inc of the script. With --check: fails where a
// committed file differs.
import { readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { bundle, hash, licences, names } from './bundle.mjs';

const { script, style } = await bundle('src/main.js');
// The page in the browser takes what both share from this script (app.mjs): a name that it does not export ends here.
const taken = { name: 'taken', setup: (build) => build.onResolve({ filter: /^\.\.\/src\/\w+\.js$/ }, () => ({ path: resolve('src/main.js') })) };
await bundle('app/main.js', { plugins: [taken] });
const page = readFileSync('page.html', 'utf8')
  .replace('@SCRIPT@', hash(script)).replace('@STYLE@', hash(style)).replace('@CSS@', () => style)
  .replace('@LICENCES@', licences);
const [top, middle] = page.split('@SUMMARY@');

// Literals of at most 4000 bytes: C17 promises 4095.
function literal(name, content) {
  const bytes = Buffer.from(content, 'utf8');
  let out = `const char *const ${name}[] = {\n`;
  for (let i = 0; i < bytes.length; i += 4000) {
    let line = '';
    for (const byte of bytes.subarray(i, i + 4000)) {
      const c = String.fromCharCode(byte);
      if (c === '\n') line += '\\n';
      else if (c === '"' || c === '\\') line += '\\' + c;
      else if (c === '?') line += '\\?';
      else if (byte < 32 || byte > 126) line += '\\' + byte.toString(8).padStart(3, '0');
      else line += c;
    }
    out += `"${line}",\n`;
  }
  return `${out}NULL};\n`;
}

const packages = names.map((name) => {
  const { version, license } = JSON.parse(readFileSync(`node_modules/${name}/package.json`, 'utf8'));
  return `${name} ${version} (${license})`;
});
const head = `/* Made by web/build.mjs; not to be edited. Contains ${packages.join(', ')}:
 * licences in web/licences/. */\n`;
const files = {
  'page.inc': `${head}static ${literal('page_top', top)}static ${literal('page_middle', middle)}`,
  'page_script.inc': `${head}${literal('scree_page_script', script)}`,
};
for (const [name, content] of Object.entries(files)) {
  const target = `../src/report/${name}`;
  if (!process.argv.includes('--check')) {
    writeFileSync(target, content);
  } else if (readFileSync(target, 'utf8') !== content) {
    console.error(`src/report/${name} is not what web/ builds: run \`npm ci && npm run build\` in web/`);
    process.exit(1);
  }
}
