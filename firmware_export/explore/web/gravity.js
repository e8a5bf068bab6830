// SPDX-License-Identifier: MIT
// Directions of gravity: tilt and heading, the disc of equal areas, and how a robot is seated.
import { cross, dot, scale, turned, unit } from "./vector.js";

// Heading 0: nose down; positive: to the left (lutgen/analysis/tilt.py).
export function tilted(tilt, heading) {
  const s = Math.sin(tilt);
  return [s * Math.cos(heading), s * Math.sin(heading), -Math.cos(tilt)];
}

export function angles(g) {
  const flat = Math.hypot(g[0], g[1]);
  return { tilt: Math.atan2(flat, -g[2]), heading: flat > 1e-9 ? Math.atan2(g[1], g[0]) : 0 };
}

// Lambert's azimuthal projection: the nose at the top, left at the left; 1 at the rim.
export function toDisc(g, rim) {
  const { tilt, heading } = angles(g);
  const r = Math.sin(tilt / 2) / Math.sin(rim / 2);
  return [-r * Math.sin(heading), r * Math.cos(heading)];
}

export function fromDisc(x, y, rim) {
  const r = Math.min(Math.hypot(x, y) * Math.sin(rim / 2), 1);
  return tilted(2 * Math.asin(r), Math.atan2(-x, y));
}

const REST = 2;

// Gravity in the body of a robot that is put on a plane, in whose frame gravity is given
// (`_settle` of lutgen/channels/settle.py): with the least inclined rest that carries it.
export function seated(facets, edges, gravity) {
  const rests = facets.some((facet) => facet.kind === REST);
  let best = null, up = -2, nearest = null, most = -Infinity;
  facets.forEach((facet, index) => {
    if (rests && facet.kind !== REST) return;
    const above = scale(facet.plane, -facet.height), g = turned(above, gravity);
    let inside = 1;
    for (const edge of edges) {
      if (edge.facet === index) inside = Math.min(inside, dot(unit(cross(edge.start, edge.stop)), g));
    }
    if (inside >= 0 && above[2] > up) [best, up] = [g, above[2]];
    if (inside > most) [nearest, most] = [g, inside];
  });
  return best || nearest || gravity;
}

// The facet whose plane the ray along g pierces first, or -1.
export function pierced(facets, g) {
  let best = -1, rate = 0;
  facets.forEach((facet, index) => {
    const here = dot(facet.plane, g);
    if (here > rate * (1 + 1e-12)) [best, rate] = [index, here];
  });
  return best;
}
