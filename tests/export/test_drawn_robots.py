"""Robots on wide wheels, as designers describe them: C is next to the definition, and below it."""

import numpy as np
import pytest

from firmware_export.contacts.many import many_of, order_of
from firmware_export.truth import Model
from lutgen.channels import evaluate_each
from lutgen.recipe import Recipe, parse_recipe
from lutgen.support import DISC
from tests.fixtures.drawn_robots import (
    car_with_flippers,
    rocker_bogie,
    tracks_with_flippers,
    wheels_on_legs,
)
from tests.fixtures.many_library import (
    Library,
    boundary_points,
    postures_of,
    random_directions,
    shown,
)
from tests.fixtures.odd_robots import boxed_tracks
from tests.fixtures.recipes import contact, sweep_part

needs_gcc = pytest.mark.needs("gcc")
CHANNELS = ("tip_angle", "status")
TIPS = 2
ROBOTS = [car_with_flippers, rocker_bogie, tracks_with_flippers, wheels_on_legs]


def asked(recipe: Recipe, params: np.ndarray, g: np.ndarray, build) -> tuple[np.ndarray, ...]:
    """Return answers and truth: safe, stands, and both angles (rad)."""
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), CHANNELS)
    robot = Library(shown(recipe), build)
    got = robot.read(params, g)
    assert robot.most["failed"] == 0
    return got["status"] != TIPS, truth["status"] != TIPS, got["tip_angle"], truth["tip_angle"]


@needs_gcc
@pytest.mark.parametrize("make", ROBOTS)
def test_angles_of_robots_on_wide_wheels_are_next_to_the_definitions(make, tmp_path):
    recipe, rng = make(), np.random.default_rng(3)
    low, high = (
        np.array([getattr(p, e) for p in recipe.parameters]) for e in ("minimum", "maximum")
    )
    params = rng.uniform(low, high, (150, len(low))).astype(np.float32)
    g = random_directions(rng, 150 * 80).reshape(150, 80, 3).astype(np.float32)
    safe, stands, got, true = asked(recipe, params, g, tmp_path)
    assert not (safe & ~stands).any()
    assert (got[safe] <= true[safe]).all()
    off = np.degrees(true - got)[stands & safe]
    # The guard alone is 0.0057 deg; where a wheel's two rims come between two rests less is held.
    assert np.quantile(off, 0.75) < 0.02
    assert safe[stands & (true > 3e-4)].mean() > 0.98


@needs_gcc
@pytest.mark.parametrize("make", ROBOTS)
def test_robots_on_wide_wheels_are_never_falsely_safe(make, tmp_path):
    recipe, rng = make(), np.random.default_rng(4)
    params = postures_of(recipe, rng, 100)
    g = boundary_points(recipe, params, rng, 40, 18)
    safe, stands, got, true = asked(recipe, params, g, tmp_path)
    assert not (safe & ~stands).any()
    assert (got[safe] <= true[safe]).all()


@needs_gcc
@pytest.mark.parametrize(
    ("seed", "noise"), [(0, 1e-6), (115, 1e-6), (8, 1e-5), (22, 1e-5), (50, 3e-5)]
)
def test_places_of_few_digits_lose_nothing(seed, noise, tmp_path):
    # Corners that stick out of a rim by what printing left, contacts of one plane on either side of
    # what counts as touching it, and rails that are one but for that: 2 to 44 % of what stood was
    # called unsafe.
    recipe, rng = boxed_tracks(seed, noise), np.random.default_rng(seed + 1000)
    params = postures_of(recipe, rng, 40)
    near = boundary_points(recipe, params, rng, 30, 18)
    far = random_directions(rng, 2400).reshape(40, 60, 3).astype(np.float32)
    safe, stands, got, true = asked(recipe, params, np.concatenate([near, far], axis=1), tmp_path)
    assert not (safe & ~stands).any()
    assert (got[safe] <= true[safe]).all()
    assert safe[stands & (true > 3e-4)].mean() > 0.998


HEAD = '[robot]\nname = "rails"\nlength_unit = "m"\n[[robot.link]]\nname = "body"\nmass = 1\n'


def on_axles(noise: float, tilt: float) -> Recipe:
    """Return four wheels whose rails and axles are off by some noise (m) and tilt (rad)."""
    rng = np.random.default_rng(1)
    places = [(x, y, -0.2) for x in (-0.3, 0.3) for y in (-0.2, 0.2)]
    wheels = [
        contact(
            f"w{k}",
            [float(p + noise * s) for p, s in zip(place, rng.choice([-1, 1], 3), strict=True)],
            0.1,
            [0.0, 1.0, float(tilt * rng.choice([-1, 1]))],
            link="body",
        )
        for k, place in enumerate(places)
    ]
    return parse_recipe(HEAD + "".join(wheels) + sweep_part())


def test_axles_and_rails_that_differ_in_their_last_digits_are_one():
    # 1.5708 for a right angle tilts an axle by 3.7e-6 rad, six decimals move a rail by 5e-7 m.
    for noise, tilt in ((0.0, 0.0), (5e-7, 0.0), (0.0, 3.7e-6), (5e-7, 3.7e-6)):
        model = Model(on_axles(noise, tilt))
        assert (model.kind == DISC).all()
        assert order_of(model)[1] is False
        assert many_of(model).first == (0, 2, 4)
    assert order_of(Model(on_axles(0.0, 1e-4)))[1] is True
    assert len(many_of(Model(on_axles(1e-4, 0.0))).first) > 3
