// SPDX-License-Identifier: MIT
// The flat pictures: the disc of directions, and the map over two joints.
const UPWARDS = -Math.PI / 2;
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

// The most that there is, rounded up to one digit: the top of ten levels.
function niceTop(most) {
  const power = 10 ** Math.floor(Math.log10(most || 1));
  return Math.ceil(most / power - 0.001) * power || 1;
}

// A picture of answers, computed row by row between frames: coarse first, then fine.
class Sheet {
  // `room`: what is beside and below the picture, how far it is to the right and from the top.
  constructor(canvas, app, sizes, room) {
    Object.assign(this, { canvas, app, sizes, room });
    canvas.onpointerdown = (event) => {
      canvas.setPointerCapture(event.pointerId);
      canvas.onpointermove(event);
    };
    canvas.onpointermove = ({ buttons, offsetX, offsetY }) => {
      const { left, top, side } = this.box;
      if (buttons) app.state.set(this.taken((offsetX - left) / side, (offsetY - top) / side));
    };
  }

  // A coarse picture is always finished, so that something is seen while all moves.
  work(until) {
    if (this.stale && (!this.job || this.fine)) {
      this.stale = false;
      this.job = this.rows(this.app.query());
    }
    while (this.job && performance.now() < until) if (this.job.next().done) this.job = null;
  }

  *rows(query) {
    const tip = this.shows(query) === "tip";
    for (const size of this.sizes) {
      this.fine = size === this.sizes.at(-1);
      const places = [];
      for (let row = 0; row < size; row++) {
        places.push(...this.row(query, size, row));
        yield;
      }
      const value = (one) => (tip ? one.tip * DEGREES : one.sdg);
      const values = places.filter((one) => one && stands(one)).map(value);
      const top = niceTop(Math.max(0, ...values.filter((x) => !tip || x < 179.99)));
      this.data = { places, size, tip, top, value };
      this.picture = null;
      this.dirty = true;
    }
  }

  // Levels where the robot stands, one colour where it rocks, hatching where it tips.
  image() {
    const { places, size, top, value } = this.data, { colours } = this.app;
    const picture = Object.assign(document.createElement("canvas"), { width: size, height: size });
    const context = picture.getContext("2d", { willReadFrequently: true });
    places.forEach((one, i) => {
      if (!one) return;
      const x = i % size, y = Math.floor(i / size), hatched = size > 100 && (x + y) % 6 === 0;
      const level = LEVELS[clamp(Math.floor(value(one) * 10 / top), 0, 9)];
      const fallen = hatched ? colours.hatch : colours.fallen;
      context.fillStyle = { 0: level, 1: colours.gap }[one.status] ?? fallen;
      context.fillRect(x, y, 1, 1);
    });
    return picture;
  }

  // Size the canvas to its box, in pixels of the page; draw the picture and the key of its levels.
  paint() {
    this.dirty = false;
    const { canvas, app, data, room } = this, ratio = Math.min(devicePixelRatio, 2);
    const { clientWidth: w, clientHeight: h } = canvas;
    Object.assign(canvas, { width: Math.round(w * ratio), height: Math.round(h * ratio) });
    const context = this.context = canvas.getContext("2d", { willReadFrequently: true });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = "11px system-ui, sans-serif";
    const side = Math.max(40, Math.min(w - room.beside, h - room.below));
    const left = (w - side) / 2 + room.right, { top } = room;
    this.box = { left, top, side };
    if (data) {
      this.picture ??= this.image();
      context.imageSmoothingEnabled = data.size > 100;
      context.drawImage(this.picture, left, top, side, side);
      const width = 0.062 * side, x = left + 0.19 * side, y = h - 24;
      LEVELS.forEach((level, k) => {
        context.fillStyle = level;
        context.fillRect(x + k * width, y, width + 0.5, 8);
      });
      const high = digits(data.top, 4, data.tip ? "°" : app.scene.unit);
      this.text("0", x, y + 11, "left");
      this.text(high, x + 10 * width, y + 11, "right");
      this.text(data.tip ? "tip angle" : "|SD_g|", x + 5 * width, y + 11);
    }
    this.outline(this.box);
  }

  text(text, x, y, textAlign = "center", textBaseline = "top", turn = 0) {
    this.context.save();
    Object.assign(this.context, { fillStyle: this.app.colours.soft, textAlign, textBaseline });
    this.context.translate(x, y);
    this.context.rotate(turn);
    this.context.fillText(text, 0, 0);
    this.context.restore();
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

  stroke(colour, lineWidth) {
    Object.assign(this.context, { strokeStyle: this.app.colours[colour], lineWidth });
    this.context.stroke();
  }

  // A mark that is seen on every colour.
  spot(x, y) {
    this.circle(x, y, 5, "page", 4);
    this.circle(x, y, 5, "ink", 2);
  }
}

class Disc extends Sheet {
  constructor(canvas, app) {
    super(canvas, app, [72, 180], { beside: 32, below: 56, right: 0, top: 16 });
    Object.assign(this, { rim: app.scene.rim, shows: () => "tip" });
  }

  taken(x, y) {
    const u = 2 * x - 1, v = 1 - 2 * y, far = Math.max(1, Math.hypot(u, v));
    return { mode: "body", ...angles(fromDisc(u / far, v / far, this.rim)) };
  }

  row({ q }, size, row) {
    const y = 1 - (2 * row + 1) / size;
    const columns = Array.from({ length: size }, (_, column) => (2 * column + 1) / size - 1);
    const gravity = columns.flatMap((x) => [...fromDisc(x, y, this.rim)]);
    const found = this.app.runtime.at(q, gravity);
    return found.map((one, column) => (Math.hypot(columns[column], y) > 1 ? null : one));
  }

  outline({ left, top, side }) {
    const r = side / 2, cx = left + r, cy = top + r, { rim, app: { last } } = this;
    const step = rim > 1.6 ? 30 : 15;
    this.context.globalAlpha = 0.55;
    for (let ring = step; ring < rim * DEGREES - 1; ring += step) {
      this.circle(cx, cy, r * Math.sin(ring / DEGREES / 2) / Math.sin(rim / 2), "rim");
    }
    this.line([[cx - r, cy], [cx + r, cy]], "rim");
    this.line([[cx, cy - r], [cx, cy + r]], "rim");
    this.context.globalAlpha = 1;
    this.circle(cx, cy, r, "rim");
    this.text("nose down", cx, top - 2, "center", "bottom");
    this.text("left down", left - 8, cy, "center", "middle", UPWARDS);
    this.text(`rim: ${Math.round(rim * DEGREES)}°`, left + side, top + 0.04 * side);
    const place = ([x, y]) => [cx + r * x, cy - r * y];
    last.pose.segments.forEach(({ start, stop, over }) => {
      const least = over.every((contact, k) => contact === last.over[k]);
      const parts = Math.max(2, Math.ceil(start.distanceTo(stop) * 24));
      const arc = Array.from({ length: parts + 1 }, (_, k) =>
        toDisc(start.clone().lerp(stop, k / parts).normalize(), rim));
      const seen = arc.filter((at) => Math.hypot(...at) <= 1.001);
      this.line(seen.map(place), ...(least ? ["least", 3] : ["ink", 1.6]));
    });
    const at = toDisc(last.g, rim), far = Math.max(1, Math.hypot(...at));
    this.spot(...place(at.map((x) => x / far)));
  }
}

class JointMap extends Sheet {
  constructor(canvas, app) {
    super(canvas, app, [21, 61], { beside: 52, below: 64, right: 14, top: 8 });
    this.shows = ({ what }) => what;
  }

  // The value of a joint at a part of its range.
  at(index, part) {
    const { min, max } = this.app.scene.parameters[index];
    return min + clamp(part, 0, 1) * (max - min);
  }

  taken(x, y) {
    const [a, b] = this.app.query().axes, { parameters } = this.app.scene;
    const change = (index, part) =>
      ({ [`p.${parameters[index].name}`]: Number(this.at(index, part).toPrecision(6)) });
    return { ...change(b, 1 - y), ...change(a, x) };
  }

  // On the ground the robot is seated anew at each place.
  row({ q, axes: [a, b], mode, down }, size, row) {
    const { runtime, scene: { parameters } } = this.app;
    return Array.from({ length: size }, (_, column) => {
      const here = [...q];
      here[b] = this.at(b, 1 - row / (size - 1)) * parameters[b].unit;
      here[a] = this.at(a, column / (size - 1)) * parameters[a].unit;
      const g = mode === "ground" ? seated(runtime.pose(here), down) : down;
      return runtime.at(here, [...g])[0];
    });
  }

  outline({ left, top, side }) {
    const { parameters } = this.app.scene, { q, axes: [i, j] } = this.app.query();
    const [a, b] = [parameters[i], parameters[j]], below = top + side + 3;
    this.context.strokeStyle = this.app.colours.rim;
    this.context.strokeRect(left, top, side, side);
    const scale = (p, x, y, turn, right, down) => {
      this.text(digits(p.min, 3, p.sign), x, y, "left", "top", turn);
      this.text(plain(p.name), x + right / 2, y + down / 2, "center", "top", turn);
      this.text(digits(p.max, 3, p.sign), x + right, y + down, "right", "top", turn);
    };
    scale(a, left, below, 0, side, 0);
    if (a !== b) scale(b, left - 13, top + side, UPWARDS, 0, -side);
    const part = (p, x) => (x / p.unit - p.min) / (p.max - p.min);
    this.spot(left + side * part(a, q[i]), top + side * (a === b ? 0.5 : 1 - part(b, q[j])));
  }
}
