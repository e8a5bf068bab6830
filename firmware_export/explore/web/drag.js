// SPDX-License-Identifier: MIT
// Dragging in the 3-D picture: the ground tilts it and seats the robot anew, the body is turned by hand as
// an IMU would see it, anything else moves the camera.
import { Quaternion, Vector3 } from "three";
import { angles, tilted } from "./gravity.js";

const RATE = 0.006; // rad a pixel

export function attachDrag(stage, state) {
  const { canvas } = stage;
  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    const what = event.button === 0 && stage.answer ? stage.hit(event.clientX, event.clientY) : "";
    if (!what) return;
    stage.controls.enabled = false;
    canvas.setPointerCapture(event.pointerId);
    const start = what === "body" ? angles(stage.answer.g) : state.now;
    held = { x: event.clientX, y: event.clientY, what, down: tilted(start.tilt, start.heading) };
    event.stopImmediatePropagation();
  }, true);
  canvas.addEventListener("pointermove", (event) => {
    if (!held) {
      const over = event.buttons || !stage.answer ? "" : stage.hit(event.clientX, event.clientY);
      canvas.style.cursor = over ? "grab" : "move";
      return;
    }
    const dx = (event.clientX - held.x) * RATE, dy = (event.clientY - held.y) * RATE;
    [held.x, held.y] = [event.clientX, event.clientY];
    held.down = nudge(stage, held.down, dx, -dy);
    state.set({ mode: held.what, ...angles(held.down) });
  });
  const drop = () => {
    held = null;
    stage.controls.enabled = true;
  };
  canvas.addEventListener("pointerup", drop);
  canvas.addEventListener("pointercancel", drop);
}

// Turn a direction of gravity towards the screen's right, and away from the reader.
export function nudge(stage, down, right, away) {
  const level = stage.level(), back = new Quaternion().copy(stage.world.quaternion).invert();
  const push = new Vector3(...level.right.map((x, k) => right * x + away * level.away[k])).applyQuaternion(back);
  const moved = new Vector3(...down).add(push).normalize();
  return moved.z < 0.2 ? [moved.x, moved.y, moved.z] : down;
}
