"""The energy margin of robots that can roll to another facet before they tip over."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

import lutgen
from lutgen.channels.evaluation import measure_primitives
from lutgen.channels.plain import axis_energy
from lutgen.support import (
    DISC,
    acceptance,
    empty_region,
    facet_table,
    pack,
    segments_in,
    stand,
    start_at,
    stop_at,
    tip_plane_at,
)
from tests.oracles import points as oracle
from tests.oracles.tipping import least_barrier

Floats = NDArray[np.float64]
FEET = np.array([[0.3, 0.2, -0.3], [-0.3, 0.2, -0.3], [-0.3, -0.2, -0.3], [0.3, -0.2, -0.3]])


def energy(
    contacts: Floats, gravity: Floats, upright: float | None = None, rock: float | None = None
) -> Floats:
    """Return the energy margin (g,) of point contacts."""
    found = lutgen.stability(contacts, gravity, ("energy_margin",), upright, rock)
    return found["energy_margin"][0]


def over_axes(primitives: Floats, g: Floats) -> float:
    """Return the least rise over any tip-over axis, signed: what the margin is on one facet."""
    table, region = facet_table(len(primitives)), empty_region(len(primitives))
    stand(table, region, primitives, acceptance(None, None))
    down, s = tuple(g.tolist()), region.segment
    return min(
        axis_energy(start_at(s, b), stop_at(s, b), tip_plane_at(s, b), down)
        for b in range(segments_in(region.tally))
    )


def lying_on(contacts: Floats, g: Floats) -> oracle.Facet:
    """Return the facet that a ray along g pierces."""
    return next(f for f in oracle.support_facets(contacts) if oracle.is_pierced(f, g))


def warped(rng: np.random.Generator, warp: float, slope: float) -> tuple[Floats, Floats]:
    """Return four feet (4, 3), each off its place by up to `warp`, and a direction (3,)."""
    feet = FEET + rng.uniform(-warp, warp, (4, 3))
    return feet, oracle.unit(np.array([*rng.uniform(-slope, slope, 2), -1.0]))


@pytest.mark.parametrize("slope", [0.0, 0.3])
@pytest.mark.parametrize("warp", [1e-4, 0.01, 0.05])
def test_that_of_warped_feet_is_the_least_barrier_of_a_robot_rolled_over_the_ground(
    warp: float, slope: float
) -> None:
    rng = np.random.default_rng(5)
    off, above = [], []
    for _ in range(60):
        feet, g = warped(rng, warp, slope)
        barrier = least_barrier(feet, lying_on(feet, g).normal, g)
        off.append(abs(energy(feet, g)[0] - barrier))
        above.append(oracle.judge(feet, g).energy_margin / barrier - 1.0)
    # Asked for are 0.1 mm per metre; the oracle's grid leaves 1e-3 squared over 8.
    assert max(off) < 2e-7
    # The least rise over a tip-over axis, also of a facet that the robot is not on, is no answer.
    if warp > 1e-3:
        assert np.mean(np.array(above) > 0.02) > 0.1


def test_that_of_many_feet_is_the_least_barrier_over_several_facets() -> None:
    rng = np.random.default_rng(6)
    several = 0
    for _ in range(120):
        feet = np.column_stack((rng.uniform(-0.4, 0.4, (7, 2)), rng.uniform(-0.5, -0.3, 7)))
        g = oracle.unit(np.array([*rng.uniform(-0.4, 0.4, 2), -1.0]))
        got = lutgen.stability(feet, g, ("energy_margin", "tip_angle"))
        if not 0.0 < got["tip_angle"][0, 0] < math.pi:
            continue
        facet = lying_on(feet, g)
        one = least_barrier(feet, facet.normal, g, depth=1)
        barrier = least_barrier(feet, facet.normal, g, depth=12)
        assert got["energy_margin"][0, 0] == pytest.approx(barrier, abs=2e-7)
        several += barrier < one - 1e-4
    # Ways over more than the facet that the robot is on must matter.
    assert several > 20


def test_that_of_coplanar_contacts_is_the_least_rise_over_an_axis_to_the_last_bit() -> None:
    rng = np.random.default_rng(7)
    for n in (3, 4, 6, 9):
        feet = np.column_stack((rng.uniform(-0.5, 0.5, (n, 2)), np.full(n, -0.4)))
        gravity = oracle.unit(np.column_stack((rng.uniform(-1, 1, (50, 2)), -np.ones(50))))
        primitives = pack(feet, np.zeros_like(feet), 0.0, 0)
        got = energy(feet, gravity)
        want = [over_axes(primitives, g) for g in lutgen.chart.unit_directions(gravity)]
        assert got.tolist() == want
        assert 0 < (got < 0.0).sum() < 50


def test_it_is_never_above_the_rise_over_a_tip_over_axis_of_the_facet_on_the_ground() -> None:
    rng = np.random.default_rng(8)
    closed = 0
    for _ in range(300):
        feet, g = warped(rng, 0.05, 0.3)
        facets = oracle.support_facets(feet)
        edges = {(a.start.tobytes(), a.end.tobytes()) for a in oracle.tip_over_axes(facets, None)}
        own = [
            abs(oracle.axis_energy(axis, g))
            for axis in oracle.tip_over_axes([lying_on(feet, g)], 0.0)
            if {
                (axis.start.tobytes(), axis.end.tobytes()),
                (axis.end.tobytes(), axis.start.tobytes()),
            }
            & edges
        ]
        if own:
            closed += 1
            assert energy(feet, g)[0] <= min(own) + 1e-12
    assert closed > 200


def test_feet_that_are_all_but_coplanar_have_all_but_the_margin_of_coplanar_ones() -> None:
    rng = np.random.default_rng(9)
    for warp in (1e-12, 1e-9, 1e-7, 1e-5):
        for _ in range(20):
            g = oracle.unit(np.array([*rng.uniform(-0.2, 0.2, 2), -1.0]))
            feet = FEET + rng.uniform(-warp, warp, (4, 3))
            # Every length changes by no more than the warp, times the largest ratio of two.
            assert energy(feet, g) == pytest.approx(energy(FEET, g), abs=10.0 * warp + 1e-12)


def test_without_rocking_the_robot_tips_over_every_side_of_the_facet_that_it_is_on() -> None:
    rng = np.random.default_rng(10)
    for _ in range(50):
        feet, g = warped(rng, 0.03, 0.2)
        sides = oracle.tip_over_axes([lying_on(feet, g)], 0.0)
        want = min(abs(oracle.axis_energy(side, g)) for side in sides)
        assert energy(feet, g, math.radians(80.0), 0.0) == pytest.approx(want, abs=1e-12)


def test_a_body_without_an_edge_to_tip_over_has_an_infinite_margin() -> None:
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    assert np.isposinf(energy(cube, np.array([[0.0, 0.0, -1.0], [1.0, 2.0, 3.0]]))).all()
    # Where it may not lie on its sides, it rises over an edge of its base.
    assert energy(cube, np.array([0.0, 0.0, -1.0]), 1.0) == pytest.approx(math.sqrt(2.0) - 1.0)


def rocker(front: float, rear: float, low: float, radius: float) -> Floats:
    """Return six wheels (6, 8) on three axles along y, the middle one lower than the others."""
    axles = [(front, 0.0), (0.0, -low), (-rear, 0.0)]
    # So wide that the robot does not tip over sideways.
    centre = np.array([[x, y, z - 0.3] for x, z in axles for y in (-2.0, 2.0)])
    return pack(centre, np.tile([0.0, 1.0, 0.0], (6, 1)), radius, DISC)


def contact(axle: Floats, radius: float, pitch: float | Floats) -> Floats:
    """Return where wheels of an axle (2,) touch level ground (..., 2), pitched nose up."""
    return np.stack(
        (
            axle[0] * np.cos(pitch) - axle[1] * np.sin(pitch),
            axle[0] * np.sin(pitch) + axle[1] * np.cos(pitch) - radius,
        ),
        axis=-1,
    )


def rolled(wheels: Floats, slope: float) -> tuple[float, float]:
    """Return the barriers of a robot on its front and middle wheels: over the front, over the rear.

    The ground falls by the slope (rad) ahead.  Pitched nose up by t on its middle wheels, locked to
    the body, the robot rolls back by r t.  In the plane of x and z, relative to the com.
    """
    front, middle, rear = (wheels[i, [0, 2]] for i in (0, 2, 4))
    radius = wheels[0, 6]
    up = np.array([-math.sin(slope), math.cos(slope)])
    begin, end = (-math.atan2(*(a - b)[::-1]) for a, b in ((front, middle), (middle, rear)))
    pitch = np.linspace(begin, end, 20_001)
    com = -contact(middle, radius, pitch)
    com[:, 0] -= radius * (pitch - begin)
    height = (com - com[0]) @ up

    def rise(arm: Floats) -> float:
        """Return the rise until the com is above a contact that is fixed to the body."""
        return float(math.hypot(*arm) + arm @ up)

    over_rear = max(height.max(), height[-1] + rise(contact(rear, radius, end)))
    return rise(contact(front, radius, begin)), over_rear


@pytest.mark.parametrize("slope", [0.0, 0.1, -0.15])
def test_wheels_roll_over_the_ridge_of_their_middle_axle(slope: float) -> None:
    rng = np.random.default_rng(11)
    by_ridge = 0
    for _ in range(150):
        wheels = rocker(*rng.uniform([0.3, 0.1, 0.01, 0.05], [0.8, 0.5, 0.1, 0.2]))
        wheels[:, 0] -= rng.uniform(-0.05, 0.15)
        front, middle = wheels[0, [0, 2]], wheels[2, [0, 2]]
        lean = math.atan2(*(front - middle)[::-1])
        touch = contact(middle, wheels[0, 6], -lean)
        # The com must be above the facet of the front and middle wheels.
        if not touch[0] < -touch[1] * math.tan(slope) < contact(front, wheels[0, 6], -lean)[0]:
            continue
        g = np.array([math.sin(lean + slope), 0.0, -math.cos(lean + slope)])
        limits = acceptance(math.radians(80.0), None)
        got = measure_primitives(wheels[None], g, ("energy_margin",), limits)["energy_margin"]
        ahead, behind = rolled(wheels, slope)
        # Rolling in 32 steps an arc, and a cubic between nine places of it, on slopes.
        assert got[0, 0] == pytest.approx(min(ahead, behind), abs=2e-6)
        fixed = math.hypot(*touch) + math.cos(slope) * touch[1] - math.sin(slope) * touch[0]
        by_ridge += behind < ahead and abs(behind - fixed) > 1e-3
    # Often it is neither the rise over the front contacts nor that over the middle ones.
    assert by_ridge > 20


def test_of_wheels_that_rock_it_has_the_sign_of_the_verdict_and_no_steps_where_they_stand() -> None:
    rng = np.random.default_rng(12)
    limits = acceptance(math.radians(80.0), math.radians(30.0), 0.0, 0.01)
    rocking = 0
    for _ in range(25):
        # Three axles, the wheels of the middle one lower.
        low = rng.uniform([0, 0, 0.0, 0.0, 0, 0], [0, 0, 0.1, 0.1, 0, 0])
        side = [(x, y) for x in (-0.4, 0.0, 0.4) for y in (-0.3, 0.3)]
        centre = np.column_stack((side + rng.uniform(-0.02, 0.02, (6, 2)), -0.5 - low))
        wheels = pack(centre, np.tile([0.0, 1.0, 0.0], (6, 1)), 0.15, DISC)[None]
        gravity = np.column_stack((rng.uniform(-0.2, 0.2, (300, 2)), -np.ones(300)))
        here, there = (
            measure_primitives(wheels, g, ("energy_margin", "tip_angle"), limits)
            for g in (gravity, gravity + rng.uniform(-1e-7, 1e-7, gravity.shape))
        )
        margin, angle = here["energy_margin"][0], here["tip_angle"][0]
        assert ((margin >= 0.0) == (angle >= 0.0)).all()
        # Turned by 1e-7 no height of a robot of this size changes by more than a few times that;
        # near the top of a ridge the place where it tips over moves faster.
        inside = angle > 1e-5
        assert np.abs(there["energy_margin"][0] - margin)[inside].max(initial=0.0) < 1e-5
        narrow = acceptance(math.radians(80.0), 0.0, 0.0, 0.01)
        alone = measure_primitives(wheels, gravity, ("tip_angle",), narrow)["tip_angle"][0]
        rocking += int(((angle >= 0.0) & (alone < 0.0)).sum())
    # Directions in which the robot rocks from facet to facet are among them.
    assert rocking > 200
