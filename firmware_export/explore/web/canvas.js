// SPDX-License-Identifier: MIT
// What the flat pictures share: sharp canvases, fields of verdicts as pixels, the key of their colours.
import { level } from "./palette.js";

// Asking a box for its size makes a browser lay out the page, so it is asked when that has changed.
const boxes = new Map();
export const measureAgain = () => boxes.clear();

// Size a canvas to its box; returns the context in CSS pixels.
export function fit(canvas) {
  if (!boxes.has(canvas)) boxes.set(canvas, [canvas.clientWidth, canvas.clientHeight]);
  const ratio = Math.min(devicePixelRatio || 1, 2), [w, h] = boxes.get(canvas);
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
  }
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, w, h);
  context.font = "11px system-ui, sans-serif";
  return { context, w, h };
}

// A colour as the four bytes of a pixel.
const pixel = ([r, g, b]) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
const hex = (text) => pixel([1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)));
const LEVELS = Array.from({ length: 10 }, (_, k) => pixel(level((k + 0.5) / 10)));

// A field of statuses and values as a picture: levels where the robot stands, one colour where it
// rocks, hatching where it tips.  `top` is the value of the highest level.
export function field(size, status, value, top, colours) {
  const picture = document.createElement("canvas");
  picture.width = picture.height = size;
  const context = picture.getContext("2d", { willReadFrequently: true });
  const image = context.createImageData(size, size), out = new Uint32Array(image.data.buffer);
  const fine = size > 100; // hatching of few pixels looks like noise
  const tips = hex(colours.tips), hatch = hex(colours.hatch), rocks = hex(colours.rocks);
  for (let y = 0, i = 0; y < size; y++) {
    for (let x = 0; x < size; x++, i++) {
      const here = status[i];
      if (here === -128) continue;
      if (here === 0) out[i] = LEVELS[Math.max(0, Math.min(9, Math.floor((10 * value[i]) / top)))];
      else out[i] = here === 4 ? rocks : fine && (x + y) % 6 === 0 ? hatch : tips;
    }
  }
  context.putImageData(image, 0, 0);
  return picture;
}

// A bar of levels with its ends in words.
export function key(context, x, y, width, low, high, colours, more) {
  for (let k = 0; k < 10; k++) {
    context.fillStyle = `rgb(${level((k + 0.5) / 10)})`;
    context.fillRect(x + (k * width) / 10, y, width / 10 + 0.5, 8);
  }
  context.fillStyle = colours.soft;
  context.textBaseline = "top";
  context.textAlign = "left";
  context.fillText(low, x, y + 11);
  context.textAlign = "right";
  context.fillText(high, x + width, y + 11);
  context.textAlign = "center";
  context.fillText(more, x + width / 2, y + 11);
}

// A mark that is seen on every colour.
export function spot(context, x, y, colours, radius = 5) {
  context.beginPath();
  context.arc(x, y, radius, 0, 7);
  context.lineWidth = 4;
  context.strokeStyle = colours.page;
  context.stroke();
  context.lineWidth = 2;
  context.strokeStyle = colours.ink;
  context.stroke();
}

// Pointer events as parts of a picture's box; also the first press.
export function onDrag(canvas, move) {
  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    move(event.clientX - box.left, event.clientY - box.top);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    at(event);
  });
  canvas.addEventListener("pointermove", (event) => event.buttons && at(event));
}
