// Bundles the page into ../src/report/page.inc: C string literals of the page up to the summary for readers
// without JavaScript, of what follows up to the data, and of the script. With --check: fails where the committed
// file differs.
import { readFileSync, writeFileSync } from 'node:fs';
import { bundle, hash, licences, names } from './bundle.mjs';

const { script, style } = await bundle('src/main.js');
const page = readFileSync('page.html', 'utf8')
  .replace('@SCRIPT@', hash(script)).replace('@STYLE@', hash(style)).replace('@CSS@', () => style)
  .replace('@LICENCES@', licences);
const [top, middle] = page.split('@SUMMARY@');

// Literals of at most 4000 bytes: C17 promises 4095.
function literal(name, content) {
  const bytes = Buffer.from(content, 'utf8');
  let out = `static const char *const ${name}[] = {\n`;
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
const content = `/* Made by web/build.mjs; not to be edited. Contains ${packages.join(', ')}:
 * licences in web/licences/. */
${literal('page_top', top)}${literal('page_middle', middle)}${literal('page_script', script)}`;
const target = '../src/report/page.inc';
if (process.argv.includes('--check')) {
  if (readFileSync(target, 'utf8') !== content) {
    console.error('src/report/page.inc is not what web/ builds: run `npm ci && npm run build` in web/');
    process.exit(1);
  }
} else {
  writeFileSync(target, content);
}
