// SPDX-License-Identifier: MIT
// What stands for stability in the picture: support polygon, rests, gaps, gravity, D_g, s, axes.
class Marks extends THREE.Group {
  constructor(size) {
    super();
    const above = (colour) => flat(colour, { depthTest: false });
    const area = (colour, opacity) => flat(colour, { opacity, depthWrite: false });
    this.size = size;
    this.looks = {
      ink: above("ink"), least: above("least"), centre: above("centre"),
      rest: area("support", 0.13), gap: area("gap", 0.35), polygon: area("support", 0.42),
    };
    this.shapes = {
      com: new THREE.SphereGeometry(0.022 * size, 20, 14),
      head: new THREE.ConeGeometry(0.02 * size, 0.06 * size, 16),
      pierced: new THREE.OctahedronGeometry(0.018 * size),
    };
  }

  put(shape, look, order, at) {
    const mesh = solid(this.shapes[shape], this.looks[look], at, order);
    this.add(mesh);
    return mesh;
  }

  patch(triangles, look, order) {
    const shape = new THREE.BufferGeometry().setFromPoints(triangles);
    this.add(solid(shape, this.looks[look], new Vector3(), order));
  }

  bar(from, to, radius, look, order) {
    this.add(bar(from, to, radius * this.size, this.looks[look], order));
  }

  // Show an answer; everything is relative to the com.
  show({ pose: { facets, edges }, here, g, over }) {
    const { size } = this;
    this.children.forEach(({ geometry: own }) => own.type === "BufferGeometry" && own.dispose());
    this.clear();
    facets.forEach((facet) => {
      const own = edges.filter((edge) => facets[edge.facet] === facet);
      const fan = own.flatMap(({ start, stop }) => [own[0].start, start, stop]);
      this.patch(fan, ...(facet === here ? ["polygon", 3] : ["rest", 1]));
    });
    edges.filter(({ part }) => part <= 1).forEach(({ start, stop, facet, contacts: [i, j] }) => {
      const back = edges.find(({ contacts, facet: far }) =>
        contacts[0] === j && contacts[1] === i && far !== facet);
      if (!back) return;
      this.patch([start, stop, back.start, start, back.start, back.stop], "gap", 2);
    });
    // Of an edge that a gap holds from some part on, what is before that is an axis all the same.
    edges.filter(({ part }) => part > 0).forEach((edge) => {
      const least = edge.contacts.every((contact) => over.includes(contact));
      const end = edge.start.clone().lerp(edge.stop, Math.min(edge.part, 1));
      this.bar(edge.start, end, ...(least ? [0.009, "least"] : [0.0035, "ink"]), 5);
    });
    const reach = here ? 1 / here.plane.dot(g) : Infinity, near = reach < 2 * size;
    const tip = g.clone().multiplyScalar(near ? reach : 1.3 * size);
    this.bar(new Vector3(), tip, 0.005, "ink", 6);
    const head = this.put("head", "ink", 6, tip.clone().addScaledVector(g, -0.03 * size));
    head.quaternion.setFromUnitVectors(UP, g);
    this.put("com", "ink", 8, new Vector3());
    if (!near) return;
    this.put("pierced", "ink", 8, tip);
    this.bar(here.centre, tip, 0.006, "centre", 6);
  }
}
