// SPDX-License-Identifier: MIT
// Puts the page together: a state is answered by the C, and every part shows the answer.
class Page {
  constructor(held, runtime) {
    Object.assign(this, { scene: held.scene, runtime, last: null, first: 0 });
    this.state = new State(held.scene, (change) => this.changed(change));
    this.stage = new Stage(find("#view"), held.scene);
    this.stage.attach(this.state);
    this.disc = new Disc(find("#disc"), this);
    this.map = new JointMap(find("#map"), this);
    this.trace = new Trace(find("#trace"), this);
    this.flats = [this.disc, this.map, this.trace];
    this.controls = new Controls(this);
    attachKeys(this.state, {
      d: () => this.state.set({ theme: isDark(this.state.now.theme) ? "light" : "dark" }),
      g: () => this.state.set({ mode: this.state.now.mode === "ground" ? "body" : "ground" }),
      l: () => this.state.set({ tilt: 0, heading: 0 }),
      r: () => {
        this.state.set({ ...this.state.initial(), theme: this.state.now.theme });
        this.stage.home();
      },
      p: () => this.shot().toBlob((blob) => this.save("png", blob)),
      c: () => this.save("csv", new Blob([this.trace.csv()], { type: "text/csv" })),
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.recolour());
    new ResizeObserver(() => {
      this.stage.resize();
      this.flats.forEach((one) => (one.dirty = true));
    }).observe(find("main"));
    this.recolour();
    this.changed(this.state.now);
    this.frame();
  }

  changed(change) {
    this.controls.show(this.state.now);
    if ("theme" in change) this.recolour();
    if ("mu" in change && this.last) this.controls.verdict(this.last, change.mu);
    if (["q", "mode", "tilt", "heading"].some((key) => key in change)) {
      this.moved = this.disc.stale = this.map.stale = true;
    }
    if ("axes" in change || "what" in change) this.map.stale = true;
    this.map.dirty = true;
  }

  // All that is known of a state; `down` instead of tilt and heading in programs.
  answer({ q, mode, tilt, heading, down }) {
    const pose = this.runtime.pose(q), given = down ? vector(down) : tilted(tilt, heading);
    const g = mode === "ground" ? seated(pose, given) : given, here = pierced(pose, g);
    const cosine = here ? here.plane.clone().normalize().dot(g) : NaN;
    const slope = Math.acos(Math.min(1, cosine));
    return { ...this.runtime.at(q, [...g])[0], q, mode, g, pose, here, slope };
  }

  // Answer and draw; what is left of the frame is for disc and map, most where nothing moves.
  frame() {
    const until = performance.now() + (this.moved ? 6 : 14);
    if (this.moved) {
      this.moved = false;
      this.last = this.answer(this.state.now);
      this.stage.show(this.last);
      this.controls.verdict(this.last, this.state.now.mu);
      this.trace.add(this.last);
      this.disc.dirty = true;
    }
    if (this.stage.dirty) this.stage.render();
    if (this.first) [this.disc, this.map].forEach((one) => one.work(until));
    this.first ||= performance.now();
    this.flats.filter((one) => one.dirty).forEach((one) => {
      one.dirty = false;
      one.paint();
    });
    requestAnimationFrame(() => this.frame());
  }

  recolour() {
    this.colours = palette(this.state.now.theme);
    this.stage.recolour(this.colours);
    this.flats.forEach((one) => Object.assign(one, { picture: null, dirty: true }));
  }

  // One picture: the robot at the left, disc and map at the right, the history below.
  shot() {
    this.stage.render(); // what is drawn can be read until the next frame alone
    const [view, disc, map, trace] = ["#view", "#disc", "#map", "#trace"].map(find);
    const ratio = view.width / view.clientWidth, gap = 12 * ratio, head = 34 * ratio;
    const all = document.createElement("canvas"), context = all.getContext("2d");
    all.width = view.width + Math.max(disc.width, map.width) + 3 * gap;
    const height = Math.max(view.height + gap + trace.height, disc.height + map.height);
    all.height = head + height + 2 * gap;
    context.fillStyle = this.colours.page;
    context.fillRect(0, 0, all.width, all.height);
    context.fillStyle = this.colours.ink;
    context.font = `${14 * ratio}px system-ui, sans-serif`;
    const words = `${verdictOf(this.last)}, tip angle ${tipText(this.last)}`;
    context.fillText(`${this.scene.name}: ${words}`, gap, 22 * ratio);
    context.drawImage(view, gap, head);
    context.drawImage(trace, gap, head + view.height + gap);
    context.drawImage(disc, view.width + 2 * gap, head);
    context.drawImage(map, view.width + 2 * gap, head + disc.height);
    return all;
  }

  save(suffix, blob) {
    const href = URL.createObjectURL(blob);
    element("a", { href, download: `${this.scene.name}.${suffix}` }).click();
    setTimeout(() => URL.revokeObjectURL(href), 60_000);
  }
}

try {
  const held = JSON.parse(find("#data").textContent);
  globalThis.explorer = new Page(held, await Runtime.start(held));
} catch (error) {
  find("#failed").hidden = false;
  find("#failed").textContent = `This browser could not start the page: ${error}`;
}
