// SPDX-License-Identifier: MIT
// Materials: two kinds, and normals everywhere, since whatever differs is one more program to compile
// before the first picture.
import { BufferAttribute, DoubleSide, MeshBasicMaterial, MeshLambertMaterial } from "three";

const BOTH = { side: DoubleSide, forceSinglePass: true };

// What has a body: the robot and its ground.
export const lit = (color) => new MeshLambertMaterial({ color, ...BOTH });

// What is a mark, also lines: as bright from everywhere, and seen through.
export const flat = (color, more) => new MeshBasicMaterial({ color, transparent: true, ...BOTH, ...more });

// Places of a geometry that has room for so many numbers.
export function places(geometry, numbers) {
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(numbers), 3));
  geometry.setAttribute("normal", new BufferAttribute(new Float32Array(geometry.attributes.position.array.length), 3));
  return geometry.attributes.position;
}
