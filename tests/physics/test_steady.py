"""The verdict does not hang on noise, on the way it is derived, or on a stricter limit."""

import json
import math

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the extra `physics` is not installed")

from lutgen.support import DISC, pack
from proofs.physics import steady
from proofs.physics.doubts import let_go
from proofs.physics.noise import KINDS, Compared, compared
from proofs.physics.steady import BRANCHING, COUNTS, derived_twice, enlarged
from proofs.physics.thresholds import THRESHOLDS, thresholds_near

SIZE = 0.5


def car(wide: float = 0.3, rise: float = 0.0, ahead: float = 0.0) -> np.ndarray:
    """Return a car on thin wheels, 0.4 m long, its com 0.2 m up; the front wheels may be higher."""
    places = [
        (x + ahead, y, -0.1 + rise * (x > 0)) for x in (-0.2, 0.2) for y in (-wide / 2, wide / 2)
    ]
    return pack(
        np.array(places), np.tile([0.0, 1.0, 0.0], (4, 1)), np.full(4, 0.1), np.full(4, DISC)
    )


def tilted(degrees: float) -> np.ndarray:
    """Return gravity in a robot with its nose down."""
    angle = math.radians(degrees)
    return np.array([[math.sin(angle), 0.0, -math.cos(angle)]])


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in BRANCHING])
@pytest.mark.parametrize("noise", [1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
def test_noise_changes_no_verdict_outside_a_band_as_wide_as_itself(kind: str, noise: float) -> None:
    found = compared(kind, noise, robots=20, count=100, seed=5)
    assert (found.safe, found.tips) == (0, 0)


@pytest.mark.parametrize("noise", [1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
def test_four_rims_on_an_axle_with_noise_are_never_falsely_safe(noise: float) -> None:
    assert compared("absolem, both rims", noise, robots=60, count=100, seed=5).safe == 0


@pytest.mark.parametrize("contacts", COUNTS)
def test_closed_form_and_rolling_agree_on_random_robots_with_parallel_axes(contacts: int) -> None:
    differ, tried = derived_twice(contacts, 250, seed=7)
    assert tried == 250
    assert differ == 0


def test_a_wider_rest_or_a_smaller_rock_angle_makes_no_robot_stand_that_tipped() -> None:
    wrong, cases = enlarged(50, seed=3)
    assert cases == 400
    assert wrong == 0


def test_a_robot_is_near_the_threshold_that_decides_and_near_no_other() -> None:
    sigma = 1e-5
    # As wide as `rest_width` but for half of what noise may do.
    (found,) = thresholds_near(car(wide=0.01 * SIZE + 5 * sigma), tilted(0.0), sigma, 0.3, SIZE)
    assert found[THRESHOLDS.index("rest_width")]
    # The ground is as steep to its body as `upright` allows, but for a little.
    steep = math.tan(math.radians(80.0) - 5 * sigma / 0.3) * 0.4
    (found,) = thresholds_near(car(rise=steep, ahead=0.5), tilted(80.0), sigma, 0.3, 2.5)
    assert np.array(THRESHOLDS)[found].tolist() == ["upright"]
    for degrees in (0.0, 30.0, 60.0):
        assert not thresholds_near(car(), tilted(degrees), sigma, 0.3, SIZE).any()


def test_the_engine_lets_a_car_fall_beyond_45_deg_and_not_before() -> None:
    assert let_go(car(), np.vstack([tilted(30.0), tilted(60.0)])) == (2, 1)


def test_what_is_falsely_safe_is_missed_and_what_is_rough_only_if_it_is_common() -> None:
    def missed(kind: str, noise: float, safe: int, tips: int, near: int) -> bool:
        return steady.missed(Compared(kind, noise, 1000, safe, tips, (near, 0, 0, 0, 0)))

    assert not missed("balls", 1e-8, 0, 0, 0)
    for safe, tips, near in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
        assert missed("balls", 1e-8, safe, tips, near)
    branching = next(iter(BRANCHING))
    assert not missed(branching, 1e-8, 0, 3, 11)
    assert missed(branching, 1e-8, 0, 4, 11)
    assert missed(branching, 1e-8, 1, 3, 11)
    assert not missed(branching, 1e-3, 3, 25, 11)
    assert missed(branching, 1e-3, 4, 25, 11)
    assert missed("balls", 1e-3, 1, 0, 0)
    assert missed("balls", 1e-3, 0, 26, 0)
    assert missed("balls", 1e-3, 0, 0, 12)


def test_the_page_shows_what_was_measured() -> None:
    stored = json.loads(steady.STORED.read_text(encoding="utf-8"))
    text = steady.PAGE.read_text(encoding="utf-8")
    for name, content in stored.items():
        assert steady.page(text, name, content) == text
    for kind in KINDS:
        assert f"| {kind} |" in stored["noise"]
