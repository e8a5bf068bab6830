// SPDX-License-Identifier: MIT
// The robot's links as three.js has them: where joints put them, and bodies to look at.
const UP = new Vector3(0, 1, 0);

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
const recolour = (colours) =>
  LOOKS.forEach(({ colour, material }) => material.color.set(colours[colour]));

const turnOf = ([roll, pitch, yaw]) =>
  new Quaternion().setFromEuler(new THREE.Euler(roll, pitch, yaw, "ZYX"));
const moved = (mesh, at) => (mesh.position.copy(at), mesh);
const ball = (at, radius, material) =>
  moved(new THREE.Mesh(new THREE.SphereGeometry(radius, 20, 14), material), at);

// Put a bar of length 1 along y, or what points there, between two points; hidden where they are one.
function span(mesh, from, to, radius) {
  const along = to.clone().sub(from), far = along.length();
  mesh.visible = far > 1e-9;
  mesh.position.copy(from).addScaledVector(along, 0.5);
  mesh.scale.set(radius, far, radius);
  mesh.quaternion.setFromUnitVectors(UP, along.normalize());
  return mesh;
}
const BAR = new THREE.CylinderGeometry(1, 1, 1, 14);

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
  const axis = discs[0].axis, turn = new Quaternion().setFromUnitVectors(axis, Z);
  const rims = discs.flatMap(({ position, radius }) => {
    const { x, y } = position.clone().applyQuaternion(turn);
    return Array.from({ length: 36 }, (_, k) => k * Math.PI / 18).map((a) =>
      new Vector3(x + radius * Math.cos(a), y + radius * Math.sin(a), 0));
  });
  const slab = { depth: width, bevelEnabled: false, curveSegments: 1 };
  const mesh = new THREE.Mesh(new THREE.ExtrudeGeometry(new THREE.Shape(hull(rims)), slab), material);
  mesh.quaternion.copy(turn.invert());
  return moved(mesh, axis.clone().multiplyScalar(discs[0].position.dot(axis) - width / 2));
}

// Discs of a link that are round one belt: the same axis, the same place along it.
function belts(discs, size, material) {
  const apart = (a, b) => Math.abs(b.position.clone().sub(a.position).dot(a.axis));
  const groups = [];
  for (const disc of discs) {
    const found = groups.find(([one]) =>
      Math.abs(one.axis.dot(disc.axis)) > 1 - 1e-6 && apart(one, disc) < 1e-6 * size);
    if (found) found.push(disc);
    else groups.push([disc]);
  }
  return groups.map((group) => {
    const gaps = discs.map((disc) => apart(group[0], disc)).filter((gap) => gap > 1e-6 * size);
    const round = Math.max(...group.map((disc) => disc.radius));
    return belt(group, Math.min(0.5 * round, 0.09 * size, 0.8 * Math.min(Infinity, ...gaps)), material);
  });
}

function primitive({ kind, size, at, rpy }, material) {
  const geometry = {
    box: () => new THREE.BoxGeometry(...size),
    sphere: () => new THREE.SphereGeometry(size[0], 24, 16),
    cylinder: () => new THREE.CylinderGeometry(size[0], size[0], size[1], 28).rotateX(Math.PI / 2),
  }[kind]();
  const mesh = new THREE.Mesh(geometry, material);
  mesh.quaternion.copy(turnOf(rpy));
  return moved(mesh, vector(at));
}

// A box about what is fixed to the root, smaller than that; where there is no room a ball.
function chassis(points, com, size, material) {
  const box = new THREE.Box3().setFromPoints([...points, com]), room = box.getSize(new Vector3());
  if (Math.max(room.x, room.y) < 0.08 * size) return ball(com, 0.06 * size, material);
  const sides = [0.62 * room.x, 0.62 * room.y, 0.5 * room.z].map((x) => Math.max(x, 0.09 * size));
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(...sides), material);
  return moved(mesh, box.getCenter(new Vector3()));
}

class Robot {
  constructor(scene) {
    this.scene = scene;
    this.body = new THREE.Group(); // its origin is the com
    this.root = new THREE.Group(); // the recipe's frame
    this.links = scene.links.map(() => new THREE.Group());
    scene.links.forEach(({ parent }, i) => (this.links[parent] ?? this.root).add(this.links[i]));
    this.body.add(this.root);
    const looks = Object.fromEntries(["body", "link", "wheel", "foot"].map((one) => [one, lit(one)]));
    this.links.forEach((link, i) => this.solids(i, looks).forEach((solid) => link.add(solid)));
  }

  // What is seen of a link: its shapes or else struts, and its contacts.
  solids(index, looks) {
    const { links, contacts, size } = this.scene, link = links[index], isRoot = link.parent < 0;
    const own = contacts.filter((one) => one.link === index).map((one) =>
      ({ radius: one.radius, position: vector(one.position), axis: one.axis && vector(one.axis) }));
    const discs = own.filter((one) => one.axis), feet = own.filter((one) => !one.axis);
    const made = belts(discs, size, looks.wheel);
    made.push(...link.shapes.map((shape) => primitive(shape, looks[isRoot ? "body" : "link"])));
    made.push(...feet.map((one) => ball(one.position, one.radius || 0.016 * size, looks.foot)));
    if (link.shapes.length) return made;
    const start = isRoot ? vector(link.com) : new Vector3(), thin = (isRoot ? 0.011 : 0.015) * size;
    const places = (some) => some.map((one) => one.position);
    const joints = links.filter((one) => one.parent === index).map((one) => vector(one.origin));
    const ends = [...joints, ...places(own)];
    if (isRoot) made.push(chassis(ends, start, size, looks.body));
    const covered = discs.length > 1 || made.at(-1)?.geometry.type === "BoxGeometry";
    (covered ? places(feet) : ends).filter((end) => end.distanceTo(start) > 0.03 * size)
      .forEach((end) => made.push(span(new THREE.Mesh(BAR, looks.link), start, end, thin)));
    if (link.joint) made.push(ball(new Vector3(), 1.6 * thin, looks.link));
    return made;
  }

  // Move the joints; the com stays at the origin.
  pose(q) {
    const { links } = this.scene, com = new Vector3();
    links.forEach(({ parent, origin, rpy, joint }, i) => {
      const link = this.links[i];
      if (parent < 0) return;
      link.position.fromArray(origin);
      link.quaternion.copy(turnOf(rpy));
      if (!joint) return;
      const value = joint.scale * q[joint.parameter] + joint.offset, axis = vector(joint.axis);
      if (joint.kind === "prismatic") link.translateOnAxis(axis, value);
      else link.rotateOnAxis(axis, value);
    });
    this.root.position.set(0, 0, 0);
    const total = links.reduce((sum, link) => sum + link.mass, 0);
    links.forEach((link, i) => com.addScaledVector(this.place(i, link.com), link.mass / total));
    this.root.position.copy(com.negate());
  }

  // A place in a link's frame, from the com.
  place(index, at) {
    return this.body.worldToLocal(this.links[index].localToWorld(vector(at)));
  }

  // Contacts from the com, [place, radius] each.
  contacts() {
    return this.scene.contacts.map((one) => [this.place(one.link, one.position), one.radius]);
  }
}
