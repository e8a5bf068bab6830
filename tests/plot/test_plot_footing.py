"""The figure of feet on uneven ground shows the region, the cones and forces that it is given."""

import math

import numpy as np
import pytest
from matplotlib.patches import Polygon
from matplotlib.text import Annotation

from lutgen.analysis import Footing
from lutgen.plot import draw_footing

FEET = Footing(
    "table",
    "cm",
    ("front", "rear_left", "rear_right"),
    points=np.array([[30.0, 0.0, 10.0], [-20.0, 20.0, 0.0], [-20.0, -20.0, 0.0]]),
    normals=np.tile([0.0, 0.0, 1.0], (3, 1)),
    friction=np.full(3, 0.5),
    com=np.array([5.0, 0.0, 40.0]),
    gravity_dir=np.array([0.0, 0.0, -1.0]),
)


def footing(**changes: object) -> Footing:
    return Footing(**(vars(FEET) | changes))  # type: ignore[arg-type]


def test_the_region_is_filled_seen_along_gravity_in_one_scale_with_units() -> None:
    found = FEET.equilibrium()
    figure = draw_footing(FEET, found)
    side, above = figure.axes
    (filled,) = (part for part in above.patches if isinstance(part, Polygon))
    np.testing.assert_allclose(filled.get_xy()[:-1], found.region)
    assert (side.get_ylabel(), above.get_xlabel(), above.get_ylabel()) == (
        "z (cm)",
        "x (cm)",
        "y (cm)",
    )
    boxes = [axes.get_window_extent() for axes in (side, above)]
    scales = [
        part / np.ptp(limits)
        for box, axes in zip(boxes, (side, above), strict=True)
        for part, limits in ((box.width, axes.get_xlim()), (box.height, axes.get_ylim()))
    ]
    assert scales == pytest.approx([scales[0]] * 4, rel=1e-6)
    assert figure.get_suptitle().startswith("table: holds, margin ")


def test_a_cone_is_as_wide_as_its_friction() -> None:
    side, _ = draw_footing(FEET, FEET.equilibrium()).axes
    cones = [part.get_xy() for part in side.patches if isinstance(part, Polygon)]
    assert len(cones) == 3
    for cone, foot in zip(cones, FEET.points, strict=True):
        across, up = (cone - foot[[0, 2]]).T
        above = up > 1e-9
        assert np.abs(across[above] / up[above]).max() == pytest.approx(0.5, rel=2e-3)


def test_forces_are_drawn_where_it_holds_and_the_title_says_where_not() -> None:
    def arrows(one: Footing) -> int:
        figure = draw_footing(one, one.equilibrium())
        return sum(
            isinstance(text, Annotation) and not text.get_text()
            for axes in figure.axes
            for text in axes.texts
        )

    assert arrows(FEET) >= 3
    tips = footing(com=np.array([50.0, 0.0, 40.0]))
    assert arrows(tips) == 0
    title = draw_footing(tips, tips.equilibrium()).get_suptitle()
    assert title.startswith("table: does not hold, margin \N{MINUS SIGN}20.")
    nowhere = footing(friction=np.zeros(3), gravity_dir=np.array([0.3, 0.0, -1.0]))
    assert draw_footing(nowhere, nowhere.equilibrium()).get_suptitle() == "table: does not hold"


def test_lines_points_and_open_regions_stay_in_the_picture() -> None:
    down = {"friction": np.full(2, 0.5), "names": ("a", "b")}
    walls = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    between = footing(points=10.0 * -walls, normals=walls, **down)
    found = between.equilibrium()
    assert found.is_open
    side, _ = draw_footing(between, found).axes
    assert np.abs(side.get_xlim()).max() < 100.0
    one = footing(
        points=np.zeros((1, 3)),
        normals=np.array([[0.0, 1.0, 0.0]]),
        friction=np.array([0.0]),
        names=("a",),
        com=np.zeros(3),
        gravity_dir=np.array([0.0, -1.0, 0.0]),
    )
    figure = draw_footing(one, one.equilibrium())
    assert figure.axes[1].get_ylabel() == "left (cm)"
    assert math.isfinite(np.ptp(figure.axes[1].get_ylim()))
