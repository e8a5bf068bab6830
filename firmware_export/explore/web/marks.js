// SPDX-License-Identifier: MIT
// What stands for stability in the picture: support polygon, rests, gaps, gravity, D_g, s, axes.
class Marks extends THREE.Group {
  constructor(size) {
    super();
    const above = (colour) => flat(colour, { depthTest: false });
    const area = (colour, opacity) => flat(colour, { opacity, depthWrite: false });
    this.size = size;
    this.patches = [];
    this.looks = {
      ink: above("ink"), least: above("least"), centre: above("centre"),
      rest: area("support", 0.13), gap: area("gap", 0.35), polygon: area("support", 0.42),
    };
    this.shapes = {
      com: new THREE.SphereGeometry(0.022 * size, 20, 14),
      head: new THREE.ConeGeometry(0.02 * size, 0.06 * size, 16),
      pierced: new THREE.OctahedronGeometry(0.018 * size),
      centre: new THREE.CircleGeometry(0.017 * size, 4),
    };
  }

  put(shape, material, order) {
    const mesh = new THREE.Mesh(shape, this.looks[material]);
    mesh.renderOrder = order;
    this.add(mesh);
    return mesh;
  }

  patch(triangles, material, order) {
    const shape = new THREE.BufferGeometry().setFromPoints(triangles);
    this.patches.push(shape);
    this.put(shape, material, order);
  }

  // Show an answer; everything is relative to the com.
  show({ pose: { facets, edges }, here, g, over }) {
    const { size, shapes } = this;
    this.clear();
    this.patches.splice(0).forEach((shape) => shape.dispose());
    facets.filter((facet) => facet.kind === REST || facet === here).forEach((facet) => {
      const turn = new Quaternion().setFromUnitVectors(facet.plane.clone().normalize(), Z);
      const own = edges.filter((edge) => facets[edge.facet] === facet).map(({ start }) => start);
      const [first, ...rest] = hull(own.map((p) => p.clone().applyQuaternion(turn)));
      const fan = rest.slice(1).flatMap((p, i) => [first, rest[i], p]);
      const back = fan.map((p) => p.clone().applyQuaternion(turn.clone().invert()));
      this.patch(back, facet === here ? "polygon" : "rest", facet === here ? 3 : 1);
    });
    edges.filter(({ part }) => part <= 1).forEach(({ start, stop, facet, contacts: [i, j] }) => {
      const back = edges.find(({ contacts, facet: far }) =>
        contacts[0] === j && contacts[1] === i && far !== facet);
      if (!back) return;
      this.patch([start, stop, back.start, start, back.start, back.stop], "gap", 2);
    });
    // Of an edge that a gap holds from some part on, what is before that is an axis all the same.
    edges.filter(({ kind, part }) => kind === REST && part > 0).forEach((edge) => {
      const least = edge.contacts.every((contact) => over.includes(contact));
      const end = edge.start.clone().lerp(edge.stop, Math.min(edge.part, 1));
      const bar = this.put(BAR, least ? "least" : "ink", 5);
      span(bar, edge.start, end, (least ? 0.009 : 0.0035) * size);
    });
    const reach = here ? 1 / here.plane.dot(g) : Infinity, near = reach < 2 * size;
    const tip = g.clone().multiplyScalar(near ? reach : 1.3 * size);
    span(this.put(BAR, "ink", 6), new Vector3(), tip, 0.005 * size);
    const head = this.put(shapes.head, "ink", 6);
    moved(head, tip.clone().addScaledVector(g, -0.03 * size)).quaternion.setFromUnitVectors(UP, g);
    this.put(shapes.com, "ink", 8);
    if (!near) return;
    moved(this.put(shapes.pierced, "ink", 8), tip);
    span(this.put(BAR, "centre", 6), here.centre, tip, 0.006 * size);
    const centre = moved(this.put(shapes.centre, "centre", 7), here.centre);
    centre.quaternion.setFromUnitVectors(Z, here.plane.clone().normalize());
  }
}
