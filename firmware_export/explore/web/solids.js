// SPDX-License-Identifier: MIT
// The robot's bodies: belts round wheels of a link, balls, feet, struts between joints, shapes of a URDF.
import {
  BoxGeometry, CylinderGeometry, ExtrudeGeometry, Group, Matrix4, Mesh, Shape, SphereGeometry, Vector3,
} from "three";
import { hull } from "./kinematics.js";
import { lit } from "./looks.js";
import { across, add, dot, length, minus, scale, unit } from "./vector.js";

const UP = new Vector3(0, 1, 0);

// A cylinder between two points.
export function rod(from, to, radius, look) {
  const along = minus(to, from), size = length(along);
  const mesh = new Mesh(new CylinderGeometry(radius, radius, size || 1e-9, 14), look);
  mesh.position.set(...add(from, scale(along, 0.5)));
  mesh.quaternion.setFromUnitVectors(UP, new Vector3(...unit(along)));
  return mesh;
}

export function ball(at, radius, look) {
  const mesh = new Mesh(new SphereGeometry(radius, 20, 14), look);
  mesh.position.set(...at);
  return mesh;
}

// What runs round discs with one axis and side: the hull of their rims, as a slab.
function belt(discs, width, look) {
  const axis = discs[0].axis, [e1, e2] = across(axis), points = [];
  for (const disc of discs) {
    for (let k = 0; k < 36; k++) {
      const a = (k * Math.PI) / 18, x = dot(disc.position, e1), y = dot(disc.position, e2);
      points.push({ x: x + disc.radius * Math.cos(a), y: y + disc.radius * Math.sin(a) });
    }
  }
  const shape = new Shape(hull(points).map((p) => new Vector3(p.x, p.y, 0)));
  const geometry = new ExtrudeGeometry(shape, { depth: width, bevelEnabled: false, curveSegments: 1 });
  const mesh = new Mesh(geometry, look);
  const side = dot(discs[0].position, axis) - width / 2;
  mesh.applyMatrix4(new Matrix4().makeBasis(new Vector3(...e1), new Vector3(...e2), new Vector3(...axis))
    .setPosition(...scale(axis, side)));
  return mesh;
}

function primitive({ kind, size, at, turn }, look) {
  const make = {
    box: () => new BoxGeometry(...size),
    sphere: () => new SphereGeometry(size[0], 24, 16),
    cylinder: () => new CylinderGeometry(size[0], size[0], size[1], 28).rotateX(Math.PI / 2),
  }[kind];
  const mesh = new Mesh(make(), look), t = turn;
  mesh.applyMatrix4(new Matrix4().set(t[0], t[1], t[2], at[0], t[3], t[4], t[5], at[1], t[6], t[7], t[8], at[2], 0, 0, 0, 1));
  return mesh;
}

// Discs of a link that are round one belt: the same axis, the same place along it.
function belts(discs, size) {
  const groups = [];
  for (const disc of discs) {
    const near = (one) => Math.abs(Math.abs(dot(one.axis, disc.axis)) - 1) < 1e-6 &&
      Math.abs(dot(minus(one.position, disc.position), disc.axis)) < 1e-6 * size;
    const found = groups.find((group) => near(group[0]));
    if (found) found.push(disc);
    else groups.push([disc]);
  }
  return groups;
}

// How wide a belt is drawn: not wider than the way to the next one on its axis.
function widthOf(discs, all, size) {
  const own = discs[0], gaps = all.map((d) => Math.abs(dot(minus(d.position, own.position), own.axis)))
    .filter((gap) => gap > 1e-6 * size);
  return Math.min(0.5 * Math.max(...discs.map((d) => d.radius)), 0.09 * size, 0.8 * Math.min(Infinity, ...gaps));
}

// A group for each link, in the order of the scene; `colours` of the palette.
export function bodies(scene, colours) {
  const size = scene.size, looks = {
    body: lit(colours.body), link: lit(colours.link), wheel: lit(colours.wheel), foot: lit(colours.foot),
  };
  return scene.links.map((link, index) => {
    const group = new Group();
    group.matrixAutoUpdate = false;
    const own = scene.contacts.filter((contact) => contact.link === index);
    const discs = own.filter((contact) => contact.axis), others = own.filter((contact) => !contact.axis);
    const ends = scene.links.filter((one) => one.parent === index).map((one) => one.origin);
    const ranges = [...ends, ...own.map((contact) => contact.position)];
    link.shapes.forEach((shape) => group.add(primitive(shape, looks[link.parent < 0 ? "body" : "link"])));
    for (const discGroup of belts(discs, size)) {
      group.add(belt(discGroup, widthOf(discGroup, discs, size), looks.wheel));
    }
    others.forEach((contact) => group.add(ball(contact.position, contact.radius || 0.016 * size, looks.foot)));
    const boxed = link.parent < 0 && !link.shapes.length && chassis(group, [...ranges, link.com], size, looks.body);
    const thin = (link.parent < 0 ? 0.011 : 0.015) * size;
    const start = link.parent < 0 ? link.com : [0, 0, 0];
    if (!link.shapes.length) {
      const covered = discs.length > 1 || (link.parent < 0 && boxed);
      const to = covered ? others.map((contact) => contact.position) : ranges;
      to.filter((end) => length(minus(end, start)) > 0.03 * size).forEach((end) => {
        group.add(rod(start, end, thin, looks.link));
      });
      if (link.parent >= 0 && link.joint) group.add(ball([0, 0, 0], 1.6 * thin, looks.link));
    }
    group.userData.link = index;
    return group;
  });
}

// A box about what is fixed to the root, smaller than that; where there is no room a ball, and false.
function chassis(group, points, size, look) {
  const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k])));
  const high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
  const spans = high.map((x, k) => x - low[k]);
  if (Math.max(spans[0], spans[1]) < 0.08 * size) {
    group.add(ball(points[points.length - 1], 0.06 * size, look));
    return false;
  }
  const sides = spans.map((x, k) => Math.max((k === 2 ? 0.5 : 0.62) * x, 0.09 * size));
  const mesh = new Mesh(new BoxGeometry(...sides), look);
  mesh.position.set(...low.map((x, k) => (x + high[k]) / 2));
  group.add(mesh);
  return true;
}
