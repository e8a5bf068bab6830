"""The figures of the paper, drawn again."""

from functools import partial
from pathlib import Path

from lutgen import plot
from lutgen.mapping import load_map
from lutgen.paper.model import DOWN, paper_recipe
from lutgen.paper.simulations import MAP, Results
from lutgen.plot import draw_path, draw_steps

UNEVEN = {"alpha": 20.0, "gamma": 40.0}
SLOPE = (-0.3, 0.15, -1.0)
# CSS pixels of an inch of a figure.
PIXELS = 80.0


def draw_figures(folder: Path, results: Results) -> dict[str, int]:
    """Draw all figures as PNG into a folder; return the width (CSS pixels) of each by its stem."""
    stability_map = load_map(folder / MAP)
    one, two, third = paper_recipe("paper_one"), paper_recipe(), results.third
    search = results.second["plane", "search"]
    runs = {"without control": third["fixed"], "with control": third["lagged"]}
    robot, curve = partial(plot.draw, "robot"), partial(plot.draw, "curve", channel="sdg")
    contour = partial(plot.draw, "contour", channel="sdg")
    steps = partial(draw_steps, two, search, DOWN)
    painters = {
        "fig05_support": partial(robot, two, params=UNEVEN, gravity=SLOPE),
        # As printed: at the exact angle |SD_g| would be rounding noise.
        "fig07_robot": partial(robot, one, params={"alpha": 30.964}),
        "fig08_curve": partial(curve, one, convention="plane"),
        "fig09_robot": partial(robot, two, params=UNEVEN, convention="plane"),
        "fig10_surface": partial(plot.draw, "surface", stability_map, channel="sdg"),
        "fig11_map": partial(contour, stability_map),
        "fig11_plane": partial(contour, two, convention="plane"),
        "fig12_steps": partial(steps, (0, 1, 2)),
        "fig13_step": partial(steps, (0,)),
        "fig14_step": partial(steps, (1,)),
        "fig15_step": partial(steps, (2,)),
        "fig15_last": partial(steps, (5,)),
        "fig16_17_path": partial(draw_path, two, runs),
    }
    widths = {}
    for stem, paint in painters.items():
        figure = paint()
        plot.save(figure, folder / f"{stem}.png")
        widths[stem] = round(PIXELS * figure.get_figwidth())
    return widths
