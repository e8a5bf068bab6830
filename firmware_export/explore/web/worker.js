// SPDX-License-Identifier: MIT
// Answers in the background: one state, the disc of directions, the map over two joints.
import { Exact, Exported } from "./engine.js";
import { fromDisc, pierced, seated, tilted } from "./gravity.js";
import { posture } from "./kinematics.js";
import { dot, unit } from "./vector.js";

const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
let scene, exported, exact, started;
const wanted = { disc: 0, map: 0 };

// All that is known of one state.
function answer({ q, mode, tilt, heading, down }) {
  const body = posture(scene, q);
  const made = exact.pose(body.contacts);
  const facets = exact.facets(), edges = exact.edges();
  const given = down ? unit(down) : tilted(tilt, heading);
  const g = mode === "ground" ? seated(facets, edges, given) : given;
  const seen = exact.read(g), k = pierced(facets, g), read = exported.at(q, g);
  return {
    g, made, com: body.com, contacts: body.contacts, facets, edges, segments: exact.segments(), facet: k,
    exact: seen,
    slope: k < 0 ? NaN : Math.acos(Math.min(1, Math.max(-1, dot(unit(facets[k].plane), g)))),
    exported: { status: read.status[0], sdg: read.reading[0], tip: read.reading[1], height: read.reading[2],
      over: read.over[0] },
  };
}

// Rows are computed a few at a time, so that a new state never waits.
function slowly(kind, id, rows, row, done) {
  let next = 0;
  const step = () => {
    if (wanted[kind] !== id) return;
    const until = performance.now() + 12;
    while (next < rows && performance.now() < until) row(next++);
    if (next < rows) setTimeout(step, 0);
    else done();
  };
  step();
}

// The largest value where the robot does not tip, but for where it never does.
function largest(status, value, below = Infinity) {
  let most = 0;
  for (let i = 0; i < value.length; i++) {
    if ((status[i] === 0 || status[i] === 4) && value[i] > most && value[i] < below) most = value[i];
  }
  return most;
}

// The exported verdict and tip angle over the disc, `size` places to a side; NaN beyond the rim.
function disc({ id, q, rim, size }) {
  const status = new Int8Array(size * size).fill(-128), tip = new Float32Array(size * size).fill(NaN);
  slowly("disc", id, size, (row) => {
    const places = [], gravity = [];
    for (let column = 0; column < size; column++) {
      const x = ((column + 0.5) / size) * 2 - 1, y = 1 - ((row + 0.5) / size) * 2;
      if (x * x + y * y > 1) continue;
      places.push(row * size + column);
      gravity.push(...fromDisc(x, y, rim));
    }
    const read = exported.at(q, gravity);
    places.forEach((place, i) => {
      status[place] = read.status[i];
      tip[place] = read.reading[3 * i + 1];
    });
  }, () => postMessage({ kind: "disc", id, size, rim, status, tip, most: largest(status, tip, 3.14159) }, [status.buffer, tip.buffer]));
}

// The same over two joints at the present gravity; on the ground the robot is seated anew at each node.
function map({ id, q, axes, size, mode, tilt, heading, what }) {
  const [a, b] = axes, [pa, pb] = [scene.parameters[a], scene.parameters[b]];
  const status = new Int8Array(size * size), value = new Float32Array(size * size);
  const given = tilted(tilt, heading), at = (p, part) => p.min + part * (p.max - p.min);
  slowly("map", id, size, (row) => {
    for (let column = 0; column < size; column++) {
      const here = [...q];
      here[a] = at(pa, column / (size - 1));
      if (a !== b) here[b] = at(pb, 1 - row / (size - 1));
      let g = given;
      if (mode === "ground") {
        exact.pose(posture(scene, here).contacts);
        g = seated(exact.facets(), exact.edges(), given);
      }
      const read = exported.at(here, g), place = row * size + column;
      status[place] = read.status[0];
      value[place] = read.reading[what === "sdg" ? 0 : 1];
    }
  }, () => postMessage({ kind: "map", id, size, axes, what, status, value, most: largest(status, value, what === "sdg" ? Infinity : 3.14159) },
    [status.buffer, value.buffer]));
}

const asked = {
  async start({ held }) {
    scene = held.scene;
    const map = { ...held.map, blob: bytes(held.map.blob) };
    started = Promise.all([Exported.start(bytes(held.exported), map), Exact.start(bytes(held.exact), scene.numbers)]);
    [exported, exact] = await started;
    return { kind: "ready", check: exported.check() };
  },
  state: (message) => ({ kind: "state", id: message.id, ...answer(message) }),
  // Many states at once, for tests and for programs: answers as `state`, and the reading's bits.
  batch: (message) => ({ kind: "batch", id: message.id, rows: message.rows.map((row) => {
    const { g, exact: one, exported: two } = answer(row);
    const bits = new Uint32Array(new Float32Array([two.sdg, two.tip, two.height]).buffer);
    return { g, exact: one, exported: two, bits: [...bits] };
  }) }),
};

onmessage = async ({ data }) => {
  await started; // what is asked before the modules are there waits for them
  if (data.kind === "disc" || data.kind === "map") {
    wanted[data.kind] = data.id;
    (data.kind === "disc" ? disc : map)(data);
    return;
  }
  try {
    postMessage(await asked[data.kind](data));
  } catch (error) {
    postMessage({ kind: "failed", text: String(error) });
  }
};
