"""The verdict does not hang on noise, on the way it is derived, or on a stricter limit."""

import pytest

from proofs.physics.noise import KINDS, compared
from proofs.physics.steady import COUNTS, derived_twice, enlarged

# Left to the long run: where it rolls it branches, and a branch is a threshold.
BRANCHING = "absolem, both rims"


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != BRANCHING])
@pytest.mark.parametrize("noise", [1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
def test_noise_changes_no_verdict_outside_a_band_as_wide_as_itself(kind: str, noise: float) -> None:
    found = compared(kind, noise, robots=20, count=100, seed=5)
    assert (found.safe, found.tips) == (0, 0)


@pytest.mark.parametrize("contacts", COUNTS)
def test_closed_form_and_rolling_agree_on_random_robots_with_parallel_axes(contacts: int) -> None:
    differ, tried = derived_twice(contacts, 250, seed=7)
    assert tried == 250
    assert differ == 0


def test_a_wider_rest_or_a_smaller_rock_angle_makes_no_robot_stand_that_tipped() -> None:
    wrong, cases = enlarged(50, seed=3)
    assert cases == 400
    assert wrong == 0
