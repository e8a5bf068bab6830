"""The explorer in a real browser: whether its numbers are those of `lutgen eval`, and its time.

python -m proofs.explorer [NAME ...] [--loads 15] [--update]

Opens the page of each robot of the gallery, or of those named, in Chromium without a screen, from a
file.  *Numbers*: random postures and directions of gravity up to `TILT`, asked of the page's worker
and of `lutgen.evaluate`, compared by what the page prints; and what the exported C answers there
and on this machine, bit for bit.  *Time*: of absolem's page, loaded anew many times, and of frames
while all joints and gravity move.  `--update` writes docs/measured/explorer.md.
"""

import argparse
import math
import struct
import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

import lutgen
from firmware_export.explore import answers_of_recipe, page_text
from firmware_export.explore.tables import Answers
from firmware_export.host import Host
from lutgen.channels import evaluate_each
from lutgen.recipe import Recipe, gallery_names
from lutgen.vector import Floats
from proofs.browser import Browser
from proofs.physics.page import MEASURED, page

PAGE = MEASURED / "explorer.md"
STATES, TILT, SEED = 200, math.radians(45.0), 1
CHANNELS = ("status", "sdg", "tip_angle", "height")
# The runtime's codes of a verdict, in the order of the channel.
CODES = {0: 0.0, 4: 1.0, 2: 2.0}
# What the page prints of an angle (deg), and of a length (a part of it).
ANGLE, LENGTH = 0.01, 1e-4
NAN = 0x7FC00000
TIMED, FRAMES = "absolem", 40
WALK = """
const done = arguments[1], frames = arguments[0], { timing, state } = explorer;
timing.script.length = timing.frames.length = 0;
let n = 0;
const step = () => {
  const part = (i) => 0.5 + 0.4 * Math.sin(n / (15 + 5 * i));
  state.set({ q: explorer.scene.parameters.map((p, i) => p.min + (p.max - p.min) * part(i)),
    tilt: 0.2 + 0.1 * Math.sin(n / 9), heading: n / 30 });
  ++n < frames ? requestAnimationFrame(step) : done([timing.script, timing.frames]);
};
requestAnimationFrame(step);
"""


@dataclass(frozen=True)
class Equal:
    """How many of `STATES` the page answers as lutgen does."""

    name: str
    kilobytes: float
    verdicts: int
    tips: int
    lengths: int
    bits: int
    over: int

    def row(self) -> str:
        """Return the row of the table."""
        counts = (self.verdicts, self.tips, self.lengths, self.bits)
        cells = " | ".join(f"{count} of {STATES}" for count in counts)
        return f"| {self.name} | {self.kilobytes:.0f} | {cells} | {self.over} |"


def states(recipe: Recipe, count: int, tilt: float, seed: int) -> tuple[Floats, Floats]:
    """Return random params (m, k) and directions (m, 3) up to a tilt (rad)."""
    rng = np.random.default_rng(seed)
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])
    params = rng.uniform(low, high, (count, len(low)))
    away, heading = rng.uniform(0.0, tilt, count), rng.uniform(0.0, 2.0 * np.pi, count)
    flat = np.sin(away)
    return params, np.stack([flat * np.cos(heading), flat * np.sin(heading), -np.cos(away)], axis=1)


def equal(browser: Browser, recipe: Recipe, held: Answers, size: int) -> Equal:
    """Compare the open page of a robot with lutgen."""
    params, gravity = states(recipe, STATES, TILT, SEED)
    rows = [
        {"q": q.tolist(), "mode": "body", "down": g.tolist()}
        for q, g in zip(params, gravity, strict=True)
    ]
    answers = browser.batch(rows)
    truth = evaluate_each(recipe, params, gravity, CHANNELS)
    exact = [row["exact"] for row in answers]
    verdicts = np.array([CODES[one["status"]] for one in exact]) == truth["status"]
    tips = np.degrees([one["tip"] for one in exact])
    right = np.degrees(truth["tip_angle"])
    lengths = np.ones(STATES, dtype=bool)
    for key in ("sdg", "height"):
        values = np.array([one[key] for one in exact], dtype=float)
        lengths &= np.isclose(values, truth[key], rtol=LENGTH, atol=1e-9, equal_nan=True)
    # The directions went through a unit vector in double precision on the way.
    down = np.array([row["g"] for row in answers])
    _, reading = Host(held.blob).read(params, down)
    bits = [list(struct.unpack("<3I", row.tobytes())) for row in reading]
    same = [
        row["bits"] == [NAN if math.isnan(x) else b for x, b in zip(numbers, one, strict=True)]
        for row, numbers, one in zip(answers, reading.tolist(), bits, strict=True)
    ]
    near = np.abs(tips - right) <= ANGLE
    return Equal(
        recipe.name,
        size / 1000.0,
        int(verdicts.sum()),
        int(near.sum()),
        int(lengths.sum()),
        sum(same),
        int((tips > right + ANGLE).sum()),
    )


def spread(values: list[float]) -> str:
    """Return the least, the median and the largest of some times."""
    return f"{min(values):,.0f} | {median(values):,.0f} | {max(values):,.0f}"


def times(browser: Browser, path: Path, loads: int) -> list[str]:
    """Return the rows of the table of times, ms."""
    browser.driver.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
    asked, shown, busy, script, ticks, frames = [], [], [], [], [], []
    for _ in range(loads):
        browser.open(path)
        # A page from a file gets a process of its own, whose time begins with it.
        busy.append(1000.0 * browser.seconds("TaskDuration"))
        browser.until("explorer.timing.shown > 0")
        asked.append(float(browser.ask("explorer.timing.first")))
        shown.append(float(browser.ask("explorer.timing.shown")))
        before = browser.seconds("ScriptDuration")
        spent, at = browser.driver.execute_async_script(WALK, FRAMES)
        ticks.append(1000.0 * (browser.seconds("ScriptDuration") - before) / len(spent))
        script.append(median(spent))
        frames.append(1000.0 * (len(at) - 1) / (at[-1] - at[0]))
    return [
        f"| first picture asked for, by the clock, ms | {spread(asked)} |",
        f"| first picture made, by the clock, ms | {spread(shown)} |",
        f"| processor's time of the page's thread until then, ms | {spread(busy)} |",
        "| script a frame, by the clock, median of a walk, ms | "
        f"{min(script):.1f} | {median(script):.1f} | {max(script):.1f} |",
        "| script a frame, processor's time, mean of a walk, ms | "
        f"{min(ticks):.1f} | {median(ticks):.1f} | {max(ticks):.1f} |",
        f"| frames a second | {min(frames):.0f} | {median(frames):.0f} | {max(frames):.0f} |",
    ]


def main() -> None:
    """Measure, print, and with --update write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=list(gallery_names()))
    parser.add_argument("--loads", type=int, default=15)
    parser.add_argument("--update", action="store_true")
    asked = parser.parse_args()
    browser = Browser()
    head = [
        "| robot | page, kB | verdict as `lutgen eval` | tip angle | lengths | bits of the C "
        "| says too much |",
        "|---|---|---|---|---|---|---|",
    ]
    try:
        with tempfile.TemporaryDirectory() as folder:
            for name in asked.names:
                recipe = lutgen.load_recipe(f"recipe:{name}")
                held = answers_of_recipe(recipe)
                path = Path(folder) / f"{name}.html"
                size = path.write_text(page_text(recipe, held), encoding="utf-8")
                browser.open(path)
                head.append(equal(browser, recipe, held, size).row())
                print(head[-1], flush=True)
            timed = ["| of so many loads | least | median | largest |", "|---|---|---|---|"]
            if (Path(folder) / f"{TIMED}.html").exists():
                timed += times(browser, Path(folder) / f"{TIMED}.html", asked.loads)
        print(*timed, sep="\n")
    finally:
        browser.close()
    if asked.update:
        text = page(PAGE.read_text(encoding="utf-8"), "numbers", "\n".join(head) + "\n")
        PAGE.write_text(page(text, "times", "\n".join(timed) + "\n"), encoding="utf-8")


if __name__ == "__main__":
    main()
