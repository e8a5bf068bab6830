"""The figures of the paper, drawn again.

Owns which figure shows what; each painter returns a matplotlib figure from `lutgen.plot`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from lutgen import plot
from lutgen.mapping import load_map
from lutgen.paper.robot import NOMINAL_DEG
from lutgen.paper.rough import Third
from lutgen.paper.simulations import LEVEL, First, MapTime, Second
from lutgen.plot import draw_path, draw_steps

__all__ = ["Picture", "draw_pictures"]

RESOLUTION = 200
UNEVEN = {"alpha": 20.0, "gamma": 40.0}
SLOPE = (-0.3, 0.15, -1.0)


@dataclass(frozen=True)
class Picture:
    """A file, the paper's number for it, what it shows, and its width on a page in CSS pixels."""

    path: Path
    number: str
    caption: str
    width: int


def draw_pictures(
    folder: Path, first: First, second: Second, swept: MapTime, third: Third
) -> dict[str, Picture]:
    """Draw all figures as PNG into a folder, and return them by the stem of their file."""
    stability_map = load_map(swept.path)
    one, two = first.recipe, second.recipe
    search = second.found["plane", "search"]
    pictures: dict[str, Picture] = {}

    def add(stem: str, number: str, caption: str, paint: Callable[[], Any]) -> None:
        figure = paint()
        path = folder / f"{stem}.png"
        plot.save(figure, path, dpi=RESOLUTION)
        pictures[stem] = Picture(path, number, caption, round(96.0 * figure.get_figwidth() * 1.15))

    add(
        "fig05_support",
        "Figs 4, 5",
        "the free-body diagram: gravity's ray through the centre of mass, the support polygon, its "
        "centre s, the pierced point D_g and |SD_g|",
        lambda: plot.draw("robot", two, params=UNEVEN, gravity=SLOPE),
    )
    add(
        "fig07_robot",
        "Fig 7",
        "the robot of simulation 1 at its nominal shape, P1 variable",
        lambda: plot.draw("robot", one, params={"alpha": NOMINAL_DEG}),
    )
    add(
        "fig08_curve",
        "Fig 8",
        "|SD_g| and |OC| over alpha, standing on a level plane",
        lambda: plot.draw("curve", one, convention="plane"),
    )
    add(
        "fig09_robot",
        "Fig 9",
        "the robot of simulation 2, P1 and P2 variable, here at 20 and 40 deg on a level plane",
        lambda: plot.draw("robot", two, params=UNEVEN, convention="plane"),
    )
    add(
        "fig10_surface",
        "Fig 10",
        "the stability map of 50 x 50 nodes in 3-D, gravity along the body's z axis",
        lambda: plot.draw("surface", stability_map),
    )
    add(
        "fig11_map",
        "Fig 11",
        "the same map in 2-D",
        lambda: plot.draw("contour", stability_map),
    )
    add(
        "fig11_plane",
        "Fig 11",
        "the same robot standing on a level plane, so that its body turns with its shape",
        lambda: plot.draw("contour", two, convention="plane"),
    )
    add(
        "fig12_steps",
        "Fig 12",
        "steps 1 to 3 of the searching algorithm: nodes and best nodes",
        lambda: draw_steps(two, search, LEVEL, (0, 1, 2)),
    )
    for step in range(3):
        add(
            f"fig{13 + step}_step",
            f"Fig {13 + step}",
            f"step {step + 1} of the searching algorithm",
            partial(draw_steps, two, search, LEVEL, (step,)),
        )
    add(
        "fig15_last",
        "after Fig 15",
        "step 6, which the paper gives as numbers only",
        lambda: draw_steps(two, search, LEVEL, (5,)),
    )
    add(
        "fig16_17_path",
        "Figs 16, 17",
        "the path of Eqs 30 to 33 without and with control; where the robot tips over in red",
        lambda: draw_path(
            third.recipe, {"without control": third.fixed, "with control": third.lagged}
        ),
    )
    return pictures
