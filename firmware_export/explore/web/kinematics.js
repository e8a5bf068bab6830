// SPDX-License-Identifier: MIT
// From parameters to a posture: frames of links, the centre of mass, contacts relative to it.
import { add, apply, cross, dot, length, minus, rotation, scale, times, unit } from "./vector.js";

// Frames of all links in the recipe's frame; parents come first.
export function frames(scene, params) {
  const found = [];
  for (const link of scene.links) {
    if (link.parent < 0) {
      found.push({ turn: [1, 0, 0, 0, 1, 0, 0, 0, 1], at: [0, 0, 0] });
      continue;
    }
    const base = found[link.parent];
    let at = add(base.at, apply(base.turn, link.origin)), turn = times(base.turn, link.turn);
    if (link.joint) {
      const { kind, axis, parameter, scale: factor, offset } = link.joint;
      const value = factor * params[parameter] + offset;
      if (kind === "prismatic") at = add(at, apply(turn, scale(axis, value)));
      else turn = times(turn, rotation(axis, value));
    }
    found.push({ turn, at });
  }
  return found;
}

// A posture: frames, com in the recipe's frame, contacts [x, y, z, radius, axis] relative to it.
export function posture(scene, params) {
  const all = frames(scene, params);
  const total = scene.links.reduce((sum, link) => sum + link.mass, 0);
  let com = [0, 0, 0];
  scene.links.forEach((link, i) => {
    if (link.mass > 0) {
      const at = add(all[i].at, apply(all[i].turn, link.com));
      com = add(com, scale(at, link.mass / total));
    }
  });
  const contacts = scene.contacts.map((contact) => {
    const frame = all[contact.link];
    const centre = minus(add(frame.at, apply(frame.turn, contact.position)), com);
    return { centre, radius: contact.radius, axis: contact.axis && apply(frame.turn, contact.axis) };
  });
  return { frames: all, com, contacts };
}

// Where a contact touches a plane with an outward unit normal.
export function touch(contact, n) {
  const { centre, radius, axis } = contact;
  if (!radius) return centre;
  if (!axis) return add(centre, scale(n, radius));
  const flat = minus(n, scale(axis, dot(axis, n)));
  return add(centre, scale(flat, radius / Math.max(length(flat), 1e-3)));
}

// The support polygon of a facet: the hull of what touches its plane within the tolerance.
export function supportPolygon(contacts, n, height, tolerance) {
  const touching = contacts.map((one) => touch(one, n)).filter((p) => height - dot(p, n) <= tolerance);
  const e1 = unit(cross(Math.abs(n[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], n)), e2 = cross(n, e1);
  return hull(touching.map((p) => ({ x: dot(p, e1), y: dot(p, e2), p }))).map((one) => one.p);
}

// The convex hull of points with x and y, counter-clockwise (Andrew).
export function hull(points) {
  const sorted = [...points].sort((a, b) => a.x - b.x || a.y - b.y);
  const bend = (o, a, b) => (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
  const half = (row) => {
    const out = [];
    for (const p of row) {
      while (out.length > 1 && bend(out[out.length - 2], out[out.length - 1], p) <= 0) out.pop();
      out.push(p);
    }
    out.pop();
    return out;
  };
  return sorted.length < 3 ? sorted : [...half(sorted), ...half(sorted.reverse())];
}
