// SPDX-License-Identifier: MIT
// The disc of gravity directions in the body: exported verdict and tip angle, exact boundary, gravity.
import { field, fit, key, onDrag, spot } from "./canvas.js";
import { angles, fromDisc, toDisc } from "./gravity.js";
import { niceTop } from "./palette.js";
import { Sheet } from "./sheet.js";
import { add, length, scale, unit } from "./vector.js";
import { DEGREES } from "./words.js";

export class Disc extends Sheet {
  constructor(canvas, scene, state) {
    super(canvas, scene, state);
    this.rim = scene.rim;
    onDrag(canvas, (x, y) => {
      if (!this.box) return;
      const { cx, cy, r } = this.box, u = (x - cx) / r, v = (cy - y) / r, far = Math.max(1, Math.hypot(u, v));
      state.set({ mode: "body", ...angles(fromDisc(u / far, v / far, this.rim)) });
    });
  }

  show(answer) {
    this.answer = answer;
    this.dirty = true;
  }

  paint() {
    const { colours } = this;
    if (!colours) return;
    const { context, w, h } = fit(this.canvas);
    const r = Math.max(20, Math.min(w / 2 - 16, h / 2 - 27)), cx = w / 2, cy = r + 16;
    this.box = { cx, cy, r };
    if (this.data) {
      const { status, tip, size } = this.data;
      if (!this.picture) {
        this.top = niceTop(this.data.most * DEGREES);
        this.picture = field(size, status, tip, this.top / DEGREES, colours);
      }
      context.drawImage(this.picture, cx - r, cy - r, 2 * r, 2 * r);
    }
    this.graticule(context, cx, cy, r);
    if (this.answer) {
      this.boundary(context, cx, cy, r);
      const [x, y] = toDisc(this.answer.g, this.rim), far = Math.max(1, Math.hypot(x, y));
      spot(context, cx + (r * x) / far, cy - (r * y) / far, colours);
    }
    if (this.top) key(context, cx - 0.62 * r, cy + r + 12, 1.24 * r, "0°", `${this.top}°`, colours, "tip angle");
  }

  graticule(context, cx, cy, r) {
    const { colours, rim } = this;
    context.lineWidth = 1;
    context.strokeStyle = colours.rim;
    context.globalAlpha = 0.55;
    const step = rim > 1.6 ? 30 : 15;
    for (let ring = step; ring < rim * DEGREES - 1; ring += step) {
      const at = (r * Math.sin(ring / DEGREES / 2)) / Math.sin(rim / 2);
      context.beginPath();
      context.arc(cx, cy, at, 0, 7);
      context.stroke();
    }
    context.beginPath();
    context.moveTo(cx - r, cy);
    context.lineTo(cx + r, cy);
    context.moveTo(cx, cy - r);
    context.lineTo(cx, cy + r);
    context.stroke();
    context.globalAlpha = 1;
    context.beginPath();
    context.arc(cx, cy, r, 0, 7);
    context.stroke();
    context.fillStyle = colours.soft;
    context.textAlign = "center";
    context.textBaseline = "bottom";
    context.fillText("nose down", cx, cy - r - 2);
    context.textBaseline = "middle";
    context.save();
    context.translate(cx - r - 8, cy);
    context.rotate(-Math.PI / 2);
    context.fillText("left down", 0, 0);
    context.restore();
    context.textAlign = "left";
    context.fillText(`rim: ${Math.round(rim * DEGREES)}°`, cx + 0.74 * r, cy - 0.86 * r);
  }

  boundary(context, cx, cy, r) {
    const { over } = this.answer.exact;
    for (const segment of this.answer.segments) {
      const least = segment.over[0] === over[0] && segment.over[1] === over[1];
      context.beginPath();
      const parts = Math.max(2, Math.ceil(length(add(segment.start, scale(segment.stop, -1))) * 24));
      for (let k = 0; k <= parts; k++) {
        const g = unit(add(scale(segment.start, 1 - k / parts), scale(segment.stop, k / parts)));
        const [x, y] = toDisc(g, this.rim);
        const inside = Math.hypot(x, y) <= 1.001;
        if (inside) context.lineTo(cx + r * x, cy - r * y);
        else context.moveTo(cx + r * x, cy - r * y);
      }
      context.strokeStyle = least ? this.colours.least : this.colours.ink;
      context.lineWidth = least ? 3 : 1.6;
      context.stroke();
    }
  }
}
