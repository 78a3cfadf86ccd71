// One exported body in MuJoCo: what it weighs, how it falls, and where it lies when it starts from given poses.
// usage: node mujoco.mjs MODULE FOLDER NAME POSES.json; prints JSON
import fs from "node:fs";
import { pathToFileURL } from "node:url";

const [module, folder, name, poses] = process.argv.slice(2);
const { default: load } = await import(pathToFileURL(module));
const mj = await load();
mj.FS.mkdir("/w");
for (const file of fs.readdirSync(folder)) mj.FS.writeFile(`/w/${file}`, fs.readFileSync(`${folder}/${file}`));
const model = mj.MjModel.loadFromXML(`/w/${name}.xml`);
const data = new mj.MjData(model);
const begin = (z, turn) => {
  mj.mj_resetData(model, data);
  data.qpos.set([0, 0, z, ...turn]);
};
const result = { mass: model.body_mass[1], inertia: [...model.body_inertia].slice(3, 6), rest: [] };
begin(100, [0.8, 0.36, 0.48, 0]);
for (let i = 0; i < 200; i++) mj.mj_step(model, data);
result.fall = { time: data.time, velocity: [...data.qvel] };
for (const { height, turn } of JSON.parse(fs.readFileSync(poses))) {
  begin(height, turn);
  while (data.time < 2) mj.mj_step(model, data);
  result.rest.push({ turn: [...data.qpos].slice(3), speed: Math.hypot(...data.qvel) });
}
const heap = mj.MjModel.loadFromXML(`/w/${name}-heap.xml`);
const bodies = new mj.MjData(heap);
for (let i = 0; i < 100; i++) mj.mj_step(heap, bodies);
result.heap = { count: heap.nbody - 1, lowest: Math.min(...[...bodies.qpos].filter((_, k) => k % 7 === 2)) };
console.log(JSON.stringify(result));
