// SPDX-License-Identifier: MIT
// Colours: one for one meaning, as in the figures of lutgen (lutgen/plot/style.py), light and dark.
const COLOURS = {
  page: ["#ffffff", "#14181d"], ink: ["#1b1f24", "#e6eaee"], soft: ["#59636e", "#9aa5b1"],
  line: ["#d5dae0", "#313941"], panel: ["#f6f7f9", "#1b2026"], rim: ["#8b949e", "#7d8792"],
  // A verdict as a word.
  stands: ["#00724f", "#2bc399"], close: ["#7d5a00", "#e8b84a"], rocks: ["#a2457d", "#e59bc3"],
  tips: ["#b3400a", "#ff8a3d"],
  // What is drawn.
  ground: ["#d8d3c8", "#2b2f33"], body: ["#aab4bf", "#6d7985"], link: ["#8d98a5", "#7e8a96"],
  wheel: ["#5b6670", "#98a3ae"], foot: ["#3a4149", "#c3ccd5"],
  support: ["#009e73", "#2bc399"], gap: ["#cc79a7", "#e59bc3"], centre: ["#0072b2", "#58b2ee"],
  least: ["#d55e00", "#ff8a3d"], fallen: ["#e4e6e9", "#23292f"], hatch: ["#a9b0b8", "#56606a"],
};
// Viridis at nine places, perceptually even, also for colour-blind readers.
const VIRIDIS = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129],
  [92, 200, 99], [170, 220, 50], [253, 231, 37],
];

const isDark = (theme) =>
  theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;

// Every colour by its name; the style sheet gets them too.
function palette(theme) {
  const root = document.documentElement, which = isDark(theme) ? 1 : 0;
  root.dataset.theme = which ? "dark" : "light";
  return Object.fromEntries(Object.entries(COLOURS).map(([name, both]) => {
    root.style.setProperty(`--${name}`, both[which]);
    return [name, both[which]];
  }));
}

// The colours of ten levels, so that they can be told.
const LEVELS = Array.from({ length: 10 }, (_, k) => {
  const place = (k + 0.5) / 10 * (VIRIDIS.length - 1), low = Math.floor(place);
  return VIRIDIS[low].map((x, i) => Math.round(x + (place - low) * (VIRIDIS[low + 1][i] - x)));
});

// A number that people like to read, just above the most that there is: the top of ten levels.
function niceTop(most) {
  if (!(most > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(most));
  return [1, 1.5, 2, 3, 4, 5, 6, 8, 10].map((x) => x * power).find((x) => x >= most * 0.999);
}
