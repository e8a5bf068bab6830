// SPDX-License-Identifier: MIT
// The keyboard: arrows tilt gravity as the screen shows it, letters press buttons.
import { angles, tilted } from "./gravity.js";

const PUSH = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1] };

export function attachKeys(state, buttons) {
  addEventListener("keydown", (event) => {
    const typing = /INPUT|SELECT|TEXTAREA/.test(event.target.tagName);
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const push = PUSH[event.key];
    if (push) {
      const step = (event.shiftKey ? 5 : 1) * (Math.PI / 180), { tilt, heading } = state.now;
      const g = tilted(tilt, heading);
      state.set(angles([g[0] + step * push[0], g[1] + step * push[1], g[2]]));
      event.preventDefault();
      return;
    }
    const button = buttons[event.key.toLowerCase()];
    if (button) {
      button();
      event.preventDefault();
    }
  });
}
