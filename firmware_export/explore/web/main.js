// SPDX-License-Identifier: MIT
// Puts the page together: the worker answers, every part shows what it answered.
import { measureAgain } from "./canvas.js";
import { Controls } from "./controls.js";
import { Disc } from "./disc.js";
import { attachDrag } from "./drag.js";
import { JointMap } from "./jointmap.js";
import { attachKeys } from "./keys.js";
import { isDark, palette } from "./palette.js";
import { picture, savePicture, saveTable, table } from "./save.js";
import { Stage } from "./stage.js";
import { State } from "./state.js";
import { Trace } from "./trace.js";
import { Verdict } from "./verdict.js";
import { tipText, VERDICT } from "./words.js";

const find = (selector) => document.querySelector(selector);
const held = JSON.parse(find("#data").textContent);
const { scene } = held;

// Answers take a while to start, and so does a program that draws: the worker is there first.
const source = new Blob([find("#worker").textContent], { type: "text/javascript" });
const worker = new Worker(URL.createObjectURL(source));
worker.postMessage({ kind: "start", held });

const state = new State(scene);
const stage = new Stage(find("#view"), scene);
const disc = new Disc(find("#disc"), scene, state), jointMap = new JointMap(find("#map"), scene, state);
const trace = new Trace(find("#trace")), verdict = new Verdict(find("#verdict"), scene);
const controls = new Controls(document, scene, state);
const flat = [disc, jointMap, trace];
const timing = { script: [], frames: [], ready: 0, first: 0, shown: 0 };

// ---- the worker: one state at a time, always the newest; pictures when nothing moves ----------------
let flying = null, waiting = true, fresh = null, count = 0, still = 0;
const batches = new Map();

function ask() {
  if (flying !== null || !waiting) return;
  waiting = false;
  flying = ++count;
  const { q, mode, tilt, heading } = state.now;
  sent = { q: [...q], mode };
  worker.postMessage({ kind: "state", id: flying, q, mode, tilt, heading });
}
let sent = null;

function pictures(fine) {
  const { q, mode, tilt, heading, axes, what } = state.now;
  worker.postMessage({ kind: "disc", id: ++count, q, rim: scene.rim, size: fine ? 180 : 72 });
  if (axes.length) worker.postMessage({ kind: "map", id: ++count, q, axes, mode, tilt, heading, what, size: fine ? 61 : 21 });
}

const told = {
  ready({ check }) {
    timing.ready = performance.now();
    timing.check = check;
  },
  state(answer) {
    flying = null;
    fresh = { answer, ...sent };
    ask();
  },
  disc: (message) => (disc.next = message),
  map: (message) => (jointMap.next = message),
  batch: ({ id, rows }) => batches.get(id)(rows),
  failed({ text }) {
    find("#failed").hidden = false;
    find("#failed").textContent = `This browser could not start the answers: ${text}`;
  },
};
worker.onmessage = ({ data }) => timed(() => told[data.kind](data));
ask();

// ---- frames: everything is drawn here, and the script's time of each is kept ---------------------------
let spent = 0;
function timed(what) {
  const begin = performance.now();
  what();
  spent += performance.now() - begin;
}

let lastRough = 0;
function later() {
  if (!timing.shown) return;
  clearTimeout(still);
  still = setTimeout(() => pictures(true), 250);
  const now = performance.now();
  if (now - lastRough > 120) {
    lastRough = now;
    pictures(false);
  }
}

function draw() {
  if (fresh) {
    const { answer, q, mode } = fresh;
    fresh = null;
    stage.show(answer, q);
    disc.show(answer);
    verdict.show(answer, state.now);
    trace.add(answer, { q, mode });
    last = answer;
  }
  for (const part of [disc, jointMap]) {
    if (part.next) {
      part.take(part.next);
      part.next = null;
    }
  }
  for (const part of flat) {
    if (part.dirty) {
      part.dirty = false;
      part.paint();
    }
  }
  if (stage.answer) picture3d();
}
let last = null;

// The robot without its ground would be drawn for nothing, and disc and map wait for the first picture.
function picture3d() {
  if (stage.render()) timing.first ||= performance.now();
  if (!timing.shown && stage.isShown()) {
    timing.shown = performance.now();
    later();
  }
}

function frame(now) {
  timed(draw);
  timing.script.push(spent);
  timing.frames.push(now);
  if (timing.script.length > 600) {
    timing.script.shift();
    timing.frames.shift();
  }
  spent = 0;
  requestAnimationFrame(frame);
}

// ---- changes --------------------------------------------------------------------------------------------
function recolour() {
  document.documentElement.dataset.theme = isDark(state.now.theme) ? "dark" : "light";
  const colours = palette(state.now.theme);
  stage.paint(colours);
  flat.forEach((part) => part.recolour(colours));
}

state.listen((now, change) => timed(() => {
  controls.show(now);
  if ("theme" in change) recolour();
  if ("mu" in change && last) verdict.show(last, now);
  if (["q", "mode", "tilt", "heading"].some((key) => key in change)) {
    waiting = true;
    ask();
  }
  jointMap.dirty = true;
  later();
}));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
new ResizeObserver(() => {
  measureAgain();
  flat.forEach((part) => (part.dirty = true));
}).observe(find("main"));

const lines = () => [
  `${scene.name}: ${last ? `${VERDICT[last.exact.status]}, tip angle ${tipText(last.exact.tip)} (exported ${tipText(last.exported.tip)})` : ""}`,
];
const shot = () => {
  stage.invalidate();
  stage.render(); // what is drawn can be read until the next frame alone
  return picture([find("#view"), find("#disc"), find("#map"), find("#trace")], lines(), palette(state.now.theme));
};
const buttons = {
  d: () => state.set({ theme: isDark(state.now.theme) ? "light" : "dark" }),
  g: () => state.set({ mode: state.now.mode === "ground" ? "body" : "ground" }),
  l: () => state.set({ tilt: 0, heading: 0 }),
  r: () => { state.reset(); stage.home(); stage.invalidate(); },
  p: () => savePicture(scene.name, shot()),
  c: () => saveTable(scene.name, table(scene, trace.rows)),
};
Object.entries(buttons).forEach(([key, press]) => {
  find(`[data-key="${key}"]`)?.addEventListener("click", press);
});
attachKeys(state, buttons);
attachDrag(stage, state);
stage.resize();
recolour();
requestAnimationFrame(frame);

// For tests and for whoever opens the console.
globalThis.explorer = {
  state, scene, timing, last: () => last, shot, csv: () => table(scene, trace.rows), map: () => jointMap.data, disc: () => disc.data,
  batch: (rows) => new Promise((resolve) => {
    batches.set(++count, resolve);
    worker.postMessage({ kind: "batch", id: count, rows });
  }),
};
