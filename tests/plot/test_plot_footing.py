"""The figure of feet on uneven ground shows the region and the forces that it is given."""

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


def footing(**changes):
    return Footing(**(vars(FEET) | changes))


def test_the_region_is_filled_in_one_scale_with_units_and_forces_if_it_holds():
    found = FEET.equilibrium()
    figure = draw_footing(FEET, found)
    (axes,) = figure.axes
    (filled,) = (part for part in axes.patches if isinstance(part, Polygon))
    np.testing.assert_allclose(filled.get_xy()[:-1], found.region)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (cm)", "y (cm)")
    box = axes.get_window_extent()
    scales = [box.width / np.ptp(axes.get_xlim()), box.height / np.ptp(axes.get_ylim())]
    assert scales == pytest.approx([scales[0]] * 2, rel=1e-6)
    assert figure.texts[0].get_text().startswith("Holds, margin ")
    names = [text.get_text() for text in axes.texts if isinstance(text, Annotation)]
    assert {"front", "rear left", "rear right"} <= set(names)
    assert names.count("") >= 2


def test_the_title_says_if_it_does_not_hold_and_there_are_no_forces():
    tips = footing(com=np.array([50.0, 0.0, 40.0]))
    figure = draw_footing(tips, tips.equilibrium())
    assert figure.texts[0].get_text() == "Does not hold, margin \N{MINUS SIGN}20 cm"
    assert "" not in [text.get_text() for text in figure.axes[0].texts]
    nowhere = footing(friction=np.zeros(3), gravity_dir=np.array([0.3, 0.0, -1.0]))
    assert draw_footing(nowhere, nowhere.equilibrium()).texts[0].get_text() == "Does not hold"


def test_lines_points_and_open_regions_stay_in_the_picture():
    down = {"friction": np.full(2, 0.5), "names": ("a", "b")}
    walls = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    between = footing(points=10.0 * -walls, normals=walls, **down)
    found = between.equilibrium()
    assert found.is_open
    (axes,) = draw_footing(between, found).axes
    assert np.abs(axes.get_xlim()).max() < 100.0
    one = footing(
        points=np.zeros((1, 3)),
        normals=np.array([[0.0, 1.0, 0.0]]),
        friction=np.array([0.0]),
        names=("a",),
        com=np.zeros(3),
        gravity_dir=np.array([0.0, -1.0, 0.0]),
    )
    (axes,) = draw_footing(one, one.equilibrium()).axes
    assert axes.get_ylabel() == "left (cm)"
    assert math.isfinite(np.ptp(axes.get_ylim()))
