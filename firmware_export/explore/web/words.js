// SPDX-License-Identifier: MIT
// Words and colours: one for one meaning, light and dark, as in lutgen/plot/style.py.
const DEGREES = 180 / Math.PI;
const STATUS = {
  0: ["SMAP_OK", "stands", "stands"], 1: ["SMAP_ROCKS", "rocks", "rocks"],
  2: ["SMAP_TIPS", "tips over", "tips"],
  3: ["SMAP_OFF_CHART"], 4: ["SMAP_OFF_RANGE"], 5: ["SMAP_CORRUPT"], 6: ["SMAP_INVALID"],
};
const CLOSE = 5 / DEGREES; // nearer to tipping than this nothing is green
const DARK = "(prefers-color-scheme: dark)";
const COLOURS = {
  page: ["#ffffff", "#14181d"], ink: ["#1b1f24", "#e6eaee"], soft: ["#59636e", "#9aa5b1"],
  line: ["#d5dae0", "#313941"], panel: ["#f6f7f9", "#1b2026"], rim: ["#8b949e", "#7d8792"],
  stands: ["#00724f", "#2bc399"], close: ["#7d5a00", "#e8b84a"], rocks: ["#a2457d", "#e59bc3"],
  tips: ["#b3400a", "#ff8a3d"],
  ground: ["#d8d3c8", "#2b2f33"], body: ["#aab4bf", "#6d7985"], link: ["#8d98a5", "#7e8a96"],
  wheel: ["#5b6670", "#98a3ae"], foot: ["#3a4149", "#c3ccd5"],
  support: ["#009e73", "#2bc399"], gap: ["#cc79a7", "#e59bc3"], centre: ["#0072b2", "#58b2ee"],
  least: ["#d55e00", "#ff8a3d"], fallen: ["#e4e6e9", "#23292f"], hatch: ["#a9b0b8", "#56606a"],
};
// Viridis in ten levels, so that they can be told; also for colour-blind readers.
const LEVELS = [
  "#451263", "#45337d", "#3b518b", "#2f6b8d", "#25848d",
  "#239c88", "#32b27b", "#5cc863", "#9ad83c", "#dce32a",
];

const stands = ({ status }) => status <= 1;
const plain = (name) => name.replaceAll("_", " ");

// A number with so many digits that count; a dash where there is none.
const digits = (x, count, unit = "") =>
  Number.isFinite(x) ? `${+(+x.toFixed(12)).toPrecision(count)}${unit}`.replace("-", "−") : "–";

// How a tip angle reads where there is no boundary, or nothing to stand on.
function tipText({ status, tip }, places = 2) {
  if (!(STATUS[status]?.[1] && Number.isFinite(tip))) return "–";
  if (Math.abs(tip) > 3.14159) return tip > 0 ? "never tips" : "no support";
  return `${(tip * DEGREES).toFixed(places).replace("-", "−")}°`;
}

// The two contacts of an axis in words.
function pairText({ contacts }, over) {
  const names = [...new Set(over)].map((i) => contacts[i]).filter(Boolean);
  return names.map((contact) => plain(contact.name)).join(" – ") || "none";
}

// Every colour by its name; the style sheet gets them too.
function palette(theme) {
  const { style } = document.documentElement;
  style.colorScheme = theme || (matchMedia(DARK).matches ? "dark" : "light");
  const which = style.colorScheme === "dark" ? 1 : 0;
  return Object.fromEntries(Object.entries(COLOURS).map(([name, both]) => {
    style.setProperty(`--${name}`, both[which]);
    return [name, both[which]];
  }));
}
