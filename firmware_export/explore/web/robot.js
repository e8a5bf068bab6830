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

function solid(shape, material, at, order = 0) {
  const mesh = new THREE.Mesh(shape, material);
  mesh.position.copy(at);
  mesh.renderOrder = order;
  return mesh;
}
const ball = (at, radius, material) =>
  solid(new THREE.SphereGeometry(radius, 20, 14), material, at);

// A bar between two points.
function bar(from, to, radius, material, order) {
  const along = to.clone().sub(from), mesh = solid(BAR, material, from, order);
  mesh.position.addScaledVector(along, 0.5);
  mesh.scale.set(radius, Math.max(along.length(), 1e-9), radius);
  mesh.quaternion.setFromUnitVectors(UP, along.normalize());
  return mesh;
}

// What runs round discs of a link that have one axis and side: the hull of their rims.
function belts(discs, size, material) {
  const side = ({ axis, position }) => (axis.dot(position) / size).toFixed(5);
  const groups = Map.groupBy(discs, (disc) => [side(disc), ...disc.axis.toArray()].join());
  return [...groups.values()].map((group) => {
    const turn = new Quaternion().setFromUnitVectors(UP, group[0].axis);
    const round = Math.max(...group.map(({ radius }) => radius));
    const width = Math.min(0.5 * round, 0.09 * size);
    const rims = group.flatMap(({ position, radius }) => {
      const drum = new THREE.CylinderGeometry(radius, radius, width, 36);
      const rim = drum.applyQuaternion(turn).translate(...position).getAttribute("position");
      return Array.from({ length: rim.count }, (_, i) => vector(rim.array, 3 * i));
    });
    return new THREE.Mesh(new THREE.ConvexGeometry(rims), material);
  });
}

function primitive({ kind, size, origin, rpy }, material) {
  const [a, b, c] = [size].flat(), shape = {
    box: () => new THREE.BoxGeometry(a, b, c),
    sphere: () => new THREE.SphereGeometry(a, 24, 16),
    cylinder: () => new THREE.CylinderGeometry(a, a, b, 28).rotateX(Math.PI / 2),
  }[kind]();
  const mesh = solid(shape, material, vector(origin));
  mesh.rotation.set(...rpy, "ZYX");
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
      .forEach((end) => made.push(bar(start, end, thin, looks.link)));
    if (joint) made.push(ball(start, 1.6 * thin, looks.link));
    return made;
  }

  // Move the joints; the com stays at the origin.
  pose(q) {
    const { links, parameters } = this.scene, com = new Vector3();
    links.filter(({ parent }) => parent).forEach(({ name, origin, rpy, joint }) => {
      const link = this.links[name];
      link.position.fromArray(origin);
      link.rotation.set(...rpy, "ZYX");
      if (!joint) return;
      const at = parameters.findIndex((one) => one.name === joint.parameter);
      const value = joint.scale * q[at] + joint.offset, axis = vector(joint.axis);
      if (joint.kind === "prismatic") link.translateOnAxis(axis, value);
      else link.rotateOnAxis(axis, value);
    });
    this.root.position.set(0, 0, 0);
    const total = links.reduce((sum, { mass }) => sum + mass, 0) || 1;
    links.forEach(({ name, mass, com: at }) => com.addScaledVector(
      this.body.worldToLocal(this.links[name].localToWorld(vector(at))), mass / total));
    this.root.position.copy(com.negate());
  }
}
