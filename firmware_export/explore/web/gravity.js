// SPDX-License-Identifier: MIT
// Directions of gravity: tilt and heading, the disc of equal areas, and how a robot is seated.
const { Quaternion, Vector3 } = THREE;
const vector = (numbers, at = 0) => new Vector3().fromArray(numbers, at);
const Z = new Vector3(0, 0, 1), REST = 2;

// Heading 0: nose down; positive: to the left (lutgen/analysis/tilt.py).
function tilted(tilt, heading) {
  const s = Math.sin(tilt);
  return new Vector3(s * Math.cos(heading), s * Math.sin(heading), -Math.cos(tilt));
}

function angles(g) {
  const flat = Math.hypot(g.x, g.y);
  return { tilt: Math.atan2(flat, -g.z), heading: flat > 1e-9 ? Math.atan2(g.y, g.x) : 0 };
}

// Lambert's azimuthal projection: the nose at the top, left at the left; 1 at the rim.
function toDisc(g, rim) {
  const { tilt, heading } = angles(g), r = Math.sin(tilt / 2) / Math.sin(rim / 2);
  return [-r * Math.sin(heading), r * Math.cos(heading)];
}

function fromDisc(x, y, rim) {
  const r = Math.min(Math.hypot(x, y) * Math.sin(rim / 2), 1);
  return tilted(2 * Math.asin(r), Math.atan2(-x, y));
}

// A vector after the least rotation that takes z to `up`; upside down, the half turn about x.
function turned(up, x) {
  if (up.z < 1e-12 - 1) return new Vector3(x.x, -x.y, -x.z);
  return x.clone().applyQuaternion(new Quaternion().setFromUnitVectors(Z, up));
}

// Gravity in the body of a robot that is put on a plane, in whose frame gravity is given
// (`_settle` of lutgen/channels/settle.py): with the least inclined rest that carries it.
function seated({ facets, edges }, gravity) {
  let best = null, up = -2, nearest = null, most = -Infinity;
  const rests = facets.some((facet) => facet.kind === REST);
  facets.forEach((facet, index) => {
    if (rests && facet.kind !== REST) return;
    const above = facet.plane.clone().multiplyScalar(-facet.height), g = turned(above, gravity);
    const walls = edges.filter((edge) => edge.facet === index);
    const inside = Math.min(1, ...walls.map(({ start, stop }) =>
      new Vector3().crossVectors(start, stop).normalize().dot(g)));
    if (inside >= 0 && above.z > up) [best, up] = [g, above.z];
    if (inside > most) [nearest, most] = [g, inside];
  });
  return best ?? nearest ?? gravity;
}

// The facet whose plane the ray along g pierces first.
function pierced({ facets }, g) {
  const rate = (facet) => facet.plane.dot(g);
  const first = facets.reduce((a, b) => (rate(b) > rate(a) ? b : a), facets[0]);
  return first && rate(first) > 0 ? first : null;
}
