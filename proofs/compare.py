"""Public measures of stability beside ours, on robots of the gallery and on published ones.

`python -m proofs.compare [FILE.csv]` prints two tables, and writes the measures of each posture.

A library of margins gets one polygon from its user: the support polygon of the facet on which the
robot rests on level ground, or the outline of all its contacts seen from above.  Two things are
compared.  *Verdict*: from which tilt on the robot tips, by either polygon (all margins of
proofs/margins.py change their sign in the same place) and by `lutgen.analysis.tilt_limits`, in
`HEADINGS` headings.  *Ranking*: of how many pairs of postures a measure on level ground calls the
wrong one the stabler, if the largest tilt that is safe in every heading decides.
"""

import csv
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from lutgen.analysis import Posture, compare_metrics, even_headings, tilt_limits, tilted
from lutgen.errors import LutgenError
from lutgen.propose import import_urdf
from lutgen.recipe import Recipe, gallery_names, load_recipe
from lutgen.support import support_contact
from lutgen.urdf.read import load_urdf
from lutgen.vector import Floats
from proofs.descriptions import FOLDER
from proofs.margins import MARGINS

HEADINGS, POSTURES, SEED = 72, 60, 1
LEVEL = np.array([[0.0, 0.0, -1.0]])
# deg; beyond it two limits are not the same.
SAME = 0.05
OURS = ("sdg", "tip_angle")
MEASURES = (*OURS, *MARGINS)


@dataclass(frozen=True)
class Asked:
    """What is known of a posture: measures on level ground, and limits (rad) in all headings."""

    params: Floats
    level: dict[str, float]
    polygon: Floats
    outline: Floats
    ours: Floats


def robots() -> Iterator[tuple[str, Recipe]]:
    """Yield the robots: the gallery, descriptions beside the project, and example-robot-data."""
    for name in gallery_names():
        yield name, load_recipe(f"recipe:{name}")
    for path in sorted(FOLDER.glob("*.urdf")) if FOLDER.is_dir() else []:
        yield f"{path.stem} (URDF)", import_urdf(load_urdf(path)).recipe
    try:
        from proofs.robots import data, imported, named

        files = sorted(data().rglob("*.urdf"))
    except (ImportError, SystemExit):
        return
    for path in files:
        try:
            yield f"{named(path)} (URDF)", imported(path)[3].recipe
        except LutgenError:
            continue


def drawn(recipe: Recipe) -> Floats:
    """Return postures (m, k): `home`, or the middle where there is none, and random ones."""
    rng = np.random.default_rng(SEED)
    low = np.array([axis.minimum for axis in recipe.parameters])
    high = np.array([axis.maximum for axis in recipe.parameters])
    rows = low + (high - low) * rng.random((POSTURES if len(low) else 1, len(low)))
    rows[0] = recipe.home_params if recipe.home else 0.5 * (low + high)
    return np.asarray(rows)


def polygon_limits(corners: Floats, headings: Floats) -> Floats:
    """Return the tilt (rad) at which a polygon's margins change their sign, (h,), in body frame."""
    low, high = np.zeros(len(headings)), np.full(len(headings), math.pi / 2)
    for _ in range(40):
        middle = 0.5 * (low + high)
        stands = MARGINS["static_margin"](corners, tilted(middle, headings)) >= 0.0
        low, high = np.where(stands, middle, low), np.where(stands, high, middle)
    return low


def outline(posture: Posture) -> Floats:
    """Return the lowest points of all contacts whose outline from above has no other outside."""
    down = (0.0, 0.0, -1.0)
    contacts = range(len(posture.recipe.contacts))
    points = np.array([support_contact(posture.primitives, k, down) for k in contacts])
    # From above they are counter-clockwise.
    return np.asarray(points[ConvexHull(points[:, :2]).vertices[::-1]])


def asked(recipe: Recipe, params: Floats, headings: Floats) -> Asked | None:
    """Return what is known of a posture, or None where it does not stand on level ground."""
    try:
        posture = Posture(recipe, params)
        ours = compare_metrics(posture, LEVEL)
    except LutgenError:
        return None
    facet = posture.under(LEVEL[0])
    if facet is None or ours.level_status > 0.0:
        return None
    level = {name: ours.level[name] for name in OURS}
    level |= {name: float(rule(facet.points, LEVEL)[0]) for name, rule in MARGINS.items()}
    limits = tilt_limits(recipe, params, headings, "body")
    polygon = polygon_limits(facet.points, headings)
    beside = polygon_limits(outline(posture), headings)
    return Asked(params, level, polygon, beside, np.asarray(limits))


def misranked(found: list[Asked], name: str) -> float:
    """Return the share of pairs of postures that a measure ranks otherwise than their limits."""
    truth = np.array([one.ours.min() for one in found])
    value = np.array([one.level[name] for one in found]) * (-1.0 if name == "sdg" else 1.0)
    first, second = np.triu_indices(len(found), 1)
    apart = np.abs(truth[first] - truth[second]) > math.radians(SAME)
    wrong = (truth[first] - truth[second]) * (value[first] - value[second]) < 0.0
    return float((wrong & apart).sum() / apart.sum()) if apart.any() else math.nan


def share(value: float) -> str:
    """Return a share in per cent, or a dash where there is none."""
    return "-" if math.isnan(value) else f"{100.0 * value:.1f} %"


def verdicts(name: str, found: list[Asked]) -> str:
    """Return the row of verdicts: by how much a polygon promises more or less than there is."""
    cells = [name, str(len(found))]
    for kind in ("polygon", "outline"):
        over = np.degrees(np.array([getattr(one, kind) - one.ours for one in found]))
        for sign in (1.0, -1.0):
            wrong = sign * over[sign * over > SAME]
            cells.append(
                f"{share(len(wrong) / over.size)}, {wrong.max():.1f}" if len(wrong) else "-"
            )
    return f"| {' | '.join(cells)} |"


def rankings(name: str, found: list[Asked]) -> str:
    """Return the row of rankings."""
    cells = [share(misranked(found, measure)) for measure in MEASURES]
    return f"| {' | '.join([name, *cells])} |"


def write(path: Path, all_found: dict[str, tuple[Recipe, list[Asked]]]) -> None:
    """Write a row for each posture that stands on level ground."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["robot", "length_unit", "posture", *MEASURES, "largest_safe_tilt_rad"])
        for name, (recipe, found) in all_found.items():
            for one in found:
                posture = " ".join(f"{value:.9g}" for value in one.params)
                values = [f"{one.level[measure]:.9g}" for measure in MEASURES]
                row = [name, recipe.length_unit, posture, *values, f"{one.ours.min():.9g}"]
                table.writerow(row)


def main() -> None:
    """Ask every robot, print the two tables, and write the measures if a file is named."""
    headings = even_headings(HEADINGS)
    all_found: dict[str, tuple[Recipe, list[Asked]]] = {}
    print("| robot | postures | support polygon: more | less | outline: more | less |")
    for name, recipe in robots():
        found = [one for row in drawn(recipe) if (one := asked(recipe, row, headings)) is not None]
        if found:
            all_found[name] = recipe, found
            print(verdicts(name, found), flush=True)
    print(f"\n| robot | {' | '.join(MEASURES)} |")
    for name, (_, found) in all_found.items():
        if len(found) > 1:
            print(rankings(name, found))
    if sys.argv[1:]:
        write(Path(sys.argv[1]), all_found)


if __name__ == "__main__":
    main()
