"""Hand-worked and published values, from the tables in `tests/vectors`."""

import csv
from math import asin, atan, cos, degrees, pi, radians, sin, sqrt, tan

import numpy as np
import pytest

import lutgen
from tests.fixtures.places import VECTORS
from tests.oracles import points as oracle
from tests.oracles.points import Floats

RADIUS = sqrt(20.0**2 + 12.0**2)
A0 = atan(0.6)
DOWN = np.array([0.0, 0.0, -1.0])

PAPER = """
[robot]
name = "paper_two"
length_unit = "1"
[[robot.parameter]]
name = "alpha"
min = 0.0
max = 60.0
unit = "deg"
[[robot.parameter]]
name = "gamma"
min = 0.0
max = 60.0
unit = "deg"
[[robot.link]]
name = "leg1"
parent = "body"
joint = { type = "revolute", axis = [0, 1, 0], parameter = "alpha" }
[[robot.link]]
name = "leg2"
parent = "body"
rpy = [0, 0, 120]
joint = { type = "revolute", axis = [0, 1, 0], parameter = "gamma" }
[[robot.contact]]
name = "P1"
link = "leg1"
position = [23.323807579381203, 0, 0]
[[robot.contact]]
name = "P2"
link = "leg2"
position = [23.323807579381203, 0, 0]
[[robot.contact]]
name = "P3"
link = "body"
position = [-10.0, -17.320508075688775, -12.0]
[sweep]
samples = { alpha = 7, gamma = 7 }
channels = ["sdg", "tip_angle", "height"]
[sweep.gravity]
chart = "cone"
max_tilt = 60.0
nodes = 5
"""

# Numbers of the robot facts: chassis, battery, top box, antenna, laser, camera, two tracks and four
# flippers whose com is 0.08 out from the hinge; here they all turn together, 0 = straight up.
ABSOLEM_PARTS = (
    ("base", 6.746, (-0.034, 0.0, 0.142)),
    ("battery", 3.18, (-0.2836, -0.0221, 0.1132)),
    ("top_box", 0.24, (0.0477, -0.0557, 0.226)),
    ("antenna", 0.56, (-0.394, 0.0992, 0.1843)),
    ("laser", 1.1, (0.2502, 0.0, 0.1807)),
    ("camera", 2.414, (0.050, -0.0574, 0.3142)),
    ("left_track", 6.06, (0.0, 0.1985, 0.0141)),
    ("right_track", 6.06, (0.0, -0.1985, 0.0141)),
)
HINGE = (0.25, 0.272, 0.0195)
WHEEL = (0.25, 0.1985, 0.01855)


def rows(name: str) -> list[dict[str, str]]:
    """Rows of a table, its comment lines left out."""
    lines = (VECTORS / name).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def angle(text: str) -> float:
    """Angle (rad) of a cell in deg, where A0 is the paper's nominal elevation."""
    return A0 if text == "A0" else radians(float(text))


def limit(text: str) -> float | None:
    """Limit (rad) of a cell in deg, None for "none"."""
    return None if text == "none" else radians(float(text))


def paper_wheels(alpha: float, gamma: float) -> Floats:
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


def down_of(wheels: Floats, convention: str) -> Floats:
    """Gravity (3,): "P" across the ground plane of the wheels, "F" along the robot's -z."""
    if convention == "F":
        return DOWN
    normal = oracle.cross(wheels[1] - wheels[0], wheels[2] - wheels[0])
    return np.asarray(-normal / np.sqrt(normal @ normal))


def tolerance(row: dict[str, str]) -> float:
    """Half a unit of the last digit of a row, plus what one rounding more can add."""
    return 0.51 * float(row["unit_of_last_digit"])


def tilted(heading: str, tilt: float) -> Floats:
    """Gravity (3,) with the nose down, the nose up, or over to the left or right by `tilt`."""
    x, y = {"nose_down": (1, 0), "nose_up": (-1, 0), "left": (0, 1), "right": (0, -1)}[heading]
    return np.array([sin(tilt) * x, sin(tilt) * y, -cos(tilt)])


HEADINGS = ("nose_down", "nose_up", "left", "right")


def test_oracle_gives_the_papers_stability_factor_in_both_conventions() -> None:
    for row in rows("paper_sdg.csv"):
        wheels = paper_wheels(angle(row["alpha_deg"]), angle(row["gamma_deg"]))
        verdict = oracle.judge(wheels, down_of(wheels, row["convention"]))
        assert verdict.pierced[0][0] == pytest.approx(float(row["sdg"]), abs=tolerance(row)), row


def test_stability_gives_the_papers_stability_factor_in_both_conventions() -> None:
    table = rows("paper_sdg.csv")
    assert len(table) == 42
    for row in table:
        wheels = paper_wheels(angle(row["alpha_deg"]), angle(row["gamma_deg"]))
        got = lutgen.stability(wheels[None], down_of(wheels, row["convention"])[None], ["sdg"])
        assert got["sdg"].shape == (1, 1)
        assert got["sdg"][0, 0] == pytest.approx(float(row["sdg"]), abs=tolerance(row)), row


def test_recipe_of_the_papers_robot_gives_its_stability_factor_in_both_conventions() -> None:
    recipe = lutgen.parse_recipe(PAPER)
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


def test_height_of_the_papers_robot_equals_the_table() -> None:
    recipe = lutgen.parse_recipe(PAPER)
    for row in rows("paper_height.csv"):
        alpha = angle(row["alpha_deg"])
        gravity = down_of(paper_wheels(alpha, A0), "P")[None]
        of_points = lutgen.stability(paper_wheels(alpha, A0)[None], gravity, ["height"])["height"]
        of_recipe = lutgen.evaluate(recipe, [[alpha, A0]], gravity, channels=("height",))["height"]
        # Five decimals are printed: half of the last one.
        assert of_points[0, 0] == pytest.approx(float(row["height"]), abs=5.1e-6)
        assert of_recipe[0, 0] == pytest.approx(float(row["height"]), abs=5.1e-6)


def absolem_feet(row: dict[str, str]) -> Floats:
    """Four feet (4, 3) of the Absolem rectangle, relative to the com."""
    half = np.array([float(row["half_length"]), float(row["half_width"])])
    com = np.array([float(row["com_x"]), float(row["com_y"])])
    corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) * half - com
    return np.column_stack((corners, np.full(4, -float(row["com_height"]))))


def tilt_at_limit(feet: Floats, heading: str) -> float:
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


def test_the_eight_tip_over_tilts_of_the_absolem_rectangle_equal_the_table() -> None:
    # 0.05 deg: the com is printed to 0.1 mm, which is 0.02 deg at this height.
    for row in rows("absolem_rectangle.csv"):
        for heading in HEADINGS:
            tilt = tilt_at_limit(absolem_feet(row), heading)
            assert tilt == pytest.approx(float(row[heading]), abs=0.05), (row["pose"], heading)


def test_tip_angle_of_the_level_absolem_is_its_smallest_tip_over_tilt() -> None:
    for row in rows("absolem_rectangle.csv"):
        got = lutgen.stability(absolem_feet(row)[None], DOWN[None], ["tip_angle"])["tip_angle"]
        least = min(float(row[heading]) for heading in HEADINGS)
        assert degrees(got[0, 0]) == pytest.approx(least, abs=0.05)


def absolem_recipe(contacts: str) -> str:
    """Recipe of the Absolem with all flippers turned together by `flippers`, 0 = straight up."""
    text = """
[robot]
name = "absolem"
length_unit = "m"
upright = 90.0
rock_angle = 30.0
[[robot.parameter]]
name = "flippers"
min = -180.0
max = 180.0
unit = "deg"
"""
    for name, mass, com in ABSOLEM_PARTS:
        text += (
            f'[[robot.link]]\nname = "{name}"\nparent = "body"\nmass = {mass}\ncom = {list(com)}\n'
        )
    for front, x in (("front", 1.0), ("rear", -1.0)):
        for side, y in (("left", 1.0), ("right", -1.0)):
            text += (
                f'[[robot.link]]\nname = "{front}_{side}"\nparent = "body"\n'
                f"origin = {[HINGE[0] * x, HINGE[1] * y, HINGE[2]]}\n"
                'joint = { type = "revolute", axis = [0, 1, 0], parameter = "flippers", '
                f"scale = {x} }}\nmass = 0.75\ncom = [0, 0, 0.08]\n"
            )
    return (
        text
        + contacts
        + (
            '[sweep]\nsamples = { flippers = 5 }\nchannels = ["tip_angle"]\n'
            '[sweep.gravity]\nchart = "cone"\nmax_tilt = 60.0\nnodes = 5\n'
        )
    )


def body_contacts(half_length: float, half_width: float, z: float, wheel: str = "") -> str:
    """Four contacts on the body at the corners of a level rectangle."""
    return "".join(
        f'[[robot.contact]]\nname = "corner{number}"\nlink = "body"\n'
        f"position = {[half_length * x, half_width * y, z]}\n{wheel}\n"
        for number, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1)))
    )


def flipper_contacts() -> str:
    """Root and tip wheels of the four flippers."""
    return "".join(
        f'[[robot.contact]]\nname = "{link}_{place}"\nlink = "{link}"\n'
        f"position = [0, 0, {out}]\nradius = {radius}\naxis = [0, 1, 0]\n"
        for link in ("front_left", "front_right", "rear_left", "rear_right")
        for place, out, radius in (("root", 0.0, 0.089), ("tip", 0.33, 0.029))
    )


def test_com_of_the_absolem_recipe_equals_the_table_to_a_tenth_of_a_millimetre() -> None:
    recipe = lutgen.parse_recipe(absolem_recipe(body_contacts(0.25, 0.247, -0.07045)))
    # Front flippers turn forwards and rear flippers backwards; 10.64 deg below level.
    _, com = lutgen.postures(recipe, np.radians([[0.0], [90.0 + 10.64]]))
    for place, row in zip(com, rows("absolem_rectangle.csv"), strict=True):
        want = [float(row["com_x"]), float(row["com_y"]), float(row["com_z"])]
        assert place == pytest.approx(want, abs=1e-4), row["pose"]


@pytest.mark.parametrize("pose", [0, 1])
def test_absolem_recipe_with_point_feet_stands_before_and_tips_after_each_tabled_tilt(
    pose: int,
) -> None:
    row = rows("absolem_rectangle.csv")[pose]
    feet = body_contacts(float(row["half_length"]), float(row["half_width"]), -0.07045)
    recipe = lutgen.parse_recipe(absolem_recipe(feet))
    params = np.radians([[(0.0, 90.0 + 10.64)[pose]]])
    for heading in HEADINGS:
        gravity = [
            tilted(heading, radians(float(row[heading]) + beyond)) for beyond in (-0.05, 0.05)
        ]
        before, after = lutgen.evaluate(recipe, params, gravity, channels=("tip_angle",))[
            "tip_angle"
        ][0]
        assert before > 0.0 > after, (row["pose"], heading)
        assert before - after == pytest.approx(radians(0.1), rel=1e-6)


def test_absolem_on_wheels_tips_nose_down_at_65_deg_with_its_flippers_up() -> None:
    wheels = body_contacts(*WHEEL, "radius = 0.089\naxis = [0, 1, 0]")
    recipe = lutgen.parse_recipe(absolem_recipe(wheels + flipper_contacts()))
    # A wheel's hull holds rim points ahead of its lowest one: their facet would carry at 65 deg.
    gravity = [tilted("nose_down", radians(tilt)) for tilt in (0.0, 58.0, 65.0)]
    level, standing, tipping = lutgen.evaluate(recipe, [[0.0]], gravity, channels=("tip_angle",))[
        "tip_angle"
    ][0]
    assert level > radians(50.0)
    assert 0.0 < standing < radians(2.0)
    assert tipping < 0.0
    # The front wheels' lowest points are those of the rectangle, so the limit is the same 59.04.
    assert tipping == pytest.approx(radians(59.04 - 65.0), abs=radians(0.05))


def test_margins_equal_the_published_ones_on_both_sides_of_the_limit() -> None:
    polygon = np.array([[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 2.0, 0.0], [1.0, 0.0, 0.0]])
    table = rows("margins.csv")
    assert len(table) == 2
    for row in table:
        com = np.array([float(row["com_x"]), float(row["com_y"]), float(row["com_z"])])
        got = lutgen.stability((polygon - com)[None], DOWN[None], ["margin", "energy_margin"])
        # The energy margins are printed to nine decimals.
        assert got["margin"][0, 0] == pytest.approx(float(row["margin"]), abs=1e-8)
        assert got["energy_margin"][0, 0] == pytest.approx(float(row["energy_margin"]), abs=1e-8)
        verdict = oracle.judge(polygon - com, DOWN)
        assert verdict.margin == pytest.approx(float(row["margin"]), abs=1e-8)
        assert verdict.energy_margin == pytest.approx(float(row["energy_margin"]), abs=1e-8)


def test_margins_of_single_edges_equal_the_published_ones() -> None:
    # The published lists per edge are reached by shifting the com until that edge is the nearest.
    half = 0.5
    feet = np.array([[half, 1, -1], [-half, 1, -1], [-half, -1, -1], [half, -1, -1]])
    for shift, margin, energy in ((0.3, 0.2, 0.019803903), (-0.3, 0.2, 0.019803903)):
        got = lutgen.stability(
            (feet - [shift, 0, 0])[None], DOWN[None], ["margin", "energy_margin"]
        )
        assert got["margin"][0, 0] == pytest.approx(margin, abs=1e-8)
        assert got["energy_margin"][0, 0] == pytest.approx(energy, abs=1e-8)
    # 0.7 from the edge y = -1 of a wide rectangle: sqrt(0.7^2 + 1) - 1.
    wide = feet * [4.0, 1.0, 1.0]
    got = lutgen.stability(
        (wide + np.array([0, 0.3, 0]))[None], DOWN[None], ["margin", "energy_margin"]
    )
    assert got["margin"][0, 0] == pytest.approx(0.7, abs=1e-8)
    assert got["energy_margin"][0, 0] == pytest.approx(0.220655562, abs=1e-8)


SOLIDS = {
    "tripod": [[2, 0, -1], [-1, sqrt(3.0), -1], [-1, -sqrt(3.0), -1]],
    "table": [[x, y, -1] for x in (-1, 1) for y in (-1, 1)],
    "cube": [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    "tetrahedron": [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
}


def test_solids_worked_by_hand_have_the_tabled_tip_angle_stability_factor_and_height() -> None:
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
        verdict = oracle.judge(contacts, gravity, *bounds)
        # Three decimals of a degree and nine of a length are printed.
        want = pytest.approx(radians(float(row["tip_angle"])), abs=radians(6e-4))
        assert got["tip_angle"][0, 0] == want, row
        assert verdict.tip_angle == want, row
        for name in ("sdg", "height"):
            expected = pytest.approx(float(row[name]), abs=1e-8, nan_ok=True)
            assert got[name][0, 0] == expected, (name, row)


def test_the_corner_of_the_open_box_is_at_the_hand_worked_angle() -> None:
    contacts = np.array(SOLIDS["cube"], dtype=np.float64)
    got = lutgen.stability(contacts[None], DOWN[None], ["tip_angle"], radians(100))
    assert got["tip_angle"][0, 0] == pytest.approx(pi / 2 + asin(1 / sqrt(3)), abs=1e-12)


def test_exact_limits_of_the_tripod_follow_its_two_radii() -> None:
    contacts = np.array(SOLIDS["tripod"], dtype=np.float64) * [10.0, 10.0, 12.0]
    # Circumradius 20, in-radius 10, height 12: 39.81 deg over an edge, 59.04 over a foot.
    over_edge = tilt_at_limit(contacts, "nose_up")
    over_foot = tilt_at_limit(contacts, "nose_down")
    assert tan(radians(over_edge)) == pytest.approx(10.0 / 12.0, abs=1e-7)
    assert tan(radians(over_foot)) == pytest.approx(20.0 / 12.0, abs=1e-7)
