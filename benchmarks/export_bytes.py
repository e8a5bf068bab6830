"""Bytes of paper_two's exports against what a user would otherwise take.

`python -m benchmarks.export_bytes` prints a markdown table: bytes at the same largest error of
|SD_g|, and largest error at the same bytes.  Needs the extra `bench` (zfpy).
"""

import sys
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

from benchmarks.rivals import RIVALS, Points, Result
from firmware_export.certify.answers import device
from firmware_export.choose import Goal, Trials, choose
from firmware_export.codecs import usable
from firmware_export.model.exact import Model
from firmware_export.model.sample import Sample, biased, uniform
from firmware_export.quantity import ErrorBound
from lutgen.errors import ExportError
from lutgen.recipe.recipe import load_recipe
from targets.marks import markdown

RECIPE = Path(__file__).parents[1] / "maps" / "paper_two.toml"
CHANNELS = ("sdg", "tip_angle", "height")
ERRORS = (5.0, 2.5, 1.0)
SIZES = ((1400, "1.4 kB"), (16 << 10, "16 KiB"), (64 << 10, "64 KiB"))
# Half of them uniform, half beside the tip-over boundary and on the rims of box and chart.
POINTS = 500_000
# Beyond the seeds of choices and certificates.
SEED = 2001
# What the largest exports are tried for, percent.
FINER = (0.1, 0.01)


def points_of(sample: Sample, model: Model) -> Points:
    """Return the standing points of a sample as rivals take them."""
    exact = model.exact(*sample)
    standing = exact.tip_angle >= 0.0
    params = np.repeat(sample.params[:, None], standing.shape[1], axis=1)[standing]
    gravity = sample.gravity[standing]
    u, v = (gravity[:, axis] / -gravity[:, 2] / model.chart_limit for axis in (0, 1))
    t = (params - model.lower) / (model.upper - model.lower)
    place = np.column_stack([t, (v + 1.0) / 2.0, (u + 1.0) / 2.0])
    # Single precision may put a point of the rim a hair beyond it.
    return Points(np.clip(place, 0.0, 1.0), exact.sdg[standing])


def ours(model: Model, sample: Sample, span: float) -> dict[str, list[Result]]:
    """Measure what each codec tried on the common sample.

    The tip angle is always held, and so is the height; where the guard says "tips" there is no
    |SD_g| to compare.
    """
    results: dict[str, list[Result]] = {}
    for codec in usable(model, "float"):
        trials = Trials(model, "paper_two", CHANNELS, "float")
        for percent in (*ERRORS, *FINER):
            with suppress(ExportError):
                choose(trials, [codec], Goal(None, ErrorBound(percent, relative=True)))
        found = results[f"**{codec.name}**, with verdict and height"] = []
        for one in filter(None, trials.tried.values()):
            off = device(one.export).measure(sample).errors("sdg").max()
            found.append(Result(one.total, float(100.0 * off / span), one.label))
    return results


def cell_bytes(results: list[Result], percent: float) -> str:
    """Return the fewest bytes for an error, or the best that there is."""
    good = [one for one in results if one.error <= percent]
    if good:
        best = min(good)
        return f"{best.bytes:,} ({best.label})"
    best = min(results, key=lambda one: one.error)
    return f"- (best: {best.error:.2g} % in {best.bytes:,})"


def cell_error(results: list[Result], size: int) -> str:
    """Return the least error in a number of bytes."""
    fitting = [one.error for one in results if one.bytes <= size]
    return f"{min(fitting):.2g} %" if fitting else "-"


def table(results: dict[str, list[Result]]) -> str:
    """Return the markdown table."""
    heads = [f"bytes at {percent:g} %" for percent in ERRORS] + [name for _, name in SIZES]
    lines = []
    for name, found in results.items():
        cells = [cell_bytes(found, percent) for percent in ERRORS]
        cells += [cell_error(found, size) for size, _ in SIZES]
        lines.append([name, *cells])
    return markdown(f"| | {' | '.join(heads)} |", lines)


def main() -> str:
    """Measure everything; return the table."""
    begin = time.perf_counter()
    model = Model(load_recipe(RECIPE))
    both = (part(model, POINTS // 2, SEED) for part in (uniform, biased))
    sample = Sample(*map(np.concatenate, zip(*both, strict=True)))
    points = points_of(sample, model)
    results = ours(model, sample, float(np.ptp(points.sdg)))
    for rival in RIVALS:
        results |= rival(model, points)
    text = table(results)
    standing = len(points.sdg)
    note = (
        f"Largest error of |SD_g| in percent of its range, on {standing:,} standing points of "
        f"{sample.points:,}.  Only ours hold the verdict and the height as well."
    )
    text += f"\n\n{note}"
    print(text)
    print(f"took {time.perf_counter() - begin:.0f} s", file=sys.stderr)
    return text


if __name__ == "__main__":
    main()
