// SPDX-License-Identifier: MIT
// What is pressed and read: sliders, choices, keys, the verdict.
const PUSH = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1] };
const find = (selector) => document.querySelector(selector);
const element = (tag, has, ...inside) => {
  const made = Object.assign(document.createElement(tag), has);
  made.append(...inside);
  return made;
};

// A row: a label, a slider, a number that can be typed and is cut to what there is.
function row(into, name, { label, low, high, step, unit }, change) {
  const ends = { min: low, max: high };
  const range = element("input", { type: "range", ...ends, step, id: `range-${name}` });
  const box = element("input", { type: "number", ...ends, step: "any", id: `number-${name}` });
  box.setAttribute("aria-label", `${label}, ${unit || "number"}`);
  range.addEventListener("input", () => change(Number(range.value)));
  box.addEventListener("change", () =>
    Number.isFinite(box.valueAsNumber) && change(clamp(box.valueAsNumber, low, high)));
  const words = element("label", { htmlFor: range.id, textContent: label, title: label });
  const sign = element("span", { className: "unit", textContent: unit });
  into.append(element("div", { className: "row" }, words, range, box, sign));
  return (value) => {
    range.value = value ?? low;
    range.setAttribute("aria-valuetext", value === null ? "none" : `${digits(value, 4)} ${unit}`);
    box.value = value === null ? "" : Number(value.toFixed(4));
  };
}

class Controls {
  constructor({ scene, state }) {
    this.scene = scene;
    this.joints = scene.parameters.map((p, i) => {
      const [low, high] = [p.min / p.unit, p.max / p.unit], step = (high - low) / 1000;
      const has = { label: plain(p.name), low, high, step, unit: p.sign.trim() };
      return row(find("#joints"), `joint-${i}`, has, (x) =>
        state.set({ q: state.now.q.with(i, x * p.unit) }));
    });
    const gravity = find("#gravity"), turn = (name, low, high) =>
      row(gravity, name, { label: name, low, high, step: 0.1, unit: "°" },
        (x) => state.set({ [name]: x / DEGREES }));
    this.tilt = turn("tilt", 0, Math.round(scene.rim * DEGREES));
    this.heading = turn("heading", -180, 180);
    const friction = { label: "friction μ", low: 0, high: 2, step: 0.01, unit: "" };
    this.mu = row(gravity, "mu", friction, (mu) => state.set({ mu }));
    this.modes = [...document.querySelectorAll("[name=mode]")];
    this.modes.forEach((one) => (one.onchange = () => state.set({ mode: one.value })));
    this.picks = [find("#axis-x"), find("#axis-y")];
    this.picks.forEach((pick, at) => {
      pick.append(...scene.parameters.map((p, value) => new Option(plain(p.name), value)));
      pick.onchange = () => state.set({ axes: state.now.axes.with(at, Number(pick.value)) });
    });
    this.what = find("#what");
    this.what.onchange = () => state.set({ what: this.what.value });
  }

  show({ q, tilt, heading, mu, mode, axes, what }) {
    this.joints.forEach((put, i) => put(q[i] / this.scene.parameters[i].unit));
    this.tilt(tilt * DEGREES);
    this.heading((heading * DEGREES % 360 + 540) % 360 - 180);
    this.mu(mu);
    this.modes.forEach((one) => (one.checked = one.value === mode));
    this.picks.forEach((pick, at) => (pick.value = axes[at] ?? ""));
    this.what.value = what;
  }

  // What the exported C answers, and one sentence for readers of screens.
  verdict(answer, mu) {
    const { slope, over, height, sdg, status } = answer, { unit } = this.scene;
    const slides = mu === null ? "" : Math.tan(slope) > mu ? " slides" : " holds";
    const words = {
      verdict: verdictOf(answer), status: STATUS[status], tip: tipText(answer),
      sdg: withUnit(sdg, unit), height: withUnit(height, unit), over: pairText(this.scene, over),
      slope: Number.isFinite(slope) ? degrees(slope, 1) + slides : "–",
    };
    const at = (name) => find(`[data-is="${name}"]`);
    Object.entries(words).forEach(([name, text]) => (at(name).textContent = text));
    at("verdict").dataset.verdict = at("status").dataset.verdict = classOf(answer);
    at("slope").dataset.verdict = slides === " slides" ? "rocks" : "";
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      at("spoken").textContent = `The robot ${words.verdict}, ${tipText(answer, 1)} from tipping ` +
        `over ${words.over}. The exported C answers ${words.status}.`;
    }, 600);
  }
}

// Arrows tilt gravity, letters press buttons.
function attachKeys(state, buttons) {
  Object.entries(buttons).forEach(([key, press]) =>
    find(`[data-key="${key}"]`)?.addEventListener("click", press));
  addEventListener("keydown", (event) => {
    const typing = /INPUT|SELECT|TEXTAREA/.test(event.target.tagName);
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
