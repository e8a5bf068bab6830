"""A sample of what `python -m proofs.physics.braking` does."""

import pytest

pytest.importorskip("mujoco", reason="the extra `physics` is not installed")

from proofs.physics.braking import Row, brake


@pytest.mark.parametrize("name", ["excavator", "articulated"])
def test_at_095_of_the_budget_a_robot_stands_and_at_105_it_tips(name: str) -> None:
    assert brake(name, 3) == Row(name, 3, 0, 0)
