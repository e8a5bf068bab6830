// SPDX-License-Identifier: MIT
// Sliders for joints, gravity and friction, the choice of the map's joints, buttons.
import { DEGREES, digits, plain } from "./words.js";

const element = (tag, has = {}, ...inside) => {
  const made = Object.assign(document.createElement(tag), has);
  made.append(...inside);
  return made;
};

// A row: a label, a slider, a number that can be typed.
function row(name, label, { low, high, step, unit }, change) {
  const range = element("input", { type: "range", min: low, max: high, step, id: `range-${name}` });
  const box = element("input", { type: "number", min: low, max: high, step: "any", id: `number-${name}` });
  box.setAttribute("aria-label", `${label}, ${unit || "number"}`);
  range.addEventListener("input", () => change(Number(range.value)));
  box.addEventListener("change", () => Number.isFinite(box.valueAsNumber) && change(box.valueAsNumber));
  const line = element("div", { className: "row" }, element("label", { htmlFor: range.id, textContent: label, title: label }),
    range, box, element("span", { className: "unit", textContent: unit }));
  return { line, put(value) {
    range.value = value;
    range.setAttribute("aria-valuetext", `${digits(value, 4)} ${unit}`);
    if (document.activeElement !== box) box.value = Number(value.toFixed(4));
  } };
}

export class Controls {
  constructor(root, scene, state) {
    this.scene = scene;
    this.joints = scene.parameters.map((p, i) => {
      const span = { low: p.min / p.unit, high: p.max / p.unit, step: (p.max - p.min) / p.unit / 1000, unit: p.sign.trim() };
      return row(`joint-${i}`, plain(p.name), span, (x) => state.setJoint(i, x * p.unit));
    });
    const turn = (name, label, low, high) => row(name, label, { low, high, step: 0.1, unit: "°" },
      (x) => state.set({ [name]: (Math.min(high, Math.max(low, x)) * Math.PI) / 180 }));
    const most = Math.round(scene.rim * DEGREES);
    this.tilt = turn("tilt", "tilt", 0, most);
    this.heading = turn("heading", "heading", -180, 180);
    this.mu = row("mu", "friction μ", { low: 0, high: 2, step: 0.01, unit: "" }, (x) => state.set({ mu: Math.min(2, Math.max(0, x)) }));
    const find = (selector) => root.querySelector(selector);
    find("#joints").append(...this.joints.map((one) => one.line));
    find("#gravity").append(this.tilt.line, this.heading.line, this.mu.line);
    this.modes = [...root.querySelectorAll("[name=mode]")];
    this.modes.forEach((one) => one.addEventListener("change", () => state.set({ mode: one.value })));
    this.picks = [find("#axis-x"), find("#axis-y")];
    this.picks.forEach((pick, place) => {
      pick.append(...scene.parameters.map((p, i) => element("option", { value: i, textContent: plain(p.name) })));
      pick.addEventListener("change", () => {
        const axes = [...state.now.axes];
        axes[place] = Number(pick.value);
        state.set({ axes });
      });
    });
    this.what = find("#what");
    this.what.addEventListener("change", () => state.set({ what: this.what.value }));
    this.show(state.now);
  }

  show(now) {
    this.joints.forEach((one, i) => one.put(now.q[i] / this.scene.parameters[i].unit));
    this.tilt.put(now.tilt * DEGREES);
    this.heading.put(((((now.heading * DEGREES) % 360) + 540) % 360) - 180);
    this.mu.put(now.mu);
    this.modes.forEach((one) => (one.checked = one.value === now.mode));
    this.picks.forEach((pick, place) => (pick.value = now.axes[place] ?? ""));
    this.what.value = now.what;
  }
}
