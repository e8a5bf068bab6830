"""Hand-worked and published values, from the tables in `tests/vectors`."""

import csv
from math import atan, cos, degrees, radians, sin, sqrt

import numpy as np
import pytest

import lutgen
from tests.fixtures.places import MAPS, VECTORS

RADIUS = sqrt(20.0**2 + 12.0**2)
A0 = atan(0.6)
DOWN = np.array([0.0, 0.0, -1.0])

# Some rows of the paper are beyond the limits of its recipe.
WIDE = (MAPS / "paper_two.toml").read_text(encoding="utf-8").replace("max = 50.0", "max = 90.0")


def rows(name):
    """Rows of a table, its comment lines left out."""
    lines = (VECTORS / name).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def angle(text):
    """Angle (rad) of a cell in deg, where A0 is the paper's nominal elevation."""
    return A0 if text == "A0" else radians(float(text))


def limit(text):
    """Limit (rad) of a cell in deg, None for "none"."""
    return None if text == "none" else radians(float(text))


def paper_wheels(alpha, gamma):
    """Wheels (3, 3) of the paper's robot."""
    elevations = np.array([alpha, gamma, A0])
    azimuths = np.radians([0.0, 120.0, 240.0])
    return RADIUS * np.stack(
        (
            np.cos(elevations) * np.cos(azimuths),
            np.cos(elevations) * np.sin(azimuths),
            -np.sin(elevations),
        ),
        axis=1,
    )


def down_of(wheels, convention):
    """Gravity (3,): "P" across the ground plane of the wheels, "F" along the robot's -z."""
    if convention == "F":
        return DOWN
    normal = np.cross(wheels[1] - wheels[0], wheels[2] - wheels[0])
    return np.asarray(-normal / np.sqrt(normal @ normal))


def tolerance(row):
    """Half a unit of the last digit of a row, plus what one rounding more can add."""
    return 0.51 * float(row["unit_of_last_digit"])


def tilted(heading, tilt):
    """Gravity (3,) with the nose down, the nose up, or over to the left or right by `tilt`."""
    x, y = {"nose_down": (1, 0), "nose_up": (-1, 0), "left": (0, 1), "right": (0, -1)}[heading]
    return np.array([sin(tilt) * x, sin(tilt) * y, -cos(tilt)])


HEADINGS = ("nose_down", "nose_up", "left", "right")


def test_recipe_of_the_papers_robot_gives_its_stability_factor_in_both_conventions():
    recipe = lutgen.parse_recipe(WIDE)
    table = rows("paper_sdg.csv")
    params = np.array([[angle(row["alpha_deg"]), angle(row["gamma_deg"])] for row in table])
    gravity = np.stack(
        [
            down_of(paper_wheels(*pair), row["convention"])
            for pair, row in zip(params, table, strict=True)
        ]
    )
    got = lutgen.evaluate(recipe, params, gravity, channels=("sdg",))["sdg"]
    assert got.shape == (len(table), len(table))
    for value, row in zip(np.diagonal(got), table, strict=True):
        assert value == pytest.approx(float(row["sdg"]), abs=tolerance(row)), row


def test_height_of_the_papers_robot_equals_the_table():
    recipe = lutgen.parse_recipe(WIDE)
    for row in rows("paper_height.csv"):
        alpha = angle(row["alpha_deg"])
        gravity = down_of(paper_wheels(alpha, A0), "P")[None]
        found = lutgen.evaluate(recipe, [[alpha, A0]], gravity, channels=("height",))["height"]
        # Five decimals are printed: half of the last one.
        assert found[0, 0] == pytest.approx(float(row["height"]), abs=5.1e-6)


def absolem_feet(row):
    """Four feet (4, 3) of the Absolem rectangle, relative to the com."""
    half = np.array([float(row["half_length"]), float(row["half_width"])])
    com = np.array([float(row["com_x"]), float(row["com_y"])])
    corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) * half - com
    return np.column_stack((corners, np.full(4, -float(row["com_height"]))))


def tilt_at_limit(feet, heading):
    """Smallest tilt (deg) at which the robot tips, by bisection on the sign of `tip_angle`."""
    low, high = 0.0, radians(89.0)
    while high - low > 1e-9:
        middle = (low + high) / 2.0
        tip_angle = lutgen.stability(feet[None], tilted(heading, middle)[None], ["tip_angle"])
        if tip_angle["tip_angle"][0, 0] < 0.0:
            high = middle
        else:
            low = middle
    return degrees(low)


def test_the_eight_tip_over_tilts_of_the_absolem_rectangle_equal_the_table():
    # 0.05 deg: the com is printed to 0.1 mm, which is 0.02 deg at this height.
    for row in rows("absolem_rectangle.csv"):
        for heading in HEADINGS:
            tilt = tilt_at_limit(absolem_feet(row), heading)
            assert tilt == pytest.approx(float(row[heading]), abs=0.05), (row["pose"], heading)


SOLIDS = {
    "tripod": [[2, 0, -1], [-1, sqrt(3.0), -1], [-1, -sqrt(3.0), -1]],
    "table": [[x, y, -1] for x in (-1, 1) for y in (-1, 1)],
    "cube": [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    "tetrahedron": [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
}


def test_solids_worked_by_hand_have_the_tabled_tip_angle_stability_factor_and_height():
    table = rows("solids.csv")
    assert len(table) == 20
    for row in table:
        contacts = np.array(SOLIDS[row["contacts"]], dtype=np.float64)
        gravity = np.array([float(row[f"gravity_{axis}"]) for axis in "xyz"])
        gravity /= np.sqrt(gravity @ gravity)
        bounds = limit(row["upright"]), limit(row["rock_angle"])
        got = lutgen.stability(
            contacts[None], gravity[None], ["tip_angle", "sdg", "height"], *bounds
        )
        # Three decimals of a degree and nine of a length are printed.
        want = pytest.approx(radians(float(row["tip_angle"])), abs=radians(6e-4))
        assert got["tip_angle"][0, 0] == want, row
        for name in ("sdg", "height"):
            expected = pytest.approx(float(row[name]), abs=1e-8, nan_ok=True)
            assert got[name][0, 0] == expected, (name, row)
