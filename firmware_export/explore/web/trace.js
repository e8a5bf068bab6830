// SPDX-License-Identifier: MIT
// The scrolling history of the tip angle, exact and exported, and its rows for a CSV file.
import { fit } from "./canvas.js";
import { niceTop } from "./palette.js";
import { DEGREES } from "./words.js";

const KEPT = 400;

export class Trace {
  constructor(canvas) {
    this.canvas = canvas;
    this.rows = [];
  }

  add(answer, now) {
    const { g, exact, exported } = answer;
    this.rows.push({ time: performance.now() / 1000, q: [...now.q], mode: now.mode, g, exact, exported });
    if (this.rows.length > KEPT) this.rows.shift();
    this.dirty = true;
  }

  recolour(colours) {
    this.colours = colours;
    this.dirty = true;
  }

  paint() {
    if (!this.colours) return;
    const { colours, rows } = this, { context, w, h } = fit(this.canvas);
    const clipped = (x) => Math.max(-60, Math.min(90, x * DEGREES));
    const values = rows.flatMap((row) => [clipped(row.exact.tip), clipped(row.exported.tip)]);
    const top = niceTop(Math.max(10, ...values)), low = Math.min(0, ...values) * 1.1;
    const left = 34, y = (x) => 6 + ((h - 22) * (top - x)) / (top - low), step = (w - left - 6) / KEPT;
    const x = (i) => w - 6 - (rows.length - 1 - i) * step;
    context.fillStyle = colours.tips;
    context.fillRect(left, y(0), w - left - 6, Math.max(0, h - 16 - y(0)));
    context.strokeStyle = colours.rim;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(left, y(0));
    context.lineTo(w - 6, y(0));
    context.stroke();
    context.fillStyle = colours.soft;
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.fillText(`${top}°`, left - 4, y(top) + 3);
    context.fillText("0°", left - 4, y(0));
    const line = (part, colour, width, dash) => {
      context.setLineDash(dash);
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.beginPath();
      rows.forEach((row, i) => context.lineTo(x(i), y(clipped(row[part].tip))));
      context.stroke();
      context.setLineDash([]);
    };
    line("exact", colours.ink, 2.2, []);
    line("exported", colours.least, 1.2, [4, 3]);
    context.textAlign = "left";
    context.textBaseline = "alphabetic";
    context.fillStyle = colours.ink;
    context.fillText("tip angle, exact", left, h - 3);
    context.fillStyle = colours.least;
    context.fillText("– – exported C", left + 96, h - 3);
  }
}
