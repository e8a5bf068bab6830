// SPDX-License-Identifier: MIT
// Colours: one for one meaning, as in the figures of lutgen (lutgen/plot/style.py), light and dark.

const LIGHT = {
  page: "#ffffff", ink: "#1b1f24", soft: "#59636e", line: "#c4cad1", ground: "#d8d3c8", rim: "#8b949e",
  body: "#aab4bf", link: "#8d98a5", wheel: "#5b6670", foot: "#3a4149",
  support: "#009e73", centre: "#0072b2", least: "#d55e00", gravity: "#1b1f24", gap: "#cc79a7",
  tips: "#e4e6e9", hatch: "#a9b0b8", rocks: "#cc79a7",
};
const DARK = {
  page: "#14181d", ink: "#e6eaee", soft: "#9aa5b1", line: "#3b444e", ground: "#2b2f33", rim: "#7d8792",
  body: "#6d7985", link: "#7e8a96", wheel: "#98a3ae", foot: "#c3ccd5",
  support: "#2bc399", centre: "#58b2ee", least: "#ff8a3d", gravity: "#f2f5f8", gap: "#e59bc3",
  tips: "#23292f", hatch: "#56606a", rocks: "#e59bc3",
};
// Viridis at nine places, perceptually even, also for colour-blind readers.
const VIRIDIS = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129],
  [92, 200, 99], [170, 220, 50], [253, 231, 37]];

export const isDark = (theme) =>
  theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;

export const palette = (theme) => (isDark(theme) ? DARK : LIGHT);

// The colour of a part from 0 to 1 in steps of a tenth, so that levels can be told.
export function level(part) {
  const clipped = Math.min(0.999, Math.max(0, part)), step = (Math.floor(clipped * 10) + 0.5) / 10;
  const place = step * (VIRIDIS.length - 1), k = Math.floor(place), rest = place - k;
  return VIRIDIS[k].map((x, i) => Math.round(x + rest * (VIRIDIS[k + 1][i] - x)));
}

// A number that people like to read, just above the most that there is: the top of ten levels.
export function niceTop(most) {
  if (!(most > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(most));
  return [1, 1.5, 2, 3, 4, 5, 6, 8, 10].map((x) => x * power).find((x) => x >= most * 0.999);
}
