// SPDX-License-Identifier: MIT
// The exported C as WebAssembly, directions of gravity, and how a robot is seated.
const { Quaternion, Vector3 } = THREE;
const vector = (numbers, at = 0) => new Vector3().fromArray(numbers, at);
const Z = new Vector3(0, 0, 1), ROOM = 1 << 22;

const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

class Runtime {
  constructor(c, { answers, drawn }) {
    c.memory.grow((ROOM + answers.blob.length + drawn.blob.length) >> 16);
    Object.assign(this, { c, buffer: c.memory.buffer, free: (c.__heap_base.value + 15) & ~15 });
    [this.map, this.drawn] = [this.kept(answers), this.kept(drawn)];
  }

  // Keep some tables; what is asked goes behind them.
  kept({ stem, blob }) {
    const at = this.free, bytes = bytesOf(blob);
    new Uint8Array(this.buffer).set(bytes, at);
    this.free = (at + bytes.length + 15) & ~15;
    return (what, ...more) => this.c[stem + what](at, bytes.length, ...more);
  }

  // The answers for one posture under many directions (3 numbers each).
  at(params, gravity) {
    const count = gravity.length / 3, into = this.free, down = into + 4 * params.length;
    const status = down + 12 * count, reading = (status + count + 15) & ~15;
    new Float32Array(this.buffer, into, params.length).set(params);
    new Float32Array(this.buffer, down, 3 * count).set(gravity);
    this.map("at", BigInt(count), into, down, status, reading);
    const seen = new DataView(this.buffer);
    return Array.from({ length: count }, (_, i) => {
      const [sdg, tip, height] = new Float32Array(this.buffer, reading + 16 * i, 3);
      const over = [seen.getUint8(reading + 16 * i + 12), seen.getUint8(reading + 16 * i + 13)];
      return { status: seen.getInt8(status + i), sdg, tip, height, over };
    });
  }

  // Rests, their edges and the boundary of a posture, in lists as runtime/smap_host_region.h has them.
  pose(params) {
    const into = this.free, counts = into + 4 * params.length, out = counts + 12;
    new Float32Array(this.buffer, into, params.length).set(params);
    this.drawn("pose", into, counts, out);
    let at = out;
    const rows = (count, size, make) => Array.from({ length: count }, () => {
      const row = new Float32Array(this.buffer, at, size);
      at += 4 * size;
      return make(row);
    });
    const [facets, edges, segments] = new Int32Array(this.buffer, counts, 3);
    return {
      facets: rows(facets, 7, (r) =>
        ({ plane: vector(r), centre: vector(r, 3), height: r[6] })),
      edges: rows(edges, 10, (r) => ({
        facet: r[0], start: vector(r, 1), stop: vector(r, 4), part: r[7], contacts: [r[8], r[9]],
      })),
      segments: rows(segments, 8, (r) =>
        ({ start: vector(r), stop: vector(r, 3), over: [r[6], r[7]] })),
    };
  }
}

// In degrees.  Heading 0: nose down; positive: to the left (lutgen/analysis/tilt.py).
function tilted(tilt, heading) {
  const [t, h] = [tilt / DEGREES, heading / DEGREES], s = Math.sin(t);
  return new Vector3(s * Math.cos(h), s * Math.sin(h), -Math.cos(t));
}

function angles({ x, y, z }) {
  const flat = Math.hypot(x, y), round = (angle) => Number((angle * DEGREES).toFixed(4));
  return { tilt: round(Math.atan2(flat, -z)), heading: flat > 1e-9 ? round(Math.atan2(y, x)) : 0 };
}

// Lambert's azimuthal projection: the nose at the top, left at the left; 1 at the rim.
function toDisc({ x, y, z }, rim) {
  const scale = Math.sqrt(2 * Math.max(1 - z, 1e-12)) * Math.sin(rim / 2);
  return [-y / scale, x / scale];
}

function fromDisc(x, y, rim) {
  const s = Math.sin(rim / 2), r = Math.min(Math.hypot(x, y) * s, 1), k = 2 * Math.sqrt(1 - r * r);
  return new Vector3(k * s * y, -k * s * x, 2 * r * r - 1);
}

// Gravity in the body of a robot that is put on a plane, in whose frame gravity is given
// (`_settled` of lutgen/channels/resting.py): with the least inclined rest that carries it.
function seated({ facets, edges }, gravity) {
  let best = null, up = -2, nearest = null, most = -Infinity;
  facets.forEach((facet) => {
    const above = facet.plane.clone().multiplyScalar(-facet.height);
    const turn = new Quaternion(1, 0, 0, 0);
    if (above.z > 1e-12 - 1) turn.setFromUnitVectors(Z, above); // else half a turn about x
    const g = gravity.clone().applyQuaternion(turn);
    const walls = edges.filter((edge) => facets[edge.facet] === facet);
    const inside = Math.min(1, ...walls.map(({ start, stop }) =>
      new Vector3().crossVectors(stop, start).normalize().dot(g)));
    if (inside >= 0 && above.z > up) [best, up] = [g, above.z];
    if (inside > most) [nearest, most] = [g, inside];
  });
  return best ?? nearest ?? gravity;
}

// The facet whose plane the ray along g pierces first.
function pierced({ facets }, g) {
  const rate = (facet) => facet.plane.dot(g);
  const first = facets.reduce((a, b) => (rate(b) > rate(a) ? b : a), facets[0]);
  return first && rate(first) > 0 ? first : null;
}
