// SPDX-License-Identifier: MIT
// What the flat pictures share: sharp canvases, fields of verdicts as pixels, the key of their colours.
import { level } from "./palette.js";

// Size a canvas to its box; returns the context in CSS pixels.
export function fit(canvas) {
  const ratio = Math.min(devicePixelRatio || 1, 2), { clientWidth: w, clientHeight: h } = canvas;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, w, h);
  context.font = "11px system-ui, sans-serif";
  return { context, w, h };
}

const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

// A field of statuses and values as a picture: levels where the robot stands, one colour where it
// rocks, hatching where it tips.  `part` turns a value into 0 to 1.
export function field(size, status, value, part, colours) {
  const picture = new OffscreenCanvas(size, size), context = picture.getContext("2d");
  const image = context.createImageData(size, size);
  const [tips, hatch, rocks] = [colours.tips, colours.hatch, colours.rocks].map(rgb);
  for (let i = 0; i < size * size; i++) {
    if (status[i] === -128) continue;
    const x = i % size, y = Math.floor(i / size), safe = status[i] === 0 || status[i] === 4;
    const colour = status[i] === 4 ? rocks : safe ? level(part(value[i])) : (x + y) % 6 === 0 ? hatch : tips;
    image.data.set([...colour, 255], 4 * i);
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
