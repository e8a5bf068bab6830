// SPDX-License-Identifier: MIT
// Vectors of three numbers and matrices of nine (row by row), as plain arrays.

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const length = (a) => Math.sqrt(dot(a, a));
export const mix = (a, b, part) => a.map((x, i) => x + part * (b[i] - x));

export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function unit(a) {
  const size = length(a);
  return size > 0 ? scale(a, 1 / size) : [0, 0, 0];
}

export function apply(m, v) {
  return [
    m[0] * v[0] + m[1] * v[1] + m[2] * v[2],
    m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
    m[6] * v[0] + m[7] * v[1] + m[8] * v[2],
  ];
}

export function times(a, b) {
  const out = new Array(9);
  for (let i = 0; i < 3; i++) {
    for (let j = 0; j < 3; j++) {
      out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
  }
  return out;
}

// The rotation by an angle (rad) about a unit axis.
export function rotation(axis, angle) {
  const [x, y, z] = axis;
  const c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
  return [
    t * x * x + c, t * x * y - s * z, t * x * z + s * y,
    t * x * y + s * z, t * y * y + c, t * y * z - s * x,
    t * x * z - s * y, t * y * z + s * x, t * z * z + c,
  ];
}

// A vector after the least rotation that takes the z axis to the unit vector `up`
// (lutgen/channels/settle.py).
export function turned(up, x) {
  const a = -up[1], b = up[0], square = a * a + b * b;
  if (up[2] < 0 && square < 1e-24) return [x[0], -x[1], -x[2]];
  const first = [b * x[2], -a * x[2], a * x[1] - b * x[0]];
  const share = up[2] > -0.5 ? 1 / (1 + up[2]) : (1 - up[2]) / square;
  return [
    x[0] + first[0] + share * b * first[2],
    x[1] + first[1] - share * a * first[2],
    x[2] + first[2] + share * (a * first[1] - b * first[0]),
  ];
}

// Two unit vectors across a unit normal.
export function across(n) {
  const first = unit(cross(Math.abs(n[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], n));
  return [cross(n, first), first];
}
