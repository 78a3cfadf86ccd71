// Numbers as people read them, elements from text, tables that can be saved.

export const known = (x) => x !== null && x !== undefined && Number.isFinite(x);

// 1 particle, 2 particles
export const counted = (n, word) => `${whole(n)} ${word}${n === 1 ? '' : 's'}`;
export const whole = (n) => (n === null || n === undefined ? '–' : Number(n).toLocaleString('en'));

// A few digits, without zeros at the end: 0.00123, 12.3, 1.2e-7.
export function number(x, digits = 4) {
  if (x === null || x === undefined || !Number.isFinite(Number(x))) return '–';
  const small = Math.abs(x) < 1e-4 && Number(x) !== 0;
  const [mantissa, exponent] = (small ? Number(x).toExponential(digits - 1) : Number(x).toPrecision(digits)).split('e');
  if (Number(exponent) > 0 && Number(exponent) < 6) return String(Number(`${mantissa}e${exponent}`));
  const short = mantissa.includes('.') ? mantissa.replace(/\.?0+$/, '') : mantissa;
  return exponent ? `${short}e${Number(exponent)}` : short;
}

// Evenly spaced numbers, with the digits that tell neighbours apart.
export function ticks(at) {
  const step = at.length > 1 ? at[1] - at[0] : Math.abs(at[0]) || 1;
  const power = (v) => Math.floor(Math.log10(v) + 1e-9);
  return at.map((v) => number(Math.round(v / step) * step, 2 + Math.max(0, power(Math.max(Math.abs(v), step)) - power(step))));
}

export const percent = (x) => (Math.abs(x) < 1e-10 ? '0 %' : `${number(100 * x, 2)} %`); // below: rounding

export function rpText(rp) {
  if (!(rp > 0)) return '–';
  if (rp >= 0.1) return rp.toFixed(2);
  const [mantissa, exponent] = rp.toExponential(1).split('e');
  return `${mantissa}e${Number(exponent)}`;
}

// Texts from files become text nodes and attributes, never markup.
export function element(tag, text, parent, attributes = {}) {
  const made = document.createElement(tag);
  if (text !== undefined && text !== null) made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent?.append(made);
  return made;
}

// A part that can be folded.
export function folded(host, title, open = !matchMedia('(max-width: 40rem)').matches) {
  const made = element('details', null, host, { class: 'part', ...(open ? { open: '' } : {}) });
  element('h2', title, element('summary', null, made));
  return made;
}

export function saveAs(name, type, content) {
  const url = URL.createObjectURL(new Blob([content], { type }));
  const anchor = element('a', '', document.body, { href: url, download: name });
  anchor.click();
  anchor.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

// RFC 4180.
export function csvText(rows) {
  const cell = (x) => (/[",\r\n]/.test(String(x)) ? `"${String(x).replaceAll('"', '""')}"` : x ?? '');
  return rows.map((row) => row.map(cell).join(',')).join('\r\n') + '\r\n';
}

export function saveButton(host, label, file, rows) {
  element('button', label, host, { type: 'button', class: 'save' })
    .addEventListener('click', () => saveAs(file, 'text/csv', csvText(rows())));
}

// columns: [{head, value(row) for the file, text(row) for the eye, draw(row, cell) instead of it}]; the first is the row's name. Columns that say nothing
// of any row are left out.
export function table(host, all, rows, file, caption) {
  const says = (x) => x !== null && x !== undefined && x !== '';
  const columns = all.filter(({ value }, i) => i === 0 || rows.some((row) => says(value(row))));
  const made = element('table', null, element('div', null, host, { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption }));
  element('caption', caption, made);
  const top = element('tr', null, element('thead', null, made));
  columns.forEach(({ head }) => element('th', head, top, { scope: 'col' }));
  const body = element('tbody', null, made);
  for (const row of rows) {
    const line = element('tr', null, body);
    columns.forEach((column, i) => {
      const text = (column.text ?? column.value)(row);
      const cell = element(i ? 'td' : 'th', text ?? '–', line, i ? { 'data-label': column.head } : { scope: 'row' });
      column.draw?.(row, cell);
    });
  }
  saveButton(host, 'Save as CSV', file, () => [columns.map((c) => c.head), ...rows.map((row) => columns.map((c) => c.value(row)))]);
  return made;
}
