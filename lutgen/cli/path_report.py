"""What `lutgen path` says: a table of a run, the JSON of all runs, and the text."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lutgen.recipe import Recipe
    from lutgen.search import Drive

    Columns = dict[str, NDArray[np.float64]]

PAPER = "paper"


def _columns(recipe: "Recipe", params: "NDArray[np.float64]", ending: str = "") -> "Columns":
    """Return the parameters in their display units, named with them."""
    import numpy as np

    columns = {}
    for p, values in zip(recipe.parameters, params.T, strict=True):
        unit = "" if p.display_unit == "1" else f"_{p.display_unit}"
        columns[f"{p.name}{ending}{unit}"] = (
            np.degrees(values) if p.display_unit == "deg" else values
        )
    return columns


def table(recipe: "Recipe", run: "Drive") -> dict[str, Any]:
    """Return what `-o` writes: the columns of a run by name, each (p,)."""
    import numpy as np

    columns: dict[str, Any] = dict(zip("xyz", run.path.position.T, strict=True))
    columns["heading_deg"] = np.degrees(run.heading)
    columns |= _columns(recipe, run.params)
    if (run.wanted != run.params).any():
        columns |= _columns(recipe, run.wanted, "_wanted")
    columns |= {f"gravity_{axis}": run.gravity_body[:, i] for i, axis in enumerate("xyz")}
    columns |= {
        "sdg": run.channels["sdg"],
        "height": run.channels["height"],
        "tip_angle_deg": np.degrees(run.channels["tip_angle"]),
        "margin": run.channels["margin"],
        "tips": run.tips,
    }
    return columns


def report(
    recipe: "Recipe", runs: Mapping[str, "Drive"], settings: Mapping[str, Any]
) -> dict[str, Any]:
    """Return what `--json` prints; null where a number is not finite."""
    import numpy as np

    ground = next(iter(runs.values())).path
    return {
        "robot": recipe.name,
        "length_unit": recipe.length_unit,
        **settings,
        "points": len(ground.position),
        "length": float(ground.distance[-1]),
        "path": {axis: ground.position[:, i].tolist() for i, axis in enumerate("xyz")},
        "runs": [
            {
                "name": name,
                "share": run.share,
                "tips_at": np.flatnonzero(run.tips).tolist(),
                "least_tip_angle_deg": math.degrees(run.channels["tip_angle"].min()),
                "least_at": int(run.channels["tip_angle"].argmin()),
                "evaluations": run.evaluations,
                "heading_deg": np.degrees(run.heading).tolist(),
                "turn_deg": np.degrees(run.turn).tolist(),
                "params": {k: v.tolist() for k, v in _columns(recipe, run.params).items()},
                "wanted": {k: v.tolist() for k, v in _columns(recipe, run.wanted).items()},
                "gravity_body": run.gravity_body.tolist(),
                "tip_angle_deg": np.degrees(run.channels["tip_angle"]).tolist(),
                **{
                    channel: [_finite(value) for value in run.channels[channel]]
                    for channel in ("sdg", "height", "margin")
                },
            }
            for name, run in runs.items()
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def lines(recipe: "Recipe", terrain: str, runs: Mapping[str, "Drive"]) -> Sequence[str]:
    """Return the report as text."""
    unit = "" if recipe.length_unit == "1" else f" {recipe.length_unit}"
    where = "the paper's path" if terrain == PAPER else terrain
    ground = next(iter(runs.values())).path
    count = len(ground.position)
    text = [f"{recipe.name} on {where}: {count} points, length {ground.distance[-1]:.6g}{unit}"]
    width = max(map(len, runs))
    for name, run in runs.items():
        angle = run.channels["tip_angle"]
        least = int(angle.argmin())
        at = ", ".join(f"{value:.4g}" for value in ground.position[least])
        text.append(
            f"{name:<{width}}  tips over at {int(run.tips.sum())} points "
            f"({100.0 * run.share:.3g} %), least tip angle {math.degrees(angle[least]):.4g} deg at "
            f"point {least} ({at})"
        )
    return text
