"""The energy margin: by hand, and by turning the robot in small steps.

The com rises until the robot is balanced over an edge; over a held part of an edge it rolls on to
the next rest, and counts what it takes over an edge of that.
"""

import math

import numpy as np
import pytest

import lutgen
from tests.fixtures.length import part
from tests.fixtures.pulled import BOX
from tests.oracles.primitives import unit
from tests.oracles.standing import Standing
from tests.support.postures import FAMILIES, asked, drawn, limits_of, read

LEVEL = np.array([[0.0, 0.0, -1.0]])
WAY = np.linspace(0.0, 1.0, 401)[:, None]


def energy(contacts, g, *limits):
    return lutgen.stability(contacts, g, ("energy_margin",), *limits)["energy_margin"][0]


def risen(points, g):
    """Return how far the com rises until it is balanced on points (m, 3): |p| - p . g."""
    return np.asarray(np.sqrt((points**2).sum(-1)) - points @ g)


def of_standing(standing, g, seat):
    """Return the energy margin of a robot on a rest, by trying every place of every edge."""
    rests, least = standing.rests, math.inf
    group = rests[seat].group
    if all(f.group == group for f in rests):
        return min(float(risen(a + WAY * (b - a), g).min()) for a, b in standing.sides)
    for f in rests:
        for e, _, a, b in f.edges() if f.group == group else []:
            arc = f.beyond.get(e)
            if arc is not None and arc.to.group == group:
                continue
            low, high = arc.held if arc is not None else (1.0, 0.0)
            low, high = (low, high) if low < high else (1.0, 1.0)
            for v, w in ((0.0, low), (high, 1.0)):
                if v < w:
                    free = a + (v + (w - v) * WAY) * (b - a)
                    least = min(least, float(risen(free, g).min()))
            if arc is None or low >= high:
                continue
            # Where it rolls over most easily, and then on over the easiest edge of the next rest.
            there = low + (high - low) * WAY
            easiest = float(risen(arc.p[0] + there * (arc.q[0] - arc.p[0]), g).min())
            last, sunk, onward = arc.turned @ g, float(arc.sunk @ g), math.inf
            for other in rests:
                for k, _, c, d in other.edges() if other.group == arc.to.group else []:
                    inner = k in other.beyond and other.beyond[k].to.group == other.group
                    if not inner and not (other is arc.to and k == arc.back):
                        onward = min(onward, float(risen(c + WAY * (d - c), last).min()))
            least = min(least, max(easiest, onward - sunk))
    return least


@pytest.mark.parametrize("family", FAMILIES)
def test_that_of_any_posture_is_the_least_rise_over_every_place_of_every_edge(family):
    rolled = 0
    for seed in range(part(8, 4)):
        rng = np.random.default_rng(seed)
        rows = drawn(family, rng)
        standing = Standing(rows, limits_of(rows))
        g = asked(standing, 16, rng)
        found = read(rows, g, ("energy_margin",))["energy_margin"]
        for k, direction in enumerate(g):
            walls = [unit(np.cross(f.points, np.roll(f.points, -1, 0))) for f in standing.rests]
            on = [i for i, wall in enumerate(walls) if (wall @ direction > 1e-6).all()]
            if on:
                want = of_standing(standing, direction, on[0])
                # Simpson's rule leaves 1e-6; gaps are moved in by up to 1e-3 of an edge, so that
                # it tips over where it would be held, and never the other way.
                assert -1e-3 < found[k] - want < 1e-5
                rolled += any(f.beyond for f in standing.rests)
    assert rolled > 5


def test_outside_it_is_negative_and_a_body_without_an_edge_to_tip_over_has_an_infinite_one():
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    assert np.isposinf(energy(cube, np.array([[0.0, 0.0, -1.0], [1.0, 2.0, 3.0]]))).all()
    # Where it may not lie on its sides, it rises over an edge of its base.
    assert energy(cube, LEVEL, 1.0).item() == pytest.approx(math.sqrt(2.0) - 1.0)
    beyond = np.array([[0.0, 1.0, -1.0]])
    # 45 deg aside, 14 beyond the balance: the com is that much lower than at the top.
    size = math.hypot(0.3, 0.5)
    lower = size * (1.0 - math.cos(math.radians(45.0) - math.atan2(0.3, 0.5)))
    assert energy(np.array(BOX), beyond).item() == pytest.approx(-lower, abs=1e-12)
