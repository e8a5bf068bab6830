// SPDX-License-Identifier: MIT
// What stands for stability in the picture: support polygon, rests, gaps, the ray of gravity, D_g, s, axes.
import {
  BufferGeometry, CircleGeometry, ConeGeometry, CylinderGeometry, Group, Mesh, OctahedronGeometry,
  SphereGeometry, Vector3,
} from "three";
import { supportPolygon } from "./kinematics.js";
import { flat, places } from "./looks.js";
import { dot, length, minus, mix, scale, unit } from "./vector.js";

const UP = new Vector3(0, 1, 0), AXES = 64, REST = 2;

// A flat polygon whose corners change: a fan with room for so many.
function patch(colour, opacity) {
  const geometry = new BufferGeometry(), most = 192, at = places(geometry, 9 * most);
  const mesh = new Mesh(geometry, flat(colour, { opacity, depthWrite: false }));
  mesh.frustumCulled = false;
  mesh.userData.fill = (triangles) => {
    const count = Math.min(triangles.length, 3 * most);
    for (let i = 0; i < count; i++) at.setXYZ(i, ...triangles[i]);
    at.needsUpdate = true;
    geometry.setDrawRange(0, count);
  };
  return mesh;
}

const fan = (points) => points.slice(2).flatMap((p, i) => [points[0], points[i + 1], p]);

export class Marks {
  constructor(scene, colours) {
    this.scene = scene;
    this.group = new Group();
    const above = (colour) => flat(colour, { depthTest: false });
    const put = (mesh, order) => {
      mesh.renderOrder = order;
      this.group.add(mesh);
      return mesh;
    };
    const size = scene.size;
    this.rests = put(patch(colours.support, 0.13), 1);
    this.gaps = put(patch(colours.gap, 0.35), 2);
    this.polygon = put(patch(colours.support, 0.42), 3);
    this.looks = { axis: above(colours.ink), least: above(colours.least) };
    const bar = new CylinderGeometry(1, 1, 1, 8);
    this.axes = Array.from({ length: AXES }, () => put(new Mesh(bar, this.looks.axis), 5));
    this.ray = put(new Mesh(bar, above(colours.gravity)), 6);
    this.head = put(new Mesh(new ConeGeometry(0.02 * size, 0.06 * size, 16), this.ray.material), 6);
    this.factor = put(new Mesh(bar, above(colours.centre)), 6);
    this.com = put(new Mesh(new SphereGeometry(0.022 * size, 20, 14), above(colours.gravity)), 8);
    this.pierced = put(new Mesh(new OctahedronGeometry(0.018 * size), above(colours.gravity)), 8);
    this.centre = put(new Mesh(new CircleGeometry(0.017 * size, 4), above(colours.centre)), 7);
  }

  bar(mesh, from, to, radius) {
    const along = minus(to, from), far = length(along);
    mesh.visible = far > 1e-9;
    if (!mesh.visible) return;
    mesh.position.set(...from.map((x, k) => x + along[k] / 2));
    mesh.scale.set(radius, far, radius);
    mesh.quaternion.setFromUnitVectors(UP, new Vector3(...unit(along)));
  }

  // Show an answer; everything is relative to the com.
  show(answer) {
    const { facets, edges, facet, g, contacts, exact } = answer, size = this.scene.size;
    const here = facets[facet];
    // Of an edge that a gap holds from some part on, what is before that is an axis all the same.
    const axes = edges.filter((e) => e.kind === REST && e.part > 0)
      .map((e) => (e.part > 1 ? e : { ...e, stop: mix(e.start, e.stop, e.part) }));
    const polygons = facets.map((f, i) => (f.kind === REST && i !== facet
      ? edges.filter((e) => e.facet === i).map((e) => e.start) : []));
    this.rests.userData.fill(polygons.flatMap((points) => fan(points)));
    this.gaps.userData.fill(edges.filter((e) => e.part >= 0 && e.part <= 1).flatMap((e) => {
      const back = edges.find((o) => o.contacts[0] === e.contacts[1] && o.contacts[1] === e.contacts[0] && o.facet !== e.facet);
      return back ? [e.start, e.stop, back.start, e.start, back.start, back.stop] : [];
    }));
    const corners = here ? supportPolygon(contacts, unit(here.plane), here.height, this.scene.numbers[4]) : [];
    this.polygon.userData.fill(fan(corners));
    const { over } = exact, same = (e) => over.includes(e.contacts[0]) && over.includes(e.contacts[1]);
    this.axes.forEach((mesh, i) => {
      const edge = axes[i];
      mesh.visible = Boolean(edge);
      if (!edge) return;
      mesh.material = same(edge) ? this.looks.least : this.looks.axis;
      this.bar(mesh, edge.start, edge.stop, (same(edge) ? 0.009 : 0.0035) * size);
    });
    const reach = here ? 1 / dot(here.plane, g) : Infinity, near = reach < 2 * size;
    const tip = scale(g, near ? reach : 1.3 * size);
    this.bar(this.ray, [0, 0, 0], tip, 0.005 * size);
    this.head.position.set(...scale(g, (near ? reach : 1.3 * size) - 0.03 * size));
    this.head.quaternion.setFromUnitVectors(UP, new Vector3(...g));
    this.pierced.visible = this.centre.visible = this.factor.visible = Boolean(here) && near;
    if (this.pierced.visible) {
      this.pierced.position.set(...tip);
      this.centre.position.set(...here.centre);
      this.centre.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...unit(here.plane)));
      this.bar(this.factor, here.centre, tip, 0.006 * size);
    }
  }
}
