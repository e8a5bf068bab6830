// SPDX-License-Identifier: MIT
// The verdict bar: exact values beside what the exported C answers, and one sentence for readers of screens.
import { STATUS } from "./engine.js";
import { degrees, lengthOf, pair, tipText, VERDICT } from "./words.js";

const CLASS = { 0: "stands", 4: "rocks", 2: "tips" };

export class Verdict {
  constructor(root, scene) {
    this.scene = scene;
    this.at = (name) => root.querySelector(`[data-is="${name}"]`);
    this.root = root;
  }

  show(answer, now) {
    const { exact, exported, slope } = answer, { scene } = this;
    const slides = Math.tan(slope) > now.mu;
    const verdict = VERDICT[exact.status], safe = exported.status === 0 || exported.status === 4;
    const put = (name, text) => {
      const cell = this.at(name);
      if (cell.textContent !== text) cell.textContent = text;
    };
    this.root.dataset.verdict = CLASS[exact.status];
    put("verdict", verdict);
    put("status-exact", verdict);
    put("status", STATUS[exported.status]);
    this.at("status").dataset.verdict = CLASS[exported.status] || "tips";
    put("tip-exact", tipText(exact.tip));
    put("tip-exported", tipText(exported.tip));
    put("sdg-exact", lengthOf(exact.sdg, scene.unit));
    put("sdg-exported", lengthOf(exported.sdg, scene.unit));
    put("height-exact", lengthOf(exact.height, scene.unit));
    put("height-exported", lengthOf(exported.height, scene.unit));
    put("over-exact", pair(scene, exact.over));
    put("over-exported", pair(scene, exported.over));
    const slope_text = Number.isFinite(slope) ? `${degrees(slope, 1)} ${slides ? "slides" : "holds"}` : "–";
    put("slope", slope_text);
    this.at("slope").dataset.verdict = slides ? "rocks" : "";
    const agree = (exact.status !== 2) === safe;
    put("agree", agree ? "" : safe ? "the export is falsely safe here" : "the export is on the safe side here");
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      this.at("spoken").textContent = `The robot ${verdict}, ${tipText(exact.tip, 1)} from tipping over ${pair(scene, exact.over)}. ` +
        `The exported C answers ${STATUS[exported.status]}, ${tipText(exported.tip, 1)}.`;
    }, 600);
  }
}
