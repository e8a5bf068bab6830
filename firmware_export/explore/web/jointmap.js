// SPDX-License-Identifier: MIT
// The map over two chosen joints at the present gravity, as the exported C answers it.
import { field, fit, key, onDrag, spot } from "./canvas.js";
import { niceTop } from "./palette.js";
import { Sheet } from "./sheet.js";
import { DEGREES, digits, plain } from "./words.js";

export class JointMap extends Sheet {
  constructor(canvas, scene, state) {
    super(canvas, scene, state);
    onDrag(canvas, (x, y) => {
      if (!this.box) return;
      const { left, top, side } = this.box, [a, b] = state.now.axes, q = [...state.now.q];
      const part = (t) => Math.min(1, Math.max(0, t));
      const at = (p, t) => p.min + part(t) * (p.max - p.min);
      q[a] = at(scene.parameters[a], (x - left) / side);
      if (a !== b) q[b] = at(scene.parameters[b], 1 - (y - top) / side);
      state.set({ q });
    });
  }

  paint() {
    const { colours, scene } = this, { axes, q } = this.state.now;
    if (!colours) return;
    const { context, w, h } = fit(this.canvas);
    if (!axes.length) return;
    const side = Math.max(40, Math.min(w - 52, h - 64)), left = (w - side) / 2 + 14, top = 8;
    this.box = { left, top, side };
    const fresh = this.data && this.data.axes.join() === axes.join();
    if (fresh) {
      const { status, value, size, what } = this.data, tip = what === "tip";
      if (!this.picture) {
        this.top = niceTop(this.data.most * (tip ? DEGREES : 1));
        this.picture = field(size, status, value, tip ? this.top / DEGREES : this.top, colours);
      }
      context.imageSmoothingEnabled = false;
      context.drawImage(this.picture, left, top, side, side);
      const unit = tip ? "°" : scene.unit === "1" ? "" : ` ${scene.unit}`;
      key(context, left + 0.15 * side, top + side + 32, 0.7 * side, "0", `${digits(this.top, 3)}${unit}`, colours, tip ? "tip angle" : "|SD_g|");
    }
    context.strokeStyle = colours.rim;
    context.lineWidth = 1;
    context.strokeRect(left, top, side, side);
    this.scales(context, left, top, side);
    const [a, b] = axes.map((i) => scene.parameters[i]);
    const part = (p, x) => (x - p.min) / (p.max - p.min);
    const x = left + side * part(a, q[axes[0]]);
    const y = axes[0] === axes[1] ? top + side / 2 : top + side * (1 - part(b, q[axes[1]]));
    spot(context, x, y, colours);
  }

  scales(context, left, top, side) {
    const { axes } = this.state.now, [a, b] = axes.map((i) => this.scene.parameters[i]);
    const end = (p, x) => `${digits(x / p.unit, 3).replace("-", "−")}${p.sign}`;
    context.fillStyle = this.colours.soft;
    context.textBaseline = "top";
    context.textAlign = "left";
    context.fillText(end(a, a.min), left, top + side + 3);
    context.textAlign = "right";
    context.fillText(end(a, a.max), left + side, top + side + 3);
    context.textAlign = "center";
    context.fillText(plain(a.name), left + side / 2, top + side + 3);
    if (axes[0] === axes[1]) return;
    context.save();
    context.translate(left - 13, top + side);
    context.rotate(-Math.PI / 2);
    context.textAlign = "left";
    context.fillText(end(b, b.min), 0, 0);
    context.textAlign = "center";
    context.fillText(plain(b.name), side / 2, 0);
    context.textAlign = "right";
    context.fillText(end(b, b.max), side, 0);
    context.restore();
  }
}
