"""One posture explained: forces, tip-over axes and sliding."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

import lutgen
from lutgen.analysis import Posture, diagnose, tilted
from lutgen.analysis.forces import load_corners, normal_forces
from tests.fixtures.length import part
from tests.fixtures.recipes import feet, rigid, rover

# The paper's wheels: circumradius 20, height 12, wheel 1 ahead.
WHEELS = [(20.0 * math.cos(a), 20.0 * math.sin(a), -12.0) for a in np.radians([0.0, 120.0, 240.0])]
# Pitch and heading (deg), exact shares, shares of Eq 12, largest difference; the load moves to
# the heading + 180 deg.  Source: "exact statics" of the paper's facts.
FORCES = [
    (0, 0, (0.3333, 0.3333, 0.3333), (0.3333, 0.3333, 0.3333), 0.0),
    (10, 0, (0.2628, 0.3686, 0.3686), (0.2992, 0.3504, 0.3504), 0.036),
    (20, 0, (0.1877, 0.4061, 0.4061), (0.2658, 0.3671, 0.3671), 0.078),
    (30, 0, (0.1024, 0.4488, 0.4488), (0.2331, 0.3834, 0.3834), 0.131),
    (39.7, 0, (0.0012, 0.4994, 0.4994), (0.2029, 0.3986, 0.3986), 0.202),
    (30, 180, (0.5643, 0.2179, 0.2179), (0.4542, 0.2729, 0.2729), 0.110),
    (58, 180, (0.9735, 0.0133, 0.0133), (0.6551, 0.1725, 0.1725), 0.318),
    (30, 90, (0.3333, 0.1333, 0.5333), (0.3243, 0.2424, 0.4334), 0.109),
]


def stool(points, head=""):
    return lutgen.parse_recipe(rigid(feet(points), head=head))


def test_forces_on_three_wheels_equal_the_table_and_are_barycentric_coordinates():
    for pitch, heading, exact, rough, difference in FORCES:
        gravity = tilted(math.radians(pitch), math.radians(heading + 180.0))  # uphill is ahead
        found = diagnose(Posture(stool(WHEELS), []), gravity)
        assert (found.standing, found.forces_kind) == (True, "exact")
        got = [found.normal_forces[name] for name in ("P1", "P2", "P3")]
        paper = [found.heuristic_forces[name] for name in ("P1", "P2", "P3")]
        # Four digits are printed: half of the last one; three of the difference.
        assert got == pytest.approx(exact, abs=5.1e-5)
        assert paper == pytest.approx(rough, abs=5.1e-5)
        largest = max(abs(a - b) for a, b in zip(got, paper, strict=True))
        assert largest == pytest.approx(difference, abs=5.1e-4)
        shares = np.linalg.solve(np.array(WHEELS).T, gravity)
        assert got == pytest.approx(shares / shares.sum(), abs=1e-12)  # two 3 x 3 solves
    tips = diagnose(Posture(stool(WHEELS), []), tilted(math.radians(41.0), math.pi))
    assert tips.normal_forces == tips.heuristic_forces == {}
    assert tips.channels["tip_angle"] < 0.0


def contacts_of_any_kind(rng, kind):
    """Return 3 to 11 contacts of any plane: anywhere, on a lattice, in a line, in two rows."""
    k = int(rng.integers(3, 12))
    flat = rng.normal(size=(k, 2))
    if kind == 1:
        flat = np.round(flat * 2.0) / 2.0
    if kind == 2:
        flat = np.outer(rng.normal(size=k), [1.0, 0.3]) + np.array([0.1, 0.2])
    if kind == 3:
        flat = np.column_stack([np.arange(k) // 2 * 0.5, np.where(np.arange(k) % 2, -0.4, 0.4)])
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return np.asarray(np.column_stack([flat, np.full(k, -1.0)]) @ turn * 10 ** rng.uniform(-3, 3))


def test_sets_of_contacts_inside_and_in_lines_balance_and_none_pulls():
    rng = np.random.default_rng(11)
    inside = 0
    count = part(2000)
    for trial in range(count):
        points = contacts_of_any_kind(rng, trial % 4)
        # D_g anywhere among the contacts, on the line of two of them or on one.
        weights = rng.dirichlet(np.full(len(points), 0.4))
        if trial % 3 == 0:
            weights = np.eye(len(points))[rng.integers(len(points), size=2)].mean(axis=0)
        pierced = weights @ points
        size = np.ptp(points, axis=0).max()
        shares = normal_forces(points, pierced)
        loads = load_corners(points, pierced)
        for load in (shares, *loads):
            assert load.min() >= 0.0
            # A billionth of the weight.
            assert load.sum() == pytest.approx(1.0, abs=1e-9)
            assert load @ points == pytest.approx(pierced, abs=1e-9 * size)
        # No other load is smaller: towards every corner of the set the norm grows.
        assert (loads @ shares).min() >= shares @ shares - 1e-9
        inside += int(len(loads) > 4)
    assert inside > count // 4


def test_the_range_of_each_share_is_that_of_two_linear_programmes():
    rng = np.random.default_rng(12)
    wide = 0
    for trial in range(60):
        points = contacts_of_any_kind(rng, trial % 4)
        k, size = len(points), np.ptp(points, axis=0).max()
        pierced = rng.dirichlet(np.full(k, 0.5)) @ points
        loads = load_corners(points, pierced)
        rows = np.vstack([np.ones(k), ((points - pierced) / size).T])
        for i in range(k):
            for sign, mine in ((1.0, loads[:, i].min()), (-1.0, loads[:, i].max())):
                best = linprog(sign * np.eye(k)[i], A_eq=rows, b_eq=[1.0, 0.0, 0.0, 0.0])
                # linprog's own tolerance.
                assert sign * best.fun == pytest.approx(mine, abs=1e-7)
            wide += int(np.ptp(loads[:, i]) > 0.1)
    assert wide > 100


def test_of_a_table_with_a_fifth_foot_all_five_carry_and_each_is_given_its_range():
    # The fifth foot is in the middle, below the com: it carries anything from none to all.
    found = diagnose(Posture(stool([*TABLE, (0.0, 0.0, -1.0)]), []), (0, 0, -1))
    assert found.forces_kind == "minimum norm"
    assert list(found.normal_forces.values()) == pytest.approx([0.2] * 5, abs=1e-14)
    assert found.normal_ranges["P5"] == pytest.approx((0.0, 1.0), abs=1e-14)
    assert found.normal_ranges["P1"] == pytest.approx((0.0, 0.5), abs=1e-14)
    # The polygon runs counter-clockwise seen from outside.
    points = found.facet.points
    assert sorted(map(tuple, points.tolist())) == sorted(TABLE)
    sides = np.roll(points, -1, 0) - points
    assert (np.cross(sides, np.roll(sides, -1, 0)) @ found.facet.normal > 0.0).all()
    up = diagnose(Posture(stool(TABLE), []), (0, 0, 1))
    assert (up.facet, up.standing, math.isnan(up.slope)) == (None, False, True)


def test_on_an_edge_only_that_edges_feet_carry_and_of_two_the_shares_are_exact():
    points = np.array(TABLE)
    loads = load_corners(points, np.array([2.0, 0.5, -1.0]))
    assert loads.tolist() == [pytest.approx([0.75, 0.0, 0.0, 0.25], abs=1e-14)]
    assert len(load_corners(points, np.array([2.001, 0.5, -1.0]))) == 0
    assert load_corners(points, points[2]).tolist() == [[0.0, 0.0, 1.0, 0.0]]


def test_over_a_gap_the_robot_stands_but_no_forces_balance_on_its_facet():
    # Four wheels of which one hangs lower: between its two facets the robot rocks.
    recipe = lutgen.parse_recipe(rover())
    seen = {True: 0, False: 0}
    for x in np.linspace(-0.3, 0.3, 13):
        for y in np.linspace(-0.3, 0.3, 13):
            found = diagnose(Posture(recipe, [0.3]), (x, y, -1.0))
            if not found.standing:
                continue
            rim = np.roll(found.facet.points, -1, 0) - found.facet.points
            inward = np.cross(found.facet.normal, rim)
            depth = ((found.pierced - found.facet.points) * inward).sum(axis=1).min()
            seen[depth > 0.0] += 1
            assert bool(found.normal_forces) is bool(depth >= 0.0)
            assert all(share >= 0.0 for share in found.normal_forces.values())
    assert min(seen.values()) >= 3


TABLE = [(2.0, 1.0, -1.0), (-2.0, 1.0, -1.0), (-2.0, -1.0, -1.0), (2.0, -1.0, -1.0)]


@pytest.mark.parametrize(
    ("heading", "tilt", "feet"),
    # Beyond the limits (63.4 and 45 deg) it is the axis over which the table falls.
    [(0, 60, "14"), (180, 60, "23"), (90, 10, "12"), (0, 80, "14"), (-90, 60, "34")],
)
def test_the_least_stable_axis_of_a_table_is_on_the_side_that_it_leans_to(heading, tilt, feet):
    recipe = stool(TABLE, "friction = 0.5")
    found = diagnose(Posture(recipe, []), tilted(*np.radians([tilt, heading])))
    least = found.tip_over_axes[found.least_stable]
    assert set(least.names) == {f"P{foot}" for foot in feet}
    assert len(found.tip_over_axes) == 4
    limit = math.atan(1.0 if abs(heading) == 90 else 2.0)
    assert least.tip_angle == pytest.approx(limit - math.radians(tilt), abs=1e-12)
    assert least.tip_angle == pytest.approx(found.channels["tip_angle"], abs=1e-12)
    assert diagnose(Posture(stool(TABLE), []), (1, 0, -1)).slides is None
