// The page: two tabs, one for scans and one for pouring. All is computed in workers of this page.
import './app.css';
import { Engine } from './engine.js';
import { Levels } from '../src/levels.js';
import { decoderReady } from '../src/packed.js';
import { PourTab } from './pour.js';
import { ScansTab } from './scans.js';
import { element } from '../src/text.js';

const page = document.getElementById('page');
const list = document.getElementById('tabs');
const tabs = [];

function pick(index) {
  tabs.forEach(({ button, panel }, i) => {
    button.setAttribute('aria-selected', String(i === index));
    button.tabIndex = i === index ? 0 : -1;
    panel.hidden = i !== index;
  });
}

function addTab(title) {
  const index = tabs.length;
  const button = element('button', title, list, { type: 'button', role: 'tab', id: `tab-${index}`, 'aria-controls': `panel-${index}` });
  const panel = element('section', null, page, { role: 'tabpanel', id: `panel-${index}`, 'aria-labelledby': `tab-${index}` });
  button.addEventListener('click', () => pick(index));
  button.addEventListener('keydown', ({ key }) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[key];
    if (!step) return;
    const next = (index + step + tabs.length) % tabs.length;
    pick(next);
    tabs[next].button.focus();
  });
  tabs.push({ button, panel });
  return panel;
}

// Distances are measured beside the page, which stays quick.
function measureInWorker() {
  const engine = new Engine(false);
  let told = null;
  Levels.measure = (levels, mesh, most) => {
    const surface = told === levels ? null : levels.scan();
    told = levels;
    return engine.ask({ do: 'field', scan: 'shown', surface, mesh, most });
  };
}

await decoderReady;
measureInWorker();
const engine = new Engine();
const scans = new ScansTab(addTab('Scans'), engine);
new PourTab(addTab('Pour'), scans);
pick(0);
const { version, tolerances } = await engine.ready;
scans.begin(version, tolerances);
document.getElementById('wait').remove();
document.body.dataset.ready = 'true';
