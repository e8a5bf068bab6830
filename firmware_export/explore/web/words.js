// SPDX-License-Identifier: MIT
// Numbers and verdicts as text.

export const DEGREES = 180 / Math.PI;

// A number with so many digits that count; a dash where there is none.
export function digits(x, count) {
  if (!Number.isFinite(x)) return "–";
  if (x === 0 || Math.abs(x) < 1e-12) return "0";
  return Math.abs(x) >= 1e-3 && Math.abs(x) < 1e5 ? String(Number(x.toPrecision(count))) : x.toPrecision(count);
}

export const degrees = (x, places = 2) =>
  Number.isFinite(x) ? `${(x * DEGREES).toFixed(places).replace("-", "−")}°` : "–";

export const lengthOf = (x, unit, count = 4) =>
  digits(x, count) === "–" ? "–" : `${digits(x, count)}${unit === "1" ? "" : ` ${unit}`}`;

export const plain = (name) => name.replaceAll("_", " ");

export const VERDICT = { 0: "stands", 4: "rocks", 2: "tips over" };

// The two contacts of an axis in words.
export function pair(scene, over) {
  const names = [...new Set(over)].map((i) => scene.contacts[i]).filter(Boolean).map((c) => plain(c.name));
  return names.length ? names.join(" – ") : "none";
}

// How a tip angle reads where there is no boundary, or nothing to stand on.
export function tipText(tip, places = 2) {
  if (tip > 3.14159) return "never tips";
  if (tip < -3.14159) return "no support";
  return degrees(tip, places);
}
