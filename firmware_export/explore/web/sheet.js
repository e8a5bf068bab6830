// SPDX-License-Identifier: MIT
// What disc and map share: a field of the worker, and its picture, made anew with either or the colours.
export class Sheet {
  constructor(canvas, scene, state) {
    Object.assign(this, { canvas, scene, state });
  }

  take(message) {
    this.data = message;
    this.redraw();
  }

  recolour(colours) {
    this.colours = colours;
    this.redraw();
  }

  redraw() {
    this.picture = null;
    this.dirty = true;
  }
}
