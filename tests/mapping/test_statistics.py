"""Numbers about a whole map."""

import math
from pathlib import Path

import numpy as np
import pytest

import lutgen
from lutgen.mapping.map import StabilityMap
from lutgen.mapping.statistics import share_that_tips, value_range
from tests.fixtures.recipes import feet, rigid, without_limits

TETRAHEDRON = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
SQUARE = [(1, 1, -1), (-1, 1, -1), (-1, -1, -1), (1, -1, -1)]


def swept(folder: Path, points: list[tuple[float, ...]], **sweep: object) -> StabilityMap:
    """Return the map of a stool."""
    lutgen.sweep(lutgen.parse_recipe(rigid(feet(points), **sweep)), folder / "a.h5")
    return lutgen.load_map(folder / "a.h5")


def test_a_range_leaves_out_what_is_not_finite() -> None:
    values = np.array([[np.nan, 2.0], [-np.inf, -1.5]], np.float32)
    assert value_range(values) == (-1.5, 2.0)


def test_a_range_of_nothing_is_none() -> None:
    assert value_range(np.full((2, 2), np.nan, np.float32)) == (None, None)


@pytest.mark.parametrize("channels", [("tip_angle",), ("sdg",), ("height",), ("sdg", "tip_angle")])
def test_a_square_stool_tips_in_five_sixths_of_all_directions(
    tmp_path: Path, channels: tuple[str, ...]
) -> None:
    # Its standing region is one face of the cube map, seams included.
    stool = swept(tmp_path, SQUARE, chart="sphere", nodes=101, channels=channels)
    share = share_that_tips(stool)
    # Half a node around the face, which is 1/100 of its side, four times, counts as standing.
    assert share == pytest.approx(5.0 / 6.0, abs=1.0 / 6.0 * 4 / 100)
    # A mere count of nodes sees more of the crowded corners; it must not be what is returned.
    assert share is not None


def test_the_share_weighs_nodes_by_their_solid_angle(tmp_path: Path) -> None:
    # The cone of 60 deg; the stool stands where |u|, |v| < 1, which is 1/6 of the sphere.
    stool = swept(tmp_path, SQUARE, nodes=201, max_tilt=60.0)
    t = math.tan(math.radians(60.0))
    whole = 4.0 * math.atan(t * t / math.sqrt(1.0 + 2.0 * t * t))
    want = 1.0 - (4.0 * math.pi / 6.0) / whole
    # The boundary is off by at most half a cell, 0.0087 of u, along four sides of length 2.
    assert share_that_tips(stool) == pytest.approx(want, abs=0.5 * 4 * 2 * 0.0087 / whole)
    count = (stool.channel("tip_angle") < 0.0).mean()
    assert abs(count - want) > 0.05


def test_a_robot_that_cannot_tip_has_the_share_zero(tmp_path: Path) -> None:
    recipe = without_limits(rigid(feet(TETRAHEDRON), chart="sphere", nodes=5))
    lutgen.sweep(recipe, tmp_path / "a.h5")
    assert share_that_tips(lutgen.load_map(tmp_path / "a.h5")) == 0.0


def test_a_map_that_does_not_know_what_tips_has_no_share(tmp_path: Path) -> None:
    assert share_that_tips(swept(tmp_path, SQUARE, channels=("facet",))) is None
