// The tab of scans: files in, what they are and what was repaired, how many triangles they need, and files out.
import { Cancelled } from './engine.js';
import { ChoiceSection } from '../src/choice.js';
import { give } from '../src/packed.js';
import { tellProvenance } from '../src/page.js';
import { counted, element, number, saveAs, whole } from '../src/text.js';

const units = [['um', 'µm'], ['mm', 'mm'], ['cm', 'cm'], ['m', 'm'], ['inch', 'inch'], ['ft', 'ft']];
const metres = { um: 1e-6, mm: 1e-3, cm: 1e-2, m: 1, inch: 0.0254, ft: 0.3048 };
const rules = [['recommended', 'keeps tolerances (recommended)'], ['paper', 'least Ip on a grid (paper)']];
const errors = [
  ['mean_distance', 'mean distance', 'of the body\'s size'],
  ['hausdorff', 'largest distance', 'of the body\'s size'],
  ['inertia', 'inertia', 'of the tensor'],
  ['widths', 'length, width and height', 'of each'],
  ['thickness', 'wall thickness', 'of the thickness'],
];
// A slider of shares: from a thirtieth to thirty times the default, in steps that multiply.
const steps = 60, spread = 30;
const shareAt = (usual, step) => Number((100 * usual * spread ** ((2 * step) / steps - 1)).toPrecision(2));

const plainWord = /^[A-Za-z0-9\-_=./,:+@%]+$/;
const quoted = (word) => (plainWord.test(word) ? word : `'${word.replaceAll('\'', '\'\\\'\'')}'`);

export class ScansTab {
  constructor(host, engine) {
    Object.assign(this, { host, engine, scans: [], busy: false, wanted: false });
    this.buildInput();
    this.buildQuestion();
    this.state = element('p', null, host, { role: 'status', class: 'soft state' });
    this.buildProgress();
    this.result = element('div', null, host, { class: 'result', hidden: '' });
    this.buildOutput();
  }

  begin(version, tolerances) {
    this.usual = tolerances;
    this.sliders = errors.map(([name, text, of]) => this.addTolerance(name, text, of));
    this.tell(`scree ${version} is ready. Nothing leaves this computer.`);
    this.update();
  }

  tell(text, isError = false) {
    this.state.textContent = text;
    this.state.classList.toggle('error', isError);
  }

  // ---- files in ----

  buildInput() {
    const { host } = this;
    element('h1', 'How many triangles does your scan need?', host, { class: 'before' });
    const drop = element('label', null, host, { class: 'drop' });
    element('span', 'Drop scans here, or pick them', drop, { class: 'call' });
    element('span', 'STL, PLY, OBJ, OFF, 3MF or glTF, closed or not. They are read, repaired and decimated in this page and never leave your computer.', drop, { class: 'soft before' });
    this.picker = element('input', null, drop, { type: 'file', 'aria-label': 'Scans', id: 'file', multiple: '', accept: '.stl,.ply,.obj,.off,.3mf,.glb,.gltf,model/stl' });
    this.picker.addEventListener('change', () => {
      this.add([...this.picker.files]);
      this.picker.value = '';
    });
    addEventListener('dragover', (event) => {
      event.preventDefault();
      drop.classList.add('over');
    });
    addEventListener('dragleave', () => drop.classList.remove('over'));
    addEventListener('drop', (event) => {
      event.preventDefault();
      drop.classList.remove('over');
      this.add([...event.dataTransfer.files]);
    });
    const row = element('div', null, host, { class: 'controls' });
    const label = element('label', 'Coordinates are in ', row);
    this.unit = element('select', null, label, { id: 'unit' });
    element('option', 'which unit?', this.unit, { value: '', disabled: '', selected: '' });
    units.forEach(([value, text]) => element('option', text, this.unit, { value }));
    this.unit.addEventListener('change', () => this.work());
    this.sample = element('button', 'Try it with a sample', row, { type: 'button', id: 'sample', class: 'before' });
    this.sample.addEventListener('click', () => this.addSample());
    this.list = element('ul', null, host, { class: 'scans' });
  }

  add(files) {
    for (const file of files) {
      if (this.scans.some((scan) => scan.file.name === file.name)) {
        this.tell(`${file.name} is there already: remove it first.`, true);
        continue;
      }
      const scan = { file, unit: null, log: [], failure: null, open: false };
      this.scans.push(scan);
      this.show(scan);
    }
    this.work();
  }

  // Made here, in millimetres; a little coarser than a scanner would, to be quick.
  async addSample() {
    const name = 'fp-1.stl';
    if (this.busy || this.scans.some((scan) => scan.file.name === name)) return;
    this.unit.value = 'mm';
    await this.during('making a sample', async () => {
      const { code, complaints, files } = await this.engine.ask({ do: 'program', words: ['sample', 'fp-1', '--resolution', '0.8mm', '-o', name], wanted: [name] });
      if (code) throw new Error(complaints.join(' '));
      this.add([new File([files[0]], name)]);
    });
    this.work();
  }

  show(scan) {
    scan.item = element('li', null, this.list);
    const head = element('div', null, scan.item, { class: 'scan' });
    element('strong', scan.file.name, head);
    scan.told = element('span', ` ${number(scan.file.size / 1e6, 3)} MB`, head, { class: 'soft' });
    element('button', 'Remove', head, { type: 'button', 'aria-label': `Remove ${scan.file.name}` }).addEventListener('click', () => this.remove(scan));
    scan.advice = element('div', null, scan.item);
    scan.details = element('details', null, scan.item, { hidden: '' });
    element('summary', 'What it is, and what was repaired', scan.details);
    scan.text = element('pre', null, scan.details, { class: 'log', tabindex: 0 });
  }

  tellScan(scan) {
    scan.advice.replaceChildren();
    if (scan.failure) {
      scan.told.textContent = ` ${scan.failure}`;
      scan.told.classList.add('error');
      this.offerAdvice(scan);
      return;
    }
    scan.told.textContent = ` ${(scan.log[0] ?? '').replace(`${scan.file.name}: `, '')}`;
    scan.text.textContent = scan.log.slice(1).join('\n');
    scan.details.hidden = scan.log.length < 2;
  }

  // Where the program names the repair that would help, a button that does it.
  offerAdvice(scan) {
    const [, option, does] = scan.failure.match(/`scree repair .* -o closed\.stl (--[^`]+)` ([^;]*)/) ?? [];
    if (!option) return;
    const button = element('button', `Repair it by ${option}, which ${does}`, scan.advice, { type: 'button', class: 'advice' });
    button.addEventListener('click', () => this.busy || this.working || this.repair(scan, option.split(' ')));
  }

  // The scan repaired by the program takes its place.
  async repair(scan, options) {
    const name = `${scan.file.name.replace(/\.[^.]*$/, '')}-closed.ply`;
    const done = await this.during(`repairing ${scan.file.name}`, async () => {
      const { code, complaints, files } = await this.engine.ask({ do: 'program', words: ['repair', scan.file.name, '-u', this.unit.value, ...options, '-o', name],
        files: [[scan.file.name, scan.file]], wanted: [name] });
      if (code) throw new Error(complaints.join(' '));
      this.scans.splice(this.scans.indexOf(scan), 1);
      scan.item.remove();
      this.add([new File([files[0]], name)]);
    });
    if (done) this.work();
  }

  async remove(scan) {
    if (this.busy) this.engine.cancel();
    while (this.busy || this.working) await new Promise((resolve) => setTimeout(resolve, 10));
    const index = this.opened().indexOf(scan);
    this.scans.splice(this.scans.indexOf(scan), 1);
    scan.item.remove();
    if (index >= 0) await this.engine.ask({ do: 'close', index });
    this.result.hidden = this.output.hidden = true;
    this.host.classList.remove('answered');
    this.wanted = true;
    this.work();
  }

  opened() {
    return this.scans.filter((scan) => scan.open);
  }

  // ---- what is asked ----

  buildQuestion() {
    this.question = element('details', null, this.host, { class: 'question' });
    element('summary', 'What the level must keep', this.question);
    const row = element('div', null, this.question, { class: 'controls' });
    const label = element('label', 'Choose by ', row);
    this.rule = element('select', null, label, { id: 'rule' });
    rules.forEach(([value, text]) => element('option', text, this.rule, { value }));
    this.rule.addEventListener('change', () => this.ask());
    this.tolerances = element('div', null, this.question, { class: 'tolerances' });
    this.weightRow = element('label', 'Weight of the triangles: Ip = eps_s + W Nr/Nm, W = ', this.question, { hidden: '' });
    this.weight = element('input', null, this.weightRow, { type: 'number', min: 0.001, max: 1000, step: 'any', value: 1 });
    this.weight.addEventListener('change', () => this.ask());
    this.usualButton = element('button', 'Back to the defaults', this.question, { type: 'button' });
    this.usualButton.addEventListener('click', () => {
      this.rule.value = 'recommended';
      this.weight.value = 1;
      this.sliders.forEach((slider) => slider.set(steps / 2));
      this.ask();
    });
    this.command = element('code', null, element('p', 'The same at a command line: ', this.question, { class: 'soft command' }));
  }

  addTolerance(name, text, of) {
    const usual = this.usual[name];
    const label = element('label', `${text} within `, this.tolerances, { class: 'tolerance' });
    const value = element('output', null, label);
    const input = element('input', null, label, { type: 'range', min: 0, max: steps, step: 1, class: 'slider', 'data-error': name });
    const slider = {
      name,
      // percent, in the digits that are shown and that the program gets
      get percent() {
        return Number(input.value) === steps / 2 ? Number((100 * usual).toPrecision(6)) : shareAt(usual, Number(input.value));
      },
      get isUsual() {
        return Number(input.value) === steps / 2;
      },
      set(step) {
        input.value = step;
        value.textContent = `${this.percent} % ${of}`;
        input.setAttribute('aria-valuetext', value.textContent);
      },
    };
    slider.set(steps / 2);
    input.addEventListener('input', () => {
      slider.set(Number(input.value));
      this.ask();
    });
    return slider;
  }

  // The choice as the worker takes it, with the words that ask the program for the same.
  choice() {
    const rule = rules.findIndex(([name]) => name === this.rule.value);
    const weight = Number(this.weight.value) > 0 ? Number(this.weight.value) : 1;
    const changed = this.sliders.filter((slider) => !slider.isUsual);
    const words = ['scree', 'choose', ...this.scans.filter((scan) => !scan.failure).map((scan) => scan.file.name), '-u', this.unit.value || 'mm'];
    if (rule > 0) words.push('--rule', rules[rule][0]);
    if (weight !== 1) words.push('--weight', String(weight));
    if (changed.length) words.push('-t', changed.map((slider) => `${slider.name}=${slider.percent}%`).join(','));
    words.push('--json');
    return { rule, weight, tolerances: Object.fromEntries(changed.map((slider) => [slider.name, slider.percent / 100])), command: words.map(quoted).join(' ') };
  }

  ask() {
    this.weightRow.hidden = this.rule.value === 'recommended';
    this.tolerances.hidden = this.rule.value !== 'recommended';
    this.wanted = true;
    this.update();
    this.work();
  }

  // ---- work ----

  buildProgress() {
    this.progress = element('div', null, this.host, { class: 'controls', hidden: '' });
    this.bar = element('progress', null, this.progress, { max: 1, value: 0, 'aria-label': 'Progress' });
    this.cancel = element('button', 'Cancel', this.progress, { type: 'button', id: 'cancel' });
    this.cancel.addEventListener('click', () => this.engine.cancel());
    this.engine.onProgress = (phase, fraction) => {
      this.bar.value = fraction;
      this.tell(`${this.doing}: ${phase} ${Math.round(100 * fraction)} %`);
    };
  }

  // One thing at a time; what fails is told. Whether it came to its end.
  async during(what, act) {
    this.busy = true;
    this.doing = what;
    this.tell(`${what} ...`);
    this.bar.removeAttribute('value');
    this.progress.hidden = false;
    this.update();
    try {
      this.tell((await act()) ?? '');
      return true;
    } catch (error) {
      if (error instanceof Cancelled) {
        this.scans.forEach((scan) => (scan.open = false));
        this.tell('Cancelled.');
      } else {
        this.tell(error.message, true);
      }
      return false;
    } finally {
      this.busy = false;
      this.progress.hidden = true;
      this.update();
    }
  }

  // Opens what is not open, and chooses where something changed, until nothing is left to do or one stops it.
  async work() {
    if (this.busy || this.working) return;
    this.working = true;
    while (await this.step());
    this.working = false;
    this.update();
  }

  // The next thing to do; false: there is none, or it did not come to its end.
  async step() {
    const unit = this.unit.value;
    if (!unit) {
      if (this.scans.length) this.tell('Which unit are the coordinates in? Scanners mostly write millimetres; an STL does not say.');
      return false;
    }
    if (this.scans.some((scan) => scan.open && scan.unit !== unit)) {
      this.engine.cancel();
      this.scans.forEach((scan) => (scan.open = false));
    }
    const next = this.scans.find((scan) => !scan.open && (!scan.failure || scan.unit !== unit));
    if (next) return this.open(next);
    return this.wanted && this.opened().length > 0 && this.choose();
  }

  async open(scan) {
    scan.unit = this.unit.value;
    scan.failure = null;
    scan.told.classList.remove('error');
    this.wanted = true;
    if (!this.section) this.prepare();
    return this.during(scan.file.name, async () => {
      try {
        const { log } = await this.engine.ask({ do: 'open', file: scan.file, name: scan.file.name, unit: metres[scan.unit] });
        Object.assign(scan, { log, open: true });
      } catch (error) {
        if (error instanceof Cancelled) throw error;
        scan.failure = error.message;
      }
      this.tellScan(scan);
    });
  }

  // While the worker is busy with the first scan.
  prepare() {
    this.section = new ChoiceSection(this.result, null);
    this.section.first.after(this.output);
    this.made = element('div', null, this.result);
    this.warm = this.section.warm();
  }

  async choose() {
    this.wanted = false;
    const choice = this.choice();
    const done = await this.during('choosing', async () => {
      const answer = await this.engine.ask({ do: 'choose', choice });
      await this.warm;
      this.tellChoice(answer);
    });
    if (done && !this.wanted) document.body.dataset.chosen = String(Number(document.body.dataset.chosen ?? 0) + 1);
    return done;
  }

  tellChoice({ json, provenance, levels, memory }) {
    this.json = json;
    const choice = JSON.parse(new TextDecoder().decode(json));
    const folder = { choice, levels: levels.map(([name, bytes]) => {
      give(`levels-${name}`, bytes);
      return [name, `levels-${name}`];
    }) };
    this.result.hidden = this.output.hidden = false;
    this.host.classList.add('answered');
    this.section.tell(folder);
    this.made.replaceChildren();
    tellProvenance(this.made, { choice, provenance: JSON.parse(new TextDecoder().decode(provenance)) });
    document.body.dataset.memory = memory;
  }

  // ---- files out ----

  buildOutput() {
    this.output = element('div', null, this.host, { hidden: '' });
    element('h2', 'Take it with you', this.output);
    const row = element('div', null, this.output, { class: 'controls' });
    const format = element('label', 'The level under the slider as ', row);
    this.format = element('select', null, format, { id: 'format' });
    ['stl', 'ply', 'obj'].forEach((ending) => element('option', ending.toUpperCase(), this.format, { value: ending }));
    const density = element('label', 'of density ', row);
    this.density = element('input', null, density, { type: 'number', min: 1, max: 30000, step: 'any', value: 2000, id: 'density' });
    density.append(' kg/m³');
    const files = element('div', null, this.output, { class: 'controls' });
    const button = (text, id, act) => {
      const made = element('button', text, files, { type: 'button', id });
      made.addEventListener('click', () => this.busy || this.working || act());
      return made;
    };
    button('Mesh', 'save-mesh', () => this.saveLevel('mesh'));
    button('Mass and inertia (JSON)', 'save-mass', () => this.saveLevel('mass'));
    button('Choice (JSON)', 'save-choice', () => saveAs('choice.json', 'application/json', this.json));
    button('Report (HTML)', 'save-report', () => this.during('writing the report', async () => {
      const { report } = await this.engine.ask({ do: 'report' });
      saveAs('report.html', 'text/html', new TextDecoder().decode(report).replace('@SCRIPT@', () => globalThis.reportScript));
    }));
    button('Clump of spheres (CSV)', 'save-clump', () => this.saveClump());
  }

  // The level that is looked at: of which scan, and its triangles.
  looked() {
    const { object, row } = this.section.state;
    const { name } = this.section.objects[object];
    return { index: object, name, count: this.section.levelsOf(object).trace[row].count };
  }

  saveLevel(what) {
    const { index, name, count } = this.looked();
    const ending = this.format.value, density = Number(this.density.value) || 2000;
    return this.during('writing', async () => {
      const files = await this.engine.ask({ do: 'level', index, count, ending, density });
      if (what === 'mesh') saveAs(`${name}.${ending}`, 'application/octet-stream', files.mesh);
      else saveAs(`${name}.mass.json`, 'application/json', files.mass);
    });
  }

  // Of each scan the level chosen: {name, bytes of a PLY, unit in m}.
  async levels() {
    const made = [];
    if (this.busy || !this.section?.objects) return made;
    for (const [index, object] of this.section.objects.entries()) {
      const count = object[object.default].triangle_count;
      const { mesh } = await this.engine.ask({ do: 'level', index, count, ending: 'ply', density: 2000 });
      made.push({ name: object.name, bytes: mesh, unit: metres[this.unit.value] });
    }
    return made;
  }

  // The program's own, of the file: fitted to the same mesh, whatever was chosen here.
  saveClump() {
    const { index, name } = this.looked();
    return this.during(`fitting spheres to ${name}`, async () => {
      const { file } = this.opened()[index];
      const { code, out, complaints, files } = await this.engine.ask({ do: 'program',
        words: ['clump', file.name, '-u', this.unit.value, '-o', 'clump'], files: [[file.name, file]], wanted: [`clump/${name}.csv`] });
      if (code || !files[0]) throw new Error(complaints.join(' '));
      saveAs(`${name}.csv`, 'text/csv', files[0]);
      return `${name}.csv: ${out.filter((line) => line.includes('spheres: ')).join(' ')}`;
    });
  }

  update() {
    const usable = this.opened().length;
    this.sample.disabled = this.busy;
    this.question.hidden = this.scans.length === 0;
    if (this.sliders) this.command.textContent = this.choice().command.replace(/ --json$/, usable ? ' -o result' : '');
    this.output.querySelectorAll('button').forEach((button) => (button.disabled = this.busy || !usable));
    this.host.dataset.busy = String(Boolean(this.busy || this.working));
  }
}
