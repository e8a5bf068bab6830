// SPDX-License-Identifier: MIT
// What leaves the page: a picture of everything that is drawn, and the history as a table.
import { STATUS } from "./engine.js";
import { VERDICT } from "./words.js";

function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// One picture: the 3-D view at the left, disc and map at the right, the history below, the verdict as text.
export function picture(canvases, lines, colours) {
  const [view, disc, map, trace] = canvases;
  const ratio = view.width / view.clientWidth, space = 12 * ratio, side = Math.max(disc.width, map.width);
  const right = disc.height + map.height, left = view.height + space + trace.height;
  const all = document.createElement("canvas");
  const head = (20 * lines.length + 14) * ratio;
  all.width = view.width + side + 3 * space;
  all.height = head + Math.max(left, right) + 2 * space;
  const context = all.getContext("2d");
  context.fillStyle = colours.page;
  context.fillRect(0, 0, all.width, all.height);
  context.fillStyle = colours.ink;
  context.font = `${14 * ratio}px system-ui, sans-serif`;
  lines.forEach((line, i) => context.fillText(line, space, (22 + 20 * i) * ratio));
  context.drawImage(view, space, head);
  context.drawImage(trace, space, head + view.height + space);
  context.drawImage(disc, view.width + 2 * space, head);
  context.drawImage(map, view.width + 2 * space, head + disc.height);
  return all;
}

export function savePicture(name, all) {
  all.toBlob((blob) => download(`${name}.png`, blob));
}

// The history: joints in the recipe's units, gravity in the body, exact and exported answers.
export function table(scene, rows) {
  const units = scene.parameters.map((p) => `${p.name} (${p.sign.trim().replace("°", "deg") || "1"})`);
  const head = ["time (s)", ...units, "mode", "gravity x", "gravity y", "gravity z", "verdict", `sdg (${scene.unit})`,
    "tip_angle (deg)", `height (${scene.unit})`, "exported status", "exported sdg", "exported tip_angle (deg)", "exported height"];
  const turn = 180 / Math.PI;
  const lines = rows.map(({ time, q, mode, g, exact, exported }) => [
    time.toFixed(3), ...q.map((x, i) => x / scene.parameters[i].unit), mode, ...g, VERDICT[exact.status], exact.sdg,
    exact.tip * turn, exact.height, STATUS[exported.status], exported.sdg, exported.tip * turn, exported.height,
  ]);
  const quoted = (cell) => (/[",\n]/.test(String(cell)) ? `"${String(cell).replaceAll('"', '""')}"` : String(cell));
  return [head, ...lines].map((line) => line.map(quoted).join(",")).join("\r\n") + "\r\n";
}

export function saveTable(name, text) {
  download(`${name}.csv`, new Blob([text], { type: "text/csv" }));
}
