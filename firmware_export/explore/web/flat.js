// SPDX-License-Identifier: MIT
// The flat pictures: the disc of directions, the map over two joints, the history of the tip angle.
const KEPT = 400;

class Flat {
  constructor(canvas, app) {
    Object.assign(this, { canvas, app, dirty: true });
  }

  // Size the canvas to its box; its context is in pixels of the page.
  fit() {
    const { canvas } = this, ratio = Math.min(devicePixelRatio || 1, 2);
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    Object.assign(canvas, { width: Math.round(w * ratio), height: Math.round(h * ratio) });
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = "11px system-ui, sans-serif";
    Object.assign(this, { context, w, h });
  }

  text(text, x, y, align = "center", baseline = "top", colour = this.app.colours.soft) {
    Object.assign(this.context, { fillStyle: colour, textAlign: align, textBaseline: baseline });
    this.context.fillText(text, x, y);
  }

  line(places, colour, width = 1) {
    this.context.beginPath();
    places.forEach(([x, y]) => this.context.lineTo(x, y));
    this.stroke(colour, width);
  }

  circle(x, y, radius, colour, width = 1) {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 7);
    this.stroke(colour, width);
  }

  stroke(strokeStyle, lineWidth) {
    Object.assign(this.context, { strokeStyle, lineWidth });
    this.context.stroke();
  }

  upwards(x, y, draw) {
    this.context.save();
    this.context.translate(x, y);
    this.context.rotate(-Math.PI / 2);
    draw();
    this.context.restore();
  }
}

// A picture of answers, computed row by row between frames: coarse first, then fine.
class Sheet extends Flat {
  constructor(canvas, app, sizes) {
    super(canvas, app);
    this.sizes = sizes;
    const drag = (event) => this.box && event.buttons && this.take(event.offsetX, event.offsetY);
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      drag(event);
    });
    canvas.addEventListener("pointermove", drag);
  }

  // A coarse picture is always finished, so that something is seen while all moves.
  work(until) {
    if (this.stale && (!this.job || this.fine)) {
      this.stale = false;
      this.job = this.rows({ ...this.app.state.now });
    }
    while (this.job && performance.now() < until) if (this.job.next().done) this.job = null;
  }

  *rows(now) {
    for (const size of this.sizes) {
      this.fine = size === this.sizes.at(-1);
      const places = [];
      for (let row = 0; row < size; row++) {
        places.push(...this.row(now, size, row));
        yield;
      }
      const channel = this.channel(now), ends = (x) => channel === "sdg" || x < 3.14159;
      const values = places.filter((one) => one && stands(one)).map((one) => one[channel]);
      const most = Math.max(0, ...values.filter(ends));
      this.data = { places, size, now, top: niceTop(most * this.factor(now)) };
      this.picture = null;
      this.dirty = true;
    }
  }

  channel() {
    return "tip";
  }

  factor(now) {
    return this.channel(now) === "tip" ? DEGREES : 1;
  }

  // Levels where the robot stands, one colour where it rocks, hatching where it tips.
  image() {
    const { places, size, now, top } = this.data, { colours } = this.app;
    const picture = Object.assign(document.createElement("canvas"), { width: size, height: size });
    const context = picture.getContext("2d"), image = context.createImageData(size, size);
    const bytes = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
    const [fallen, hatch, rocks] = ["fallen", "hatch", "gap"].map((name) => bytes(colours[name]));
    const channel = this.channel(now), factor = this.factor(now) * 10 / top;
    places.forEach((one, i) => {
      if (!one) return;
      const hatched = size > 100 && (i % size + Math.floor(i / size)) % 6 === 0;
      const level = LEVELS[clamp(Math.floor(one[channel] * factor), 0, 9)];
      const colour = one.status === 0 ? level : one.status === 4 ? rocks : hatched ? hatch : fallen;
      image.data.set([...colour, 255], 4 * i);
    });
    context.putImageData(image, 0, 0);
    return picture;
  }

  draw(x, y, side) {
    this.picture ??= this.image();
    this.context.drawImage(this.picture, x, y, side, side);
  }

  key(x, y, width, low, high, words) {
    LEVELS.forEach((level, k) => {
      this.context.fillStyle = `rgb(${level})`;
      this.context.fillRect(x + k * width / 10, y, width / 10 + 0.5, 8);
    });
    this.text(low, x, y + 11, "left");
    this.text(high, x + width, y + 11, "right");
    this.text(words, x + width / 2, y + 11);
  }

  // A mark that is seen on every colour.
  spot(x, y) {
    this.circle(x, y, 5, this.app.colours.page, 4);
    this.circle(x, y, 5, this.app.colours.ink, 2);
  }
}

class Disc extends Sheet {
  constructor(canvas, app) {
    super(canvas, app, [72, 180]);
    this.rim = app.scene.rim;
  }

  take(x, y) {
    const { cx, cy, r } = this.box, u = (x - cx) / r, v = (cy - y) / r;
    const far = Math.max(1, Math.hypot(u, v));
    this.app.state.set({ mode: "body", ...angles(fromDisc(u / far, v / far, this.rim)) });
  }

  row({ q }, size, row) {
    const found = Array(size).fill(null), columns = [], gravity = [];
    for (let column = 0; column < size; column++) {
      const x = (column + 0.5) / size * 2 - 1, y = 1 - (row + 0.5) / size * 2;
      if (x * x + y * y > 1) continue;
      columns.push(column);
      gravity.push(...fromDisc(x, y, this.rim));
    }
    this.app.runtime.at(q, gravity).forEach((one, i) => (found[columns[i]] = one));
    return found;
  }

  paint() {
    this.fit();
    const r = Math.max(20, Math.min(this.w / 2 - 16, this.h / 2 - 27));
    const cx = this.w / 2, cy = r + 16;
    const { data, rim } = this, { last, colours } = this.app;
    this.box = { cx, cy, r };
    if (data) {
      this.draw(cx - r, cy - r, 2 * r);
      this.key(cx - 0.62 * r, cy + r + 12, 1.24 * r, "0°", `${data.top}°`, "tip angle");
    }
    const step = rim > 1.6 ? 30 : 15;
    this.context.globalAlpha = 0.55;
    for (let ring = step; ring < rim * DEGREES - 1; ring += step) {
      this.circle(cx, cy, r * Math.sin(ring / DEGREES / 2) / Math.sin(rim / 2), colours.rim);
    }
    this.line([[cx - r, cy], [cx + r, cy]], colours.rim);
    this.line([[cx, cy - r], [cx, cy + r]], colours.rim);
    this.context.globalAlpha = 1;
    this.circle(cx, cy, r, colours.rim);
    this.text("nose down", cx, cy - r - 2, "center", "bottom");
    this.upwards(cx - r - 8, cy, () => this.text("left down", 0, 0, "center", "middle"));
    const word = `rim: ${Math.round(rim * DEGREES)}°`;
    this.text(word, cx + 0.74 * r, cy - 0.86 * r, "left", "middle");
    if (!last) return;
    const place = (g) => toDisc(g, rim).map((x, k) => (k ? cy - r * x : cx + r * x));
    last.pose.segments.forEach(({ start, stop, over }) => {
      const least = over.every((contact, k) => contact === last.over[k]);
      const parts = Math.max(2, Math.ceil(start.distanceTo(stop) * 24));
      const points = Array.from({ length: parts + 1 }, (_, k) => k / parts);
      const seen = points.map((part) => start.clone().lerp(stop, part))
        .filter((g) => Math.hypot(...toDisc(g, rim)) <= 1.001);
      this.line(seen.map(place), least ? colours.least : colours.ink, least ? 3 : 1.6);
    });
    const [x, y] = toDisc(last.g, rim), far = Math.max(1, Math.hypot(x, y));
    this.spot(cx + r * x / far, cy - r * y / far);
  }
}

class JointMap extends Sheet {
  constructor(canvas, app) {
    super(canvas, app, [21, 61]);
  }

  channel({ what }) {
    return what;
  }

  at(q, [a, b], x, y) {
    const { parameters } = this.app.scene, here = [...q];
    const between = ({ min, max }, part) => min + clamp(part, 0, 1) * (max - min);
    here[a] = between(parameters[a], x);
    if (a !== b) here[b] = between(parameters[b], y);
    return here;
  }

  take(x, y) {
    const { left, top, side } = this.box, { q, axes } = this.app.state.now;
    this.app.state.set({ q: this.at(q, axes, (x - left) / side, 1 - (y - top) / side) });
  }

  // On the ground the robot is seated anew at each place.
  row({ q, axes, mode, tilt, heading }, size, row) {
    const { runtime } = this.app, given = tilted(tilt, heading);
    return Array.from({ length: axes.length && size }, (_, column) => {
      const here = this.at(q, axes, column / (size - 1), 1 - row / (size - 1));
      const g = mode === "ground" ? seated(runtime.pose(here), given) : given;
      return runtime.at(here, [...g])[0];
    });
  }

  paint() {
    this.fit();
    const { scene, state, colours } = this.app, { axes, q } = state.now, { data } = this;
    if (!axes.length) return;
    const side = Math.max(40, Math.min(this.w - 52, this.h - 64));
    const left = (this.w - side) / 2 + 14, top = 8, below = top + side + 3;
    this.box = { left, top, side };
    if (data && data.now.axes.join() === axes.join()) {
      this.context.imageSmoothingEnabled = false;
      this.draw(left, top, side);
      const tip = data.now.what === "tip", words = tip ? "tip angle" : "|SD_g|";
      const high = tip ? `${data.top}°` : withUnit(data.top, scene.unit);
      this.key(left + 0.15 * side, below + 29, 0.7 * side, "0", high, words);
    }
    Object.assign(this.context, { strokeStyle: colours.rim, lineWidth: 1 });
    this.context.strokeRect(left, top, side, side);
    const [a, b] = axes.map((i) => scene.parameters[i]);
    const end = (p, x) => `${digits(x / p.unit, 3).replace("-", "−")}${p.sign}`;
    const scale = (p, x, y) => {
      this.text(end(p, p.min), x, y, "left");
      this.text(plain(p.name), x + side / 2, y);
      this.text(end(p, p.max), x + side, y, "right");
    };
    scale(a, left, below);
    if (a !== b) this.upwards(left - 13, top + side, () => scale(b, 0, 0));
    const part = (p, i) => (q[i] - p.min) / (p.max - p.min), [i, j] = axes;
    this.spot(left + side * part(a, i), top + side * (a === b ? 0.5 : 1 - part(b, j)));
  }
}

// The tip angle of the last states, which a table can be made of.
class Trace extends Flat {
  constructor(canvas, app) {
    super(canvas, app);
    this.rows = [];
  }

  add(answer) {
    this.rows = [...this.rows.slice(1 - KEPT), { time: performance.now() / 1000, ...answer }];
    this.dirty = true;
  }

  paint() {
    this.fit();
    const { w, h, rows } = this, { colours } = this.app, left = 34, right = w - 6;
    const values = rows.map(({ tip }) => clamp(tip * DEGREES, -60, 90));
    const top = niceTop(Math.max(10, ...values)), low = Math.min(0, ...values) * 1.1;
    const y = (x) => 6 + (h - 22) * (top - x) / (top - low);
    const x = (i) => right - (rows.length - 1 - i) * (right - left) / KEPT;
    this.context.fillStyle = colours.fallen;
    this.context.fillRect(left, y(0), right - left, Math.max(0, h - 16 - y(0)));
    this.line([[left, y(0)], [right, y(0)]], colours.rim);
    this.text(`${top}°`, left - 4, y(top) + 3, "right", "middle");
    this.text("0°", left - 4, y(0), "right", "middle");
    this.line(values.map((value, i) => [x(i), y(value)]), colours.ink, 2);
    this.text("tip angle", left, h - 3, "left", "alphabetic", colours.ink);
  }

  // Joints in the recipe's units, gravity in the body, and what the C answered.
  csv() {
    const { name, parameters, unit } = this.app.scene;
    const units = parameters.map((p) => `${p.name} (${p.sign.trim().replace("°", "deg") || "1"})`);
    const answers = ["status", `sdg (${unit})`, "tip_angle (deg)", `height (${unit})`];
    const head = ["time (s)", ...units, "mode", "gravity x", "gravity y", "gravity z", ...answers];
    const lines = this.rows.map(({ time, q, mode, g, status, sdg, tip, height }) => [
      time.toFixed(3), ...q.map((x, i) => x / parameters[i].unit), mode, ...g,
      STATUS[status], sdg, tip * DEGREES, height,
    ]);
    const quoted = (cell) =>
      (/[",\n]/.test(cell) ? `"${String(cell).replaceAll('"', '""')}"` : cell);
    return [head, ...lines].map((line) => line.map(quoted).join(",") + "\r\n").join("");
  }
}
