"""Hand-worked and published values, from the tables in `tests/vectors`."""

import csv
from math import atan, radians, sqrt

import numpy as np
import pytest

import lutgen
from lutgen.analysis import tilted
from lutgen.channels import body_gravity, evaluate_each
from tests.fixtures.places import MAPS, VECTORS

A0 = atan(0.6)
CONVENTIONS = {"P": "plane", "F": "body"}


def rows(name):
    """Rows of a table, its comment lines left out."""
    lines = (VECTORS / name).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def angle(text):
    """Angle (rad) of a cell in deg, where A0 is the paper's nominal elevation."""
    return A0 if text == "A0" else radians(float(text))


def limit(text):
    return None if text == "none" else radians(float(text))


def test_recipe_of_the_papers_robot_gives_its_stability_factor_and_its_height():
    recipe = lutgen.load_recipe(MAPS / "paper_two.toml")

    def read(row, channel):
        params = [[angle(row["alpha_deg"]), angle(row.get("gamma_deg", "A0"))]]
        convention = CONVENTIONS[row.get("convention", "P")]
        down = body_gravity(recipe, params, [0, 0, -1], convention)
        return evaluate_each(recipe, params, down, (channel,))[channel].item()

    for row in rows("paper_sdg.csv"):
        # Half a unit of the last digit of a row, plus what one rounding more can add.
        tolerance = 0.51 * float(row["unit_of_last_digit"])
        assert read(row, "sdg") == pytest.approx(float(row["sdg"]), abs=tolerance), row
    for row in rows("paper_height.csv"):
        # Five decimals are printed: half of the last one.
        assert read(row, "height") == pytest.approx(float(row["height"]), abs=5.1e-6), row


def absolem_feet(row):
    half = np.array([float(row["half_length"]), float(row["half_width"])])
    com = np.array([float(row["com_x"]), float(row["com_y"])])
    corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) * half - com
    return np.column_stack((corners, np.full(4, -float(row["com_height"]))))


def test_the_eight_tip_over_tilts_of_the_absolem_rectangle_equal_the_table():
    # 0.05 deg: the com is printed to 0.1 mm, which is 0.02 deg at this height.
    for row in rows("absolem_rectangle.csv"):
        for heading, angle in (("nose_down", 0), ("left", 90), ("nose_up", 180), ("right", 270)):
            tilts = [float(row[heading]) - 0.05, float(row[heading]) + 0.05]
            g = tilted(np.radians(tilts), radians(angle))
            before, after = lutgen.stability(absolem_feet(row), g)["tip_angle"][0]
            assert before > 0.0 > after, (row["pose"], heading)


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
