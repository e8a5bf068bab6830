"""The least share of the weight: exact on three contacts, of equal springs beyond, by groups."""

import math

import numpy as np
import pytest

import lutgen
from lutgen.analysis import Posture, share_limits
from lutgen.channels import smallest_shares
from tests.fixtures.recipes import feet, rigid, rocker

X, Y, Z = 0.6, 0.4, 0.5
CORNERS = np.array([[X, Y, -Z], [X, -Y, -Z], [-X, Y, -Z], [-X, -Y, -Z]])
NAMES = [line.split('"')[1] for line in feet(CORNERS).splitlines() if line.startswith("name")]
GROUPS = f'[[robot.group]]\nname = "front"\ncontacts = ["{NAMES[0]}", "{NAMES[1]}"]\n'


def share(text, gravity, params=None):
    found = lutgen.evaluate(lutgen.parse_recipe(text), [params or []], [gravity], ("least_share",))
    return float(found["least_share"][0, 0])


def test_shares_balance_and_are_those_of_springs_that_push_in_proportion_to_their_length():
    rng = np.random.default_rng(5)
    for _ in range(500):
        n = int(rng.integers(3, 12))
        places = rng.normal(size=(n, 2)) * rng.uniform(0.1, 3.0, 2)
        mixture = rng.dirichlet(np.full(n, rng.choice([0.1, 0.3, 1.0])))
        arm, shares = places - mixture @ places, np.empty(n)
        smallest_shares(arm, shares)
        assert (shares >= 0.0).all()
        assert np.append(shares @ arm, shares.sum() - 1.0) == pytest.approx(0.0, abs=1e-7)
        # Nothing that balances and nowhere pulls has a smaller sum of squares.
        assert shares @ shares <= mixture @ mixture + 1e-9
        pushes, springs = shares > 1e-9, np.column_stack([np.ones(n), arm])
        if np.linalg.matrix_rank(springs[pushes], 1e-3) == 3:
            plane = np.linalg.lstsq(springs[pushes], shares[pushes], rcond=None)[0]
            assert np.maximum(springs @ plane, 0.0) == pytest.approx(shares, abs=1e-5)


def test_three_contacts_carry_what_balance_fixes_and_groups_add_up():
    tripod = rigid(feet([CORNERS[0], CORNERS[1], [-X, 0.0, -Z]]))
    # D_g moves by Z tan(tilt) towards the single foot, which carries the rest of both others.
    slope = 0.5
    assert share(tripod, [0, 0, -1]) == pytest.approx(0.25)
    assert share(tripod, [slope, 0, -1]) == pytest.approx(0.5 - slope * Z / (2 * X))
    assert math.isnan(share(tripod, [2.0, 0, -1]))
    box = rigid(feet(CORNERS) + GROUPS)
    assert share(box, [-slope, 0, -1]) == pytest.approx(0.5 - slope * Z / (2 * X))
    assert share(box.replace(GROUPS, ""), [-slope, 0, -1]) == pytest.approx(
        0.25 - slope * Z / (4 * X)
    )
    # It rocks on its middle wheels.
    assert share(rocker(), [0, 0, -1]) == 0.0


def test_a_group_keeps_its_share_up_to_the_tilt_that_balance_gives():
    posture = Posture(lutgen.parse_recipe(rigid(feet(CORNERS) + GROUPS)), [])
    headings = np.array([math.pi, 0.0])
    up, down = share_limits(posture, "front", 0.2, headings)
    assert up == pytest.approx(math.atan(0.6 * X / Z), abs=1e-9)
    assert down == pytest.approx(math.atan(X / Z), abs=1e-9)  # where it tips
    assert share_limits(posture, NAMES[0], 0.26, headings)[0] == 0.0
    for wrong in (("rear", 0.2), ("front", 1.5)):
        with pytest.raises(lutgen.InputError, match=f"got {wrong[0]}={wrong[1]}"):
            share_limits(posture, *wrong, headings)
