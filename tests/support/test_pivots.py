"""Axles that swing about a pivot: a tractor stands on its rear wheels and on its front pivot."""

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import lutgen
from lutgen.analysis import Posture, ground_tilt
from tests.fixtures.commands import data, stdout
from tests.fixtures.recipes import contact, sweep_part

NONE = np.zeros((1, 0))


def tractor(pivot, com=(0.8, 0.0, 0.9), base=2.3, tracks=(0.8, 0.8), extra="", axle=0.0):
    """Return a robot on four feet, the front ones on an axle whose pivot is so high; None: rigid.

    `base` and `tracks` are the wheelbase and half the rear and the front track, `axle` is the mass
    of the axle, at its pivot.
    """
    high = pivot or 0.0
    places = {
        "rear_left": ("body", [0.0, tracks[0], 0.0]),
        "rear_right": ("body", [0.0, -tracks[0], 0.0]),
        "front_left": ("axle", [0.0, tracks[1], -high]),
        "front_right": ("axle", [0.0, -tracks[1], -high]),
    }
    text = '[robot]\nname = "tractor"\nlength_unit = "m"\nrest_width = 0.001\n'
    text += f'[[robot.link]]\nname = "body"\nmass = 3000.0\ncom = {list(com)}\n'
    text += f'[[robot.link]]\nname = "axle"\nparent = "body"\norigin = {[base, 0.0, high]}\n'
    text += f"mass = {axle}\n"
    text += "".join(contact(name, place, link=link) for name, (link, place) in places.items())
    if pivot is not None:
        text += f'[[robot.axle]]\nname = "front"\npivot = {[base, 0.0, pivot]}\n'
        text += 'contacts = ["front_left", "front_right"]\n'
    channels = ("sdg", "tip_angle", "margin", "energy_margin", "status")
    return lutgen.parse_recipe(text + extra + sweep_part("", "cone", 17, 60.0, channels))


def sideways(recipe):
    """Return the tilt (deg) to the side at which a robot tips."""
    found = ground_tilt(Posture(recipe, []))
    return math.degrees(float(found.limits(np.array([0.5 * math.pi]))[0]))


def polygon(pivot, com, base, tracks):
    """Return half planes (a, b, c), a x + b y + c <= 0, of where gravity must pierce the ground."""
    rear, front = tracks
    ahead = base - com[0]
    place = com[:2] + (com[2] / (com[2] - pivot)) * np.array([ahead, -com[1]])
    carried = ConvexHull([[0.0, rear], [0.0, -rear], place]).equations
    wheels = ConvexHull([[0.0, rear], [0.0, -rear], [base, front], [base, -front]]).equations
    return np.vstack([carried, wheels])


@pytest.mark.parametrize(
    ("pivot", "side", "worst"),
    [
        *((None, 41.6, 41.6), (0.7, 38.5, 38.3), (0.5, 35.7, 35.2), (0.0, 30.1, 28.7)),
        # So high a pivot that the axle turns over its own wheel before: atan(0.8 / 2).
        (2.0, 21.8, 21.8),
    ],
)
def test_a_tractor_tips_over_its_pivot(pivot, side, worst):
    # Worked by hand: 0.8 (1 - 0.8 / x) / 0.9 with x = 0.8 + 1.5 * 0.9 / (0.9 - z).
    assert sideways(tractor(pivot)) == pytest.approx(side, abs=0.06)
    guaranteed = ground_tilt(Posture(tractor(pivot), [])).guaranteed
    assert math.degrees(guaranteed) == pytest.approx(worst, abs=0.06)


def test_verdicts_are_those_of_a_polygon_made_by_another_way():
    rng = np.random.default_rng(5)
    wrong = stands = 0
    for _ in range(60):
        com = (rng.uniform(0.3, 1.4), rng.uniform(-0.2, 0.2), rng.uniform(0.6, 1.2))
        # So low a pivot that no axle turns over one of its own wheels before the robot tips.
        pivot, base = rng.uniform(0.0, 0.3) * com[2], rng.uniform(1.8, 2.6)
        tracks = (rng.uniform(0.5, 1.0), rng.uniform(0.8, 1.0))
        recipe = tractor(pivot, com, base, tracks)
        across = rng.uniform(-1.2, 1.2, (300, 2))
        down = np.column_stack([across, -np.ones(300)])
        angle = lutgen.evaluate(recipe, NONE, down)["tip_angle"][0]
        pierced = np.array(com[:2]) + com[2] * across
        sides = np.asarray(polygon(pivot, com, base, tracks))
        inside = (pierced @ sides[:, :2].T + sides[:, 2] <= 0.0).all(axis=1)
        wrong += int(((angle >= 0.0) != inside)[np.abs(angle) > 1e-6].sum())
        stands += int(inside.sum())
    assert wrong == 0
    assert 2000 < stands < 16000


def test_a_narrow_axle_turns_over_its_own_wheel_before_the_robot_tips():
    # Its pivot is 0.7 high and its wheels are 0.3 from the middle: atan(0.3 / 0.7) = 23.2 deg.
    assert sideways(tractor(0.7, tracks=(0.8, 0.3))) == pytest.approx(23.2, abs=0.02)


def test_energy_and_margin_are_those_of_the_line_through_a_wheel_and_the_pivot():
    # Turned about the line from (0, 0.8, 0) to (2.3, 0, 0.5) until the com is highest.
    wheel, pivot, com = np.array([0.0, 0.8, 0.0]), np.array([2.3, 0.0, 0.5]), [0.8, 0.0, 0.9]
    line = (pivot - wheel) / np.linalg.norm(pivot - wheel)
    arm = np.array(com) - wheel - ((np.array(com) - wheel) @ line) * line
    up = np.array([0.0, 0.0, 1.0]) - line[2] * line
    rise = float(np.linalg.norm(arm) * np.linalg.norm(up) - arm @ up)
    flat = np.array([2.3, -0.8]) / math.hypot(2.3, 0.8)
    away = float(abs(flat[0] * (0.0 - 0.8) - flat[1] * 0.8))
    found = lutgen.evaluate(tractor(0.5), NONE, [[0, 0, -1]], ("margin", "energy_margin"))
    assert found["energy_margin"][0, 0] == pytest.approx(rise, rel=1e-12)
    assert found["margin"][0, 0] == pytest.approx(away, rel=1e-12)


def test_the_weight_of_an_axle_does_not_hold_the_rest():
    # Its com is at the pivot: sideways the rest tips as if the axle had no weight.
    light, heavy = (sideways(tractor(0.5, axle=mass)) for mass in (0.0, 900.0))
    assert light == pytest.approx(heavy, abs=1e-9)


def test_the_centre_of_a_tractor_is_that_of_its_cut_triangle():
    # The triangle (0, 0.8), (0, -0.8), (4.175, 0), cut at x = 2.3.
    def area_and_moment(x):
        width = 1.6 / 4.175
        return 1.6 * x - width * x * x / 2, 1.6 * x * x / 2 - width * x**3 / 3

    area, moment = area_and_moment(2.3)
    sdg = lutgen.evaluate(tractor(0.5), NONE, [[0, 0, -1]])["sdg"][0, 0]
    assert sdg == pytest.approx(moment / area - 0.8, rel=1e-9)


def test_stops_change_no_verdict_and_two_axles_carry_nothing():
    stops = tractor(0.5, extra="").text.replace('name = "front"', 'name = "front"\nstops = 11.0')
    down = [[0.2, 0.5, -1.0]]
    free, stopped = (
        lutgen.evaluate(one, NONE, down) for one in (tractor(0.5), lutgen.parse_recipe(stops))
    )
    assert free == stopped
    rear = '[[robot.axle]]\nname = "rear"\npivot = [0, 0, 0.5]\n'
    rear += 'contacts = ["rear_left", "rear_right"]\n'
    both = lutgen.evaluate(tractor(0.5, extra=rear), NONE, [[0, 0, -1]])
    assert both["tip_angle"][0, 0] == -math.pi


def test_a_plane_on_one_wheel_of_an_axle_is_no_rest():
    # A keel so deep that no plane touches both front wheels and three more.
    keel = '[[robot.contact]]\nname = "keel"\nlink = "body"\nposition = [1.2, 0, -0.3]\n'
    rigid, swings = tractor(None, extra=keel), tractor(0.5, extra=keel)
    facets = [Posture(recipe, []).facets for recipe in (rigid, swings)]
    ends = {"front_left", "front_right"}
    touched = [
        [ends & {recipe.contact_names[i] for i in facet.touching} for facet in some]
        for recipe, some in zip((rigid, swings), facets, strict=True)
    ]
    assert any(len(one) == 1 for one in touched[0])
    assert all(len(one) != 1 for one in touched[1])


def test_a_sweep_of_a_tractor_agrees_with_evaluate(tmp_path):
    recipe = tractor(0.5)
    swept = lutgen.sweep(recipe, tmp_path / "map.h5")
    exact = lutgen.evaluate(recipe, NONE, recipe.chart.directions().reshape(-1, 3), recipe.channels)
    for name in recipe.channels:
        np.testing.assert_allclose(swept[name].ravel(), exact[name][0], rtol=3e-7, atol=1e-7)


def test_check_says_which_contacts_swing(tmp_path):
    path = tmp_path / "tractor.toml"
    path.write_text(tractor(0.5).text)
    assert data("check", path)["axles"] == {"front": ["front_left", "front_right"]}
    assert "axle front swings with front_left and front_right" in stdout("check", path)


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('"front_left", "front_right"', '"front_left", "front_left"', r"contacts\[2\]"),
        ("pivot = [2.3, 0.0, 0.5]", "pivot = [2.3, 0.0]", "pivot"),
        ('name = "front"\n', 'name = "front"\nlink = "chassis"\n', "link"),
    ],
)
def test_a_wrong_axle_is_named(old, new, key):
    with pytest.raises(lutgen.RecipeError, match=rf"robot\.axle\[1\]\.{key}`"):
        lutgen.parse_recipe(tractor(0.5).text.replace(old, new))
