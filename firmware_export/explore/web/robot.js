// SPDX-License-Identifier: MIT
// The robot's links as three.js has them: where joints put them, and bodies to look at.
const UP = new Vector3(0, 1, 0), BAR = new THREE.CylinderGeometry(1, 1, 1, 14);

// Materials by the name of their colour, which changes with the theme.
const LOOKS = [];
function look(colour, made) {
  const material = Object.assign(made, { side: THREE.DoubleSide, forceSinglePass: true });
  LOOKS.push({ colour, material });
  return material;
}
const lit = (colour) => look(colour, new THREE.MeshLambertMaterial());
const flat = (colour, more) =>
  look(colour, new THREE.MeshBasicMaterial({ transparent: true, ...more }));

const turnOf = ([roll, pitch, yaw]) =>
  new Quaternion().setFromEuler(new THREE.Euler(roll, pitch, yaw, "ZYX"));
const solid = (shape, material, at) => moved(new THREE.Mesh(shape, material), at);
const ball = (at, radius, material) =>
  solid(new THREE.SphereGeometry(radius, 20, 14), material, at);
function moved(mesh, at) {
  mesh.position.copy(at);
  return mesh;
}

// Put a bar of length 1 along y between two points; hidden where they are one.
function span(mesh, from, to, radius) {
  const along = to.clone().sub(from), far = along.length();
  mesh.visible = far > 1e-9;
  mesh.position.copy(from).addScaledVector(along, 0.5);
  mesh.scale.set(radius, far, radius);
  mesh.quaternion.setFromUnitVectors(UP, along.normalize());
  return mesh;
}

// The convex hull of points with x and y, counter-clockwise (Andrew).
function hull(points) {
  const bend = (o, a, b) => (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
  const half = (row) => {
    const out = [];
    for (const p of row) {
      while (out.length > 1 && bend(out.at(-2), out.at(-1), p) <= 0) out.pop();
      out.push(p);
    }
    return out.slice(0, -1);
  };
  const sorted = [...points].sort((a, b) => a.x - b.x || a.y - b.y);
  return sorted.length < 3 ? sorted : [...half(sorted), ...half(sorted.reverse())];
}

// What runs round discs with one axis and side: the hull of their rims, as a slab.
function belt(discs, width, material) {
  const [{ axis, position: first }] = discs, turn = new Quaternion().setFromUnitVectors(axis, Z);
  const rims = discs.flatMap(({ position, radius }) => {
    const rim = new THREE.EllipseCurve(0, 0, radius, radius).getPoints(36);
    const { x, y } = position.clone().applyQuaternion(turn);
    return rim.map((p) => p.add({ x, y }));
  });
  const slab = { depth: width, bevelEnabled: false, curveSegments: 1 };
  const shape = new THREE.ExtrudeGeometry(new THREE.Shape(hull(rims)), slab);
  const mesh = solid(shape, material, axis.clone().multiplyScalar(first.dot(axis) - width / 2));
  mesh.quaternion.copy(turn.invert());
  return mesh;
}

// Discs of a link that have one axis and side are round one belt.
function belts(discs, size, material) {
  const apart = (a, b) => Math.abs(b.position.clone().sub(a.position).dot(a.axis));
  const alike = (a, b) => Math.abs(a.axis.dot(b.axis)) > 1 - 1e-6 && apart(a, b) < 1e-6 * size;
  const firsts = discs.filter((disc, i) => !discs.slice(0, i).some((one) => alike(one, disc)));
  return firsts.map((first) => {
    const group = discs.filter((disc) => alike(first, disc));
    const gaps = discs.map((disc) => apart(first, disc)).filter((gap) => gap > 1e-6 * size);
    const round = Math.max(...group.map((disc) => disc.radius));
    const width = Math.min(0.5 * round, 0.09 * size, ...gaps.map((gap) => 0.8 * gap));
    return belt(group, width, material);
  });
}

function primitive({ kind, size, origin, rpy }, material) {
  const [a, b, c] = [size].flat(), shape = {
    box: () => new THREE.BoxGeometry(a, b, c),
    sphere: () => new THREE.SphereGeometry(a, 24, 16),
    cylinder: () => new THREE.CylinderGeometry(a, a, b, 28).rotateX(Math.PI / 2),
  }[kind]();
  const mesh = solid(shape, material, vector(origin));
  mesh.quaternion.copy(turnOf(rpy));
  return mesh;
}

class Robot {
  constructor(scene) {
    this.scene = scene;
    this.body = new THREE.Group(); // its origin is the com
    this.root = new THREE.Group(); // the recipe's frame
    this.body.add(this.root);
    this.links = Object.fromEntries(scene.links.map(({ name }) => [name, new THREE.Group()]));
    const looks = { body: lit("body"), link: lit("link"), wheel: lit("wheel"), foot: lit("foot") };
    scene.links.forEach((link) => {
      const group = this.links[link.name];
      (this.links[link.parent] ?? this.root).add(group);
      this.solids(link, looks).forEach((one) => group.add(one));
    });
  }

  // What is seen of a link: its contacts, and its shapes or else a box or ball and struts.
  solids({ name, parent, shapes, com, joint }, looks) {
    const { links, contacts, size } = this.scene;
    const own = contacts.filter((one) => one.link === name).map((one) =>
      ({ radius: one.radius, position: vector(one.position), axis: one.axis && vector(one.axis) }));
    const discs = own.filter((one) => one.axis), feet = own.filter((one) => !one.axis);
    const made = [
      ...belts(discs, size, looks.wheel),
      ...feet.map((one) => ball(one.position, one.radius || 0.016 * size, looks.foot)),
      ...shapes.map((shape) => primitive(shape, parent ? looks.link : looks.body)),
    ];
    if (shapes.length) return made;
    const start = parent ? new Vector3() : vector(com), thin = (parent ? 0.015 : 0.011) * size;
    const joints = links.filter((one) => one.parent === name).map((one) => vector(one.origin));
    const ends = [...joints, ...own.map((one) => one.position)];
    const box = new THREE.Box3().setFromPoints([...ends, start]), room = box.getSize(new Vector3());
    const boxed = !parent && Math.max(room.x, room.y) >= 0.08 * size;
    if (boxed) {
      const sides = room.multiply({ x: 0.62, y: 0.62, z: 0.5 }).clampScalar(0.09 * size, Infinity);
      made.push(solid(new THREE.BoxGeometry(...sides), looks.body, box.getCenter(new Vector3())));
    } else if (!parent) made.push(ball(start, 0.06 * size, looks.body));
    (boxed || discs.length > 1 ? feet.map((one) => one.position) : ends)
      .filter((end) => end.distanceTo(start) > 0.03 * size)
      .forEach((end) => made.push(span(new THREE.Mesh(BAR, looks.link), start, end, thin)));
    if (joint) made.push(ball(start, 1.6 * thin, looks.link));
    return made;
  }

  // Move the joints; the com stays at the origin.
  pose(q) {
    const { links, parameters } = this.scene, com = new Vector3();
    links.filter(({ parent }) => parent).forEach(({ name, origin, rpy, joint }) => {
      const link = this.links[name];
      link.position.fromArray(origin);
      link.quaternion.copy(turnOf(rpy));
      if (!joint) return;
      const at = parameters.findIndex((one) => one.name === joint.parameter);
      const value = joint.scale * q[at] + joint.offset, axis = vector(joint.axis);
      if (joint.kind === "prismatic") link.translateOnAxis(axis, value);
      else link.rotateOnAxis(axis, value);
    });
    this.root.position.set(0, 0, 0);
    const total = links.reduce((sum, { mass }) => sum + mass, 0) || 1;
    links.forEach((link) =>
      com.addScaledVector(this.place(link.name, link.com), link.mass / total));
    this.root.position.copy(com.negate());
  }

  // A place in a link's frame, from the com.
  place(name, at) {
    return this.body.worldToLocal(this.links[name].localToWorld(vector(at)));
  }

  // Contacts from the com, [place, radius] each.
  contacts() {
    return this.scene.contacts.map((one) => [this.place(one.link, one.position), one.radius]);
  }
}
