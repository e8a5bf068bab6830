// SPDX-License-Identifier: MIT
// Numbers and verdicts as text.
const DEGREES = 180 / Math.PI;
const STATUS = {
  0: "SMAP_OK", 4: "SMAP_ROCKS", 2: "SMAP_TIPS", 3: "SMAP_OFF_CHART", 5: "SMAP_OFF_RANGE",
  6: "SMAP_CORRUPT", "-1": "SMAP_INVALID",
};
const VERDICT = { 0: "stands", 4: "rocks", 2: "tips over" };
const CLASS = { 0: "stands", 4: "rocks", 2: "tips" };
const CLOSE = 5 / DEGREES; // nearer to tipping than this nothing is green

const stands = ({ status }) => status === 0 || status === 4;
const verdictOf = ({ status }) => VERDICT[status] ?? "no answer";
const classOf = ({ status, tip }) =>
  status === 0 && tip < CLOSE ? "close" : CLASS[status] ?? "tips";
const plain = (name) => name.replaceAll("_", " ");

// A number with so many digits that count; a dash where there is none.
function digits(x, count) {
  if (!Number.isFinite(x)) return "–";
  if (Math.abs(x) < 1e-12) return "0";
  const text = x.toPrecision(count);
  return Math.abs(x) >= 1e-3 && Math.abs(x) < 1e5 ? String(Number(text)) : text;
}

const degrees = (x, places = 2) =>
  Number.isFinite(x) ? `${(x * DEGREES).toFixed(places).replace("-", "−")}°` : "–";
const withUnit = (x, unit) =>
  Number.isFinite(x) ? `${digits(x, 4)}${unit === "1" ? "" : ` ${unit}`}` : "–";

// How a tip angle reads where there is no boundary, or nothing to stand on.
function tipText({ status, tip }, places = 2) {
  if (!(status in VERDICT)) return "–";
  if (tip > 3.14159) return "never tips";
  return tip < -3.14159 ? "no support" : degrees(tip, places);
}

// The two contacts of an axis in words.
function pairText(scene, over) {
  const names = [...new Set(over)].map((i) => scene.contacts[i]).filter(Boolean);
  return names.map((contact) => plain(contact.name)).join(" – ") || "none";
}
