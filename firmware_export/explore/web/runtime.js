// SPDX-License-Identifier: MIT
// The exported C as WebAssembly: it answers from the tables, and tells the pose that is drawn.
const FULL = 32767, NOT_HELD = 65535, ROOM = 1 << 22;

class Runtime {
  static async start({ wasm, answers, drawn }) {
    const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const self = new Runtime(), { instance } = await WebAssembly.instantiate(bytes(wasm), {});
    self.c = instance.exports;
    self.c.memory.grow((ROOM + answers.blob.length + drawn.blob.length) >> 16);
    self.buffer = self.c.memory.buffer;
    self.free = self.c.__heap_base.value;
    self.map = { ...answers, at: self.put(bytes(answers.blob)), size: bytes(answers.blob).length };
    self.drawn = { ...drawn, at: self.put(bytes(drawn.blob)), size: bytes(drawn.blob).length };
    return self;
  }

  // Keep some bytes; what is asked goes behind them.
  put(bytes) {
    const at = (this.free + 15) & ~15;
    new Uint8Array(this.buffer).set(bytes, at);
    this.free = (at + bytes.length + 15) & ~15;
    return at;
  }

  call({ stem, at, size }, what, ...more) {
    return this.c[stem + what](at, size, ...more);
  }

  // SMAP_OK where tables and indices are sound.
  check() {
    return this.call(this.map, "check") || this.call(this.drawn, "check");
  }

  // The answers for one posture under many directions (3 numbers each).
  at(params, gravity) {
    const count = gravity.length / 3;
    if (this.map.integer) return this.whole(params, gravity, count);
    const into = this.free, down = into + 4 * params.length, status = down + 12 * count;
    const reading = (status + count + 15) & ~15;
    new Float32Array(this.buffer, into, params.length).set(params);
    new Float32Array(this.buffer, down, 3 * count).set(gravity);
    this.call(this.map, "at", BigInt(count), into, down, status, reading);
    const seen = new DataView(this.buffer);
    return Array.from({ length: count }, (_, i) => {
      const [sdg, tip, height] = new Float32Array(this.buffer, reading + 16 * i, 3);
      const over = [seen.getUint8(reading + 16 * i + 12), seen.getUint8(reading + 16 * i + 13)];
      return { status: seen.getInt8(status + i), sdg, tip, height, over };
    });
  }

  // The same of a map that is read without floats, in its steps.
  whole(params, gravity, count) {
    const k = params.length, into = this.free, down = into + 2 * k * count;
    const status = down + 6 * count, reading = (status + count + 15) & ~15;
    const codes = params.map((x, i) => {
      const [low, high] = this.map.ends[i];
      const code = Math.round((x - low) / (high - low) * FULL), least = -1 - FULL;
      return x > high ? least : Math.max(code, least);
    });
    const rows = new Int16Array(this.buffer, into, k * count);
    const downs = new Int16Array(this.buffer, down, 3 * count);
    for (let i = 0; i < count; i++) {
      const g = [...gravity.slice(3 * i, 3 * i + 3)], most = Math.max(...g.map(Math.abs));
      rows.set(codes, k * i);
      downs.set(g.map((x) => Math.round(x / most * FULL)), 3 * i);
    }
    this.call(this.map, "read_i", BigInt(count), into, down, status, reading);
    const seen = new DataView(this.buffer), { steps } = this.map;
    const length = (code, step) => (code === NOT_HELD ? NaN : code * step);
    return Array.from({ length: count }, (_, i) => {
      const at = reading + 8 * i, sine = seen.getInt16(at + 2, true) / FULL;
      return {
        status: seen.getInt8(status + i), tip: Math.asin(Math.max(-1, Math.min(1, sine))),
        sdg: length(seen.getUint16(at, true), steps.sdg),
        height: length(seen.getUint16(at + 4, true), steps.height),
        over: [seen.getUint8(at + 6), seen.getUint8(at + 7)],
      };
    });
  }

  // Facets, edges and the boundary of a posture, in lists as runtime/host_pose.h has them.
  pose(params) {
    const into = this.free, counts = into + 4 * params.length, out = counts + 12;
    new Float32Array(this.buffer, into, params.length).set(params);
    this.call(this.drawn, "pose", into, counts, out);
    let at = out;
    const rows = (count, size, make) => Array.from({ length: count }, () => {
      const row = new Float32Array(this.buffer, at, size);
      at += 4 * size;
      return make(row);
    });
    const [facets, edges, segments] = new Int32Array(this.buffer, counts, 3);
    return {
      facets: rows(facets, 8, (r) =>
        ({ kind: r[0], plane: vector(r, 1), centre: vector(r, 4), height: r[7] })),
      edges: rows(edges, 11, (r) => ({
        facet: r[0], kind: r[1], start: vector(r, 2), stop: vector(r, 5), part: r[8],
        contacts: [r[9], r[10]],
      })),
      segments: rows(segments, 8, (r) =>
        ({ start: vector(r), stop: vector(r, 3), over: [r[6], r[7]] })),
    };
  }
}
