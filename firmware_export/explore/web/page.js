// SPDX-License-Identifier: MIT
// Puts the page together: a state is answered by the C, and every part shows the answer.
const PUSH = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1] };
const find = (selector) => document.querySelector(selector);
const element = (tag, has, ...inside) => {
  const made = Object.assign(document.createElement(tag), has);
  made.append(...inside);
  return made;
};

// What the page shows, by keys that live in the address behind #, in the units of the recipe.
class State {
  constructor({ parameters, friction }, changed) {
    const joints = (make) => Object.fromEntries(parameters.map((p) => [`p.${p.name}`, make(p)]));
    const names = parameters.map(({ name }) => name), [x = "", y = x] = names;
    const ends = joints(({ min, max }) => [min, max]);
    this.limits = { ...ends, tilt: [0, 180], heading: [-180, 180], mu: [0, 2] };
    this.choices = {
      mode: ["ground", "body"], x: names, y: names, what: ["tip", "sdg"],
      theme: ["", "dark", "light"],
    };
    this.initial = {
      ...joints(({ home }) => home), tilt: 0, heading: 0, mu: friction ?? "", mode: "ground",
      x, y, what: "tip", theme: "",
    };
    Object.assign(this, { now: { ...this.initial }, changed });
    this.read();
    addEventListener("hashchange", () => location.hash === this.written || location.reload());
  }

  set(change) {
    Object.assign(this.now, change);
    this.changed();
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      location.replace(this.written = `#${new URLSearchParams(this.now)}`);
    }, 250);
  }

  // Take from the address what it says; what it does not say, or says wrongly, stays.
  read() {
    for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
      const value = text ? Number(text) : NaN;
      if (this.choices[key]?.includes(text)) this.now[key] = text;
      if (this.limits[key] && Number.isFinite(value)) {
        this.now[key] = clamp(value, ...this.limits[key]);
      }
    }
  }
}

// Sliders, choices and the verdict.
class Controls {
  constructor(scene, state) {
    Object.assign(this, { scene, state });
    this.rows = scene.parameters.map((p) =>
      this.row("#joints", `p.${p.name}`, plain(p.name), p.sign.trim()));
    for (const key of ["tilt", "heading"]) this.rows.push(this.row("#gravity", key, key, "°"));
    this.rows.push(this.row("#gravity", "mu", "friction μ", ""));
    find("#range-tilt").max = find("#number-tilt").max = Math.round(scene.rim * DEGREES);
    const options = () => scene.parameters.map(({ name }) => new Option(plain(name), name));
    ["x", "y"].forEach((name) => find(`[name=${name}]`).append(...options()));
    this.choices = [...document.querySelectorAll("[name]:not(meta)")];
    this.choices.forEach((one) => (one.onchange = () => state.set({ [one.name]: one.value })));
  }

  // A row: a label, a slider, a number that can be typed and is cut to what there is.
  row(into, key, label, unit) {
    const [min, max] = this.state.limits[key], step = unit === "°" ? 0.1 : (max - min) / 1000;
    const has = { min, max, ariaLabel: `${label}, ${unit || "number"}` };
    const range = element("input", { type: "range", ...has, step, id: `range-${key}` });
    const box = element("input", { type: "number", ...has, step: "any", id: `number-${key}` });
    range.oninput = box.onchange = ({ target: { valueAsNumber: value } }) =>
      Number.isFinite(value) && this.state.set({ [key]: clamp(value, min, max) });
    const words = element("label", { htmlFor: range.id, textContent: label, title: label });
    const sign = element("span", { className: "unit", textContent: unit });
    find(into).append(element("div", { className: "row" }, words, range, box, sign));
    return ({ [key]: value }) => {
      range.value = value === "" ? min : value;
      range.ariaValueText = value === "" ? "none" : digits(value, 4, ` ${unit}`);
      box.value = value === "" ? "" : Number(value.toFixed(4));
    };
  }

  show(now) {
    this.rows.forEach((put) => put(now));
    this.choices.forEach((one) => {
      if (one.type === "radio") one.checked = one.value === now[one.name];
      else one.value = now[one.name];
    });
  }

  // What the exported C answers, and one sentence for readers of screens.
  verdict(answer, mu) {
    const { slope, over, height, sdg, status, tip } = answer, { unit } = this.scene;
    const [name, verdict = "no answer", colour = "tips"] = STATUS[status];
    const slides = mu === "" ? "" : Math.tan(slope) > mu ? " slides" : " holds";
    const words = {
      verdict, status: name, tip: tipText(answer),
      sdg: digits(sdg, 4, unit), height: digits(height, 4, unit), over: pairText(this.scene, over),
      slope: Number.isFinite(slope) ? `${(slope * DEGREES).toFixed(1)}°${slides}` : "–",
    };
    const at = (name) => find(`[data-is="${name}"]`);
    Object.entries(words).forEach(([name, text]) => (at(name).textContent = text));
    const kind = status === 0 && tip < CLOSE ? "close" : colour;
    at("verdict").style.color = at("status").style.color = `var(--${kind})`;
    at("slope").style.color = slides === " slides" ? "var(--rocks)" : "";
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      at("spoken").textContent = `The robot ${verdict}, ${tipText(answer, 1)} from tipping ` +
        `over ${words.over}. The exported C answers ${name}.`;
    }, 600);
  }
}

class Page {
  constructor(scene, runtime) {
    Object.assign(this, { scene, runtime });
    this.state = new State(scene, () => this.changed());
    this.stage = new Stage(find("#view"), scene);
    this.stage.attach(this.state);
    this.disc = new Disc(find("#disc"), this);
    this.map = new JointMap(find("#map"), this);
    this.sheets = scene.parameters.length ? [this.disc, this.map] : [this.disc];
    this.controls = new Controls(scene, this.state);
    this.keys();
    matchMedia(DARK).addEventListener("change", () => this.recolour());
    new ResizeObserver(() => {
      this.stage.resize();
      this.sheets.forEach((one) => (one.dirty = true));
    }).observe(find("main"));
    this.recolour();
    this.changed();
    this.frame();
  }

  // Arrows tilt gravity, letters press buttons.
  keys() {
    const { state } = this, buttons = {
      d: () => state.set({ theme: find(":root").style.colorScheme === "dark" ? "light" : "dark" }),
      g: () => state.set({ mode: state.now.mode === "ground" ? "body" : "ground" }),
      l: () => state.set({ tilt: 0, heading: 0 }),
      r: () => {
        state.set({ ...state.initial, theme: state.now.theme });
        this.stage.home();
      },
    };
    for (const one of document.querySelectorAll("button")) one.onclick = buttons[one.dataset.key];
    addEventListener("keydown", (event) => {
      const typing = /INPUT|SELECT/.test(event.target.tagName);
      if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
      const push = PUSH[event.key], press = buttons[event.key.toLowerCase()];
      if (push) {
        const step = (event.shiftKey ? 5 : 1) / DEGREES, { tilt, heading } = state.now;
        const [x, y] = push, g = tilted(tilt, heading);
        state.set(angles(g.add(new Vector3(step * x, step * y, 0))));
      } else press?.();
      if (push || press) event.preventDefault();
    });
  }

  changed() {
    this.controls.show(this.state.now);
    if (this.state.now.theme !== this.theme) this.recolour();
    this.moved = true;
  }

  // What is asked of the C, in its units.
  query() {
    const { mode, tilt, heading, x, y, what, ...now } = this.state.now, { parameters } = this.scene;
    const q = parameters.map(({ name, unit }) => now[`p.${name}`] * unit);
    const axes = [x, y].map((axis) => parameters.findIndex(({ name }) => name === axis));
    return { q, mode, down: tilted(tilt, heading), axes, what };
  }

  // All that is known of a posture under a direction.
  answer({ q, mode, down }) {
    const pose = this.runtime.pose(q), given = new Vector3(...down);
    const g = mode === "ground" ? seated(pose, given) : given, here = pierced(pose, g);
    const slope = here ? g.angleTo(here.plane) : NaN;
    return { ...this.runtime.at(q, [...g])[0], q, g, pose, here, slope };
  }

  // Answer and draw; what is left of the frame is for disc and map, most where nothing moves.
  frame() {
    const until = performance.now() + (this.moved ? 6 : 14);
    if (this.moved) {
      this.moved = false;
      this.last = this.answer(this.query());
      this.stage.show(this.last);
      this.controls.verdict(this.last, this.state.now.mu);
      this.sheets.forEach((one) => (one.stale = one.dirty = true));
    }
    if (this.stage.dirty) this.stage.render();
    this.sheets.forEach((one) => one.work(until));
    this.sheets.filter((one) => one.dirty).forEach((one) => one.paint());
    requestAnimationFrame(() => this.frame());
  }

  recolour() {
    this.theme = this.state.now.theme;
    this.colours = palette(this.theme);
    this.stage.recolour(this.colours);
    this.sheets.forEach((one) => Object.assign(one, { picture: null, dirty: true }));
  }
}

try {
  const held = JSON.parse(find("#data").textContent);
  const { instance } = await WebAssembly.instantiate(bytesOf(held.wasm));
  globalThis.explorer = new Page(held.scene, new Runtime(instance.exports, held));
} catch (error) {
  find("#failed").hidden = false;
  find("#failed").textContent = `This browser could not start the page: ${error}`;
}
