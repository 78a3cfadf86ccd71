// Fills the page from the data in it. Everything that comes from files is set as text. The page in the browser imports
// what it draws with from here, and fills itself.
import './page.css';
import { CalibrationSection } from './calibrate.js';
import { ChoiceSection } from './choice.js';
import { ClumpSection } from './clump.js';
import { decoderReady } from './packed.js';
import { tellProvenance } from './page.js';
import { setShapeColors } from './pile.js';
import { SceneSection } from './scene.js';
import { StudySection } from './study.js';
import { element } from './text.js';

export { ChoiceSection, tellProvenance };
export * from './levels.js';
export * from './packed.js';
export * from './pile.js';
export * from './text.js';
export { swatch } from './view.js';

async function fill(data) {
  const page = document.getElementById('page');
  await decoderReady;
  setShapeColors(data.shapeColors);
  for (const folder of data.folders) {
    const host = element('section', null, page);
    if (folder.choice) new ChoiceSection(host, folder);
    if (folder.clump) new ClumpSection(host, folder);
    if (folder.scene) new SceneSection(host, folder);
    if (folder.study) new StudySection(host, folder);
    if (folder.calibration) new CalibrationSection(host, folder);
    tellProvenance(host, folder, data.version);
  }
  document.querySelectorAll('body > img').forEach((picture) => picture.remove()); // of piles shown in 3D
  const titles = [...page.querySelectorAll('.title')].map((title) => title.textContent);
  if (titles.length) document.title = `${titles.slice(0, 3).join(', ')}: scree report`;
}

const data = document.getElementById('data');
if (data) {
  const wait = document.getElementById('wait');
  try {
    await fill(JSON.parse(data.textContent));
    wait.remove();
    document.body.dataset.ready = 'true';
  } catch (error) {
    wait.textContent = `This page cannot be shown in full: ${error.message}`;
    document.body.dataset.ready = 'failed';
    throw error;
  }
}
