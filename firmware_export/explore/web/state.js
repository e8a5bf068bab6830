// SPDX-License-Identifier: MIT
// What the page shows, in one object that lives in the address behind #.
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

class State {
  // `changed` is told what has changed, every time.
  constructor(scene, changed) {
    Object.assign(this, { scene, changed });
    this.now = this.initial();
    this.read(location.hash);
    addEventListener("hashchange", () => {
      if (location.hash !== this.written) this.set(this.read(location.hash));
    });
  }

  initial() {
    const { parameters, friction } = this.scene, q = parameters.map((p) => p.home);
    const axes = q.length ? [0, Math.min(1, q.length - 1)] : [];
    return { q, mode: "ground", tilt: 0, heading: 0, mu: friction, axes, what: "tip", theme: "" };
  }

  set(change) {
    Object.assign(this.now, change);
    this.changed(change);
    clearTimeout(this.later);
    this.later = setTimeout(() => this.write(), 250);
  }

  // In the units of the recipe, as `lutgen eval -p` takes them.
  text() {
    const { q, tilt, heading, mu, axes, ...rest } = this.now;
    const angle = (x) => +(x * DEGREES).toFixed(4), map = axes.join(".");
    const joints = this.scene.parameters.map((p, i) =>
      [`p.${p.name}`, +(q[i] / p.unit).toPrecision(12)]);
    const numbers = { tilt: angle(tilt), heading: angle(heading), mu: mu ?? "", map };
    const all = { ...Object.fromEntries(joints), ...numbers, ...rest };
    return `#${new URLSearchParams(all)}`;
  }

  write() {
    this.written = this.text();
    try {
      history.replaceState(null, "", this.written);
    } catch {
      location.hash = this.written; // some browsers allow no more in a file
    }
  }

  // Take from an address what it says; what it does not say, or says wrongly, stays.
  read(hash) {
    const query = new URLSearchParams(hash.slice(1)), { now } = this, { parameters } = this.scene;
    const number = (key, low, high, otherwise, unit = 1) => {
      const text = query.get(key), value = text ? Number(text) : NaN;
      return Number.isFinite(value) ? clamp(value * unit, low, high) : otherwise;
    };
    const among = (key, ...known) => (known.includes(query.get(key)) ? query.get(key) : now[key]);
    now.q = parameters.map((p, i) => number(`p.${p.name}`, p.min, p.max, now.q[i], p.unit));
    now.tilt = number("tilt", 0, Math.PI, now.tilt, 1 / DEGREES);
    now.heading = number("heading", -2 * Math.PI, 2 * Math.PI, now.heading, 1 / DEGREES);
    now.mu = number("mu", 0, 2, now.mu);
    now.mode = among("mode", "ground", "body");
    now.what = among("what", "tip", "sdg");
    now.theme = among("theme", "dark", "light", "");
    const axes = (query.get("map") ?? "").split(".").map(Number);
    if (axes.length === 2 && axes.every((i) => parameters[i])) now.axes = axes;
    return now;
  }
}
