// SPDX-License-Identifier: MIT
// The two WebAssembly modules: what was exported, and the same code in double precision.
import { unit } from "./vector.js";

export const STATUS = { 0: "SMAP_OK", 4: "SMAP_ROCKS", 2: "SMAP_TIPS", 3: "SMAP_OFF_CHART",
  5: "SMAP_OFF_RANGE", 6: "SMAP_CORRUPT", "-1": "SMAP_INVALID" };
const FAMILY = { 1: "three", 2: "three", 3: "three", 4: "grid", 5: "many", 6: "search" };
const WHOLE = { 3: "points", 4: "whole" };
const ROOM = 1 << 22, NOT_HELD = 65535, FULL = 32767;

async function start(bytes) {
  const { instance } = await WebAssembly.instantiate(bytes, {});
  return instance.exports;
}

// The tables of an export behind the C that reads them.
export class Exported {
  static async start(bytes, map) {
    const self = new Exported();
    self.c = await start(bytes);
    self.map = map;
    const base = (self.c.__heap_base.value + 15) & ~15;
    const wanted = base + map.blob.length + ROOM, held = self.c.memory.buffer.byteLength;
    if (wanted > held) self.c.memory.grow(Math.ceil((wanted - held) / 65536));
    self.buffer = self.c.memory.buffer;
    new Uint8Array(self.buffer).set(map.blob, base);
    self.blob = base;
    self.rows = (base + map.blob.length + 15) & ~15;
    self.stem = `smap_${(map.integer ? WHOLE : FAMILY)[map.codec]}_host_`;
    return self;
  }

  // SMAP_OK where tables and indices are sound.
  check() {
    return this.c[`${this.stem}check`](this.blob, this.map.blob.length);
  }

  // One posture under many directions (3 numbers each): status and sdg, tip angle, height of each.
  at(params, gravity) {
    const count = gravity.length / 3;
    if (this.map.integer) return this.whole(params, gravity, count);
    const into = this.rows, down = into + 4 * params.length, status = down + 12 * count;
    const reading = (status + count + 15) & ~15;
    new Float32Array(this.buffer, into, params.length).set(params);
    new Float32Array(this.buffer, down, 3 * count).set(gravity);
    const at = this.c[`${this.stem}at`];
    at(this.blob, this.map.blob.length, BigInt(count), into, down, status, reading);
    const numbers = new Float32Array(this.buffer, reading, 4 * count);
    return {
      status: new Int8Array(this.buffer.slice(status, status + count)),
      reading: Float32Array.from({ length: 3 * count }, (_, i) => numbers[4 * Math.floor(i / 3) + (i % 3)]),
      over: Array.from({ length: count }, (_, i) => [...new Uint8Array(this.buffer, reading + 16 * i + 12, 2)]),
    };
  }

  // The same of a map that is read without floats, in its steps.
  whole(params, gravity, count) {
    const k = params.length, into = this.rows, down = into + 2 * k * count;
    const status = down + 6 * count, reading = (status + count + 15) & ~15;
    const codes = params.map((x, i) => {
      const [low, high] = this.map.ends[i];
      return x > high ? -32768 : Math.max(Math.round(((x - low) / (high - low)) * FULL), -32768);
    });
    const rows = new Int16Array(this.buffer, into, k * count), downs = new Int16Array(this.buffer, down, 3 * count);
    for (let i = 0; i < count; i++) {
      rows.set(codes, k * i);
      const g = gravity.slice(3 * i, 3 * i + 3), most = Math.max(...g.map(Math.abs));
      downs.set([...g].map((x) => Math.round((x / most) * FULL)), 3 * i);
    }
    this.c[`${this.stem}read_i`](this.blob, this.map.blob.length, BigInt(count), into, down, status, reading);
    const seen = new DataView(this.buffer), numbers = new Float32Array(3 * count), over = [];
    for (let i = 0; i < count; i++) {
      const at = reading + 8 * i, length = (code, step) => (code === NOT_HELD ? NaN : code * step);
      numbers[3 * i] = length(seen.getUint16(at, true), this.map.steps.sdg);
      numbers[3 * i + 1] = Math.asin(Math.max(-1, Math.min(1, seen.getInt16(at + 2, true) / FULL)));
      numbers[3 * i + 2] = length(seen.getUint16(at + 4, true), this.map.steps.height);
      over.push([seen.getUint8(at + 6), seen.getUint8(at + 7)]);
    }
    return { status: new Int8Array(this.buffer.slice(status, status + count)), reading: numbers, over };
  }
}

// The definition in double precision.
export class Exact {
  static async start(bytes, numbers) {
    const self = new Exact();
    self.c = await start(bytes);
    const view = (name, count) => new Float64Array(self.c.memory.buffer, self.c[name].value, count);
    self.contact = view("exact_contact", 7 * 62);
    self.gravity = view("exact_gravity", 3);
    self.answer = view("exact_answer", 6);
    self.list = { facets: view("exact_facets", 8 * 300), edges: view("exact_edges", 11 * 1600),
      segments: view("exact_segments", 8 * 4000) };
    view("exact_number", 7).set(numbers);
    return self;
  }

  pose(contacts) {
    contacts.forEach((one, i) => {
      this.contact.set([...one.centre, one.radius, ...(one.axis || [0, 0, 0])], 7 * i);
    });
    return this.c.exact_pose(contacts.length);
  }

  read(g) {
    this.gravity.set(unit(g));
    this.c.exact_read();
    const [status, sdg, tip, height, i, j] = this.answer;
    return { status, sdg, tip, height, over: [i, j] };
  }

  rows(name, size, make) {
    const count = this.c[`exact_list_${name}`](), list = this.list[name];
    return Array.from({ length: count }, (_, i) => make([...list.subarray(size * i, size * i + size)]));
  }

  facets() {
    return this.rows("facets", 8, (r) => ({ kind: r[0], plane: r.slice(1, 4), centre: r.slice(4, 7), height: r[7] }));
  }

  edges() {
    return this.rows("edges", 11, (r) => ({ facet: r[0], kind: r[1], start: r.slice(2, 5), stop: r.slice(5, 8),
      part: r[8], contacts: [r[9], r[10]] }));
  }

  segments() {
    return this.rows("segments", 8, (r) => ({ start: r.slice(0, 3), stop: r.slice(3, 6), over: [r[6], r[7]] }));
  }
}
