// SPDX-License-Identifier: MIT
// What the page shows, in one object that lives in the address behind #.

const number = (text, low, high, otherwise) => {
  const value = text === null || text === "" ? NaN : Number(text);
  return Number.isFinite(value) ? Math.min(high, Math.max(low, value)) : otherwise;
};

export function initial(scene) {
  const last = Math.min(1, scene.parameters.length - 1);
  return {
    q: scene.parameters.map((p) => p.home), mode: "ground", tilt: 0, heading: 0,
    mu: scene.friction ?? 0.8, axes: scene.parameters.length ? [0, last] : [], what: "tip", theme: "",
  };
}

export class State {
  constructor(scene) {
    this.scene = scene;
    this.now = initial(scene);
    this.listeners = [];
    this.read(location.hash);
    addEventListener("hashchange", () => {
      if (location.hash !== this.written) this.set(this.read(location.hash));
    });
  }

  listen(what) {
    this.listeners.push(what);
  }

  set(change) {
    Object.assign(this.now, change);
    this.listeners.forEach((what) => what(this.now, change));
    clearTimeout(this.later);
    this.later = setTimeout(() => this.write(), 250);
  }

  setJoint(index, value) {
    const q = [...this.now.q], { min, max } = this.scene.parameters[index];
    q[index] = Math.min(max, Math.max(min, value));
    this.set({ q });
  }

  reset() {
    const { theme } = this.now;
    this.set({ ...initial(this.scene), theme });
  }

  // In the units of the recipe, as `lutgen eval -p` takes them.
  text() {
    const query = new URLSearchParams();
    const { q, mode, tilt, heading, mu, axes, what, theme } = this.now;
    this.scene.parameters.forEach((p, i) => query.set(`p.${p.name}`, String(+(q[i] / p.unit).toPrecision(12))));
    const degrees = (x) => String(+((x * 180) / Math.PI).toFixed(4));
    const rest = { mode, tilt: degrees(tilt), heading: degrees(heading), mu, map: axes.join("."), what, theme };
    Object.entries(rest).forEach(([key, value]) => query.set(key, value));
    return `#${query}`;
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
    const query = new URLSearchParams(hash.replace(/^#/, "")), now = this.now;
    now.q = this.scene.parameters.map((p, i) =>
      number(query.get(`p.${p.name}`), p.min / p.unit, p.max / p.unit, now.q[i] / p.unit) * p.unit);
    const angle = (key, high, otherwise) => (number(query.get(key), -high, high, (otherwise * 180) / Math.PI) * Math.PI) / 180;
    now.tilt = Math.abs(angle("tilt", 180, now.tilt));
    now.heading = angle("heading", 360, now.heading);
    now.mu = number(query.get("mu"), 0, 2, now.mu);
    const among = (key, known, otherwise) => (known.includes(query.get(key)) ? query.get(key) : otherwise);
    now.mode = among("mode", ["ground", "body"], now.mode);
    now.what = among("what", ["tip", "sdg"], now.what);
    now.theme = among("theme", ["dark", "light", ""], now.theme);
    const axes = (query.get("map") || "").split(".").map(Number);
    if (axes.length === 2 && axes.every((i) => this.scene.parameters[i])) now.axes = axes;
    return now;
  }
}
