"""Point contacts: lutgen against the plain oracle, and the oracle against itself.

`random_case` draws robots of every kind that the definitions single out: generic feet,
feet on one plane, warped feet, the centre of mass inside the hull or below the feet,
repeated contacts, contacts inside the support polygon, on its edges and hovering above it.
"""

from collections import Counter
from functools import cache
from math import pi, radians
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial import ConvexHull

import lutgen
from tests.fixtures.length import part
from tests.oracles import points as oracle
from tests.oracles.points import Floats
from tests.oracles.tipping import least_barrier

CHANNELS = ("sdg", "height", "tip_angle", "margin", "energy_margin", "facet")
UPRIGHT = radians(90.0)
# The oracle knows no catch: beyond every edge the robot tips.
ROCK_ANGLE = 0.0

# Beyond this distance from the tipping limit (rad) both sides must give the same verdict;
# nearer, the rounding of two different formulas (about 1e-14) may decide.
LIMIT = 1e-9
# Both compute in double precision (1e-16); the thinnest facets drawn here amplify that by
# about 1e5, which leaves two digits below this relative bound.
RELATIVE = 1e-9
# |SD_g| is the distance of two points of the robot's size and passes through zero, where
# nothing relative can hold: its floor, per unit of the robot's size.
FLOOR = 1e-11


class Case(NamedTuple):
    """One posture and one direction to judge it in."""

    kind: str
    contacts: Floats  # (n, 3)
    gravity: Floats  # (3,) unit


def rotation(rng: np.random.Generator) -> Floats:
    """Uniformly random rotation matrix (3, 3)."""
    turned, upper = np.linalg.qr(rng.normal(size=(3, 3)))
    turned = turned * np.sign(np.diag(upper))
    return np.asarray(turned * np.sign(np.linalg.det(turned)))


def feet(rng: np.random.Generator, count: int) -> Floats:
    """Feet (count, 3) around and below the centre of mass, each at its own height."""
    flat = rng.uniform(-1.0, 1.0, (count, 2))
    return np.column_stack((flat, -rng.uniform(0.2, 1.2, count)))


def on_one_plane(rng: np.random.Generator, count: int) -> Floats:
    """Feet (count, 3) on one plane, that is tilted by up to about 35 degrees."""
    flat = rng.uniform(-1.0, 1.0, (count, 2))
    slope = rng.uniform(-0.5, 0.5, 2)
    return np.column_stack((flat, flat @ slope - rng.uniform(0.1, 1.0)))


def rectangle(rng: np.random.Generator) -> Floats:
    """Four feet (4, 3) at the corners of a level rectangle."""
    half = rng.uniform(0.2, 1.0, 2)
    shift = rng.uniform(-0.15, 0.15, 2)
    corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) * half + shift
    return np.column_stack((corners, np.full(4, -rng.uniform(0.2, 1.0))))


def posture(rng: np.random.Generator, kind: str, count: int) -> Floats:
    """Contacts (count, 3) of the given kind."""
    if kind == "feet":
        return feet(rng, count)
    if kind == "one plane":
        return on_one_plane(rng, count)
    if kind == "com inside":
        return rng.normal(size=(count, 3))
    if kind == "com below":
        return feet(rng, count) * [1.0, 1.0, -1.0]
    if kind == "com beside":
        return feet(rng, count) + np.array([1.5, 0.0, 0.0])
    if kind == "repeated":
        few = feet(rng, max(3, count - 2))
        return few[np.concatenate((np.arange(len(few)), rng.integers(0, len(few), count)))[:count]]
    if kind == "warped plane":
        warp = 10.0 ** rng.uniform(-5.0, -1.0)
        flat = on_one_plane(rng, count)
        return flat + warp * rng.uniform(-1.0, 1.0, flat.shape)
    if kind == "warped rectangle":
        warp = 10.0 ** rng.uniform(-5.0, -0.7) * rng.choice([-1.0, 1.0])
        warped = rectangle(rng) + warp * np.array([[0, 0, 1], [0, 0, -1], [0, 0, 1], [0, 0, -1]])
        return np.concatenate((warped, feet(rng, count) * [0.5, 0.5, 0.1]))[:count]
    # What follows has its extra contacts inside the support polygon, on its edges or above it.
    plane = rectangle(rng) if count > 4 else on_one_plane(rng, 3)
    few = plane[: count - 1]
    shares = rng.dirichlet(np.full(len(few), 0.7), size=count - len(few))
    if kind == "on edges":
        shares = 0.5 * (np.eye(len(few)) + np.roll(np.eye(len(few)), 1, axis=1))
        shares = shares[rng.integers(0, len(few), count - len(few))]
    extra = shares @ few
    if kind == "hovering":
        extra = extra + np.array([0.0, 0.0, 0.05])
    return np.concatenate((few, extra)) if count > 3 else plane


KINDS = (
    "feet",
    "one plane",
    "com inside",
    "com below",
    "com beside",
    "repeated",
    "warped plane",
    "warped rectangle",
    "inside polygon",
    "on edges",
    "hovering",
)


def aim(rng: np.random.Generator, contacts: Floats) -> Floats:
    """Gravity direction (3,): somewhere, at the feet, just beside an edge, or on it."""
    choice = rng.integers(0, 5)
    if choice == 0:
        target = rng.normal(size=3)
    elif choice == 1:
        target = np.array([*rng.uniform(-1.0, 1.0, 2), -1.0])
    else:
        first, second, third = contacts[rng.permutation(len(contacts))[:3]]
        share = rng.uniform()
        target = share * first + (1.0 - share) * second
        if choice == 2:
            target = (target + rng.uniform() * third) / 2.0
        elif choice == 3:
            target = target + 10.0 ** rng.uniform(-8.0, -1.0) * rng.normal(size=3)
    return np.asarray(target / np.sqrt(target @ target))


def random_case(rng: np.random.Generator, count: int, keep_level: bool = False) -> Case:
    """Posture of `count` contacts, of any kind, size and attitude, and a gravity direction."""
    kind = str(rng.choice(KINDS))
    contacts = posture(rng, kind, count)
    contacts = contacts[rng.permutation(count)]
    if not keep_level and rng.uniform() < 0.5:
        contacts = contacts @ rotation(rng).T
    contacts = contacts * 10.0 ** rng.uniform(-3.0, 3.0)
    return Case(kind, contacts, aim(rng, contacts))


# Of each number of contacts.
SOME = part(300, 8)


@cache
def cases(count: int, total: int, keep_level: bool = False) -> tuple[Case, ...]:
    """`total` cases of `count` contacts, the same on every run."""
    rng = np.random.default_rng([20240611, count, int(keep_level)])
    return tuple(random_case(rng, count, keep_level) for _ in range(total))


@cache
def verdicts(
    count: int, total: int, upright: float | None = None, rock_angle: float | None = None
) -> tuple[oracle.Verdict, ...]:
    """Ask the oracle for its verdict on each of `cases`."""
    return tuple(
        oracle.judge(case.contacts, case.gravity, upright, rock_angle)
        for case in cases(count, total, upright is not None)
    )


def answers(
    drawn: tuple[Case, ...], upright: float | None = None, rock_angle: float | None = None
) -> dict[str, Floats]:
    """Ask lutgen about each case: channel -> (cases,).

    Postures go in by blocks of 64, each block with all its directions; the diagonal is kept.
    """
    parts: dict[str, list[Floats]] = {name: [] for name in CHANNELS}
    for start in range(0, len(drawn), 64):
        block = drawn[start : start + 64]
        got = lutgen.stability(
            np.stack([case.contacts for case in block]),
            np.stack([case.gravity for case in block]),
            channels=CHANNELS,
            upright=upright,
            rock_angle=rock_angle,
        )
        for name in CHANNELS:
            parts[name].append(np.diagonal(got[name]))
    return {name: np.concatenate(part) for name, part in parts.items()}


def describe(index: int, case: Case) -> str:
    """Say enough about a case to run it again."""
    return f"case {index} ({case.kind}): {case.contacts.tolist()}, {case.gravity.tolist()}"


def test_the_cases_are_of_every_kind_and_about_balanced_between_standing_and_tipping() -> None:
    stands = Counter[str]()
    tips = Counter[str]()
    boundless = 0
    for count in range(3, 9):
        for case, verdict in zip(cases(count, SOME), verdicts(count, SOME), strict=True):
            (stands if verdict.tip_angle >= 0.0 else tips)[case.kind] += 1
            boundless += verdict.tip_angle == pi
    # A constant answer would be wrong in at least a quarter of the cases.
    assert 0.25 < stands.total() / (stands.total() + tips.total()) < 0.75
    assert all(min(stands[kind], tips[kind]) >= part(20, 10) for kind in KINDS)
    assert boundless >= part(20, 10)


@pytest.mark.parametrize("count", range(3, 9))
def test_oracle_verdict_by_barycentrics_equals_its_verdict_by_planes(count: int) -> None:
    for case, verdict in zip(cases(count, SOME), verdicts(count, SOME), strict=True):
        planes = oracle.cone_tip_angle(case.contacts, case.gravity)
        # Two formulas for the same angle: asin loses half the digits near pi/2.
        assert verdict.tip_angle == pytest.approx(planes, abs=1e-8)
        assert verdict.convex
        if abs(planes) > LIMIT:
            assert verdict.stands == (planes > 0.0)


def test_oracle_polygon_of_coplanar_contacts_has_the_area_and_corners_of_qhull() -> None:
    rng = np.random.default_rng(20240617)
    for _ in range(200):
        for kind in ("one plane", "inside polygon", "on edges"):
            contacts = posture(rng, kind, int(rng.integers(5, 9))) @ rotation(rng).T
            (facet,) = oracle.support_facets(contacts)
            along = facet.points[1] - facet.points[0]
            flat = np.stack((along, np.cross(facet.normal, along)), axis=1) / np.sqrt(along @ along)
            hull = ConvexHull(contacts @ flat)
            fan = np.cross(facet.points[1:-1] - facet.points[0], facet.points[2:] - facet.points[0])
            # Corners are sums of a few numbers near 1; qhull may keep the middle of an edge.
            assert (fan @ facet.normal).sum() / 2.0 == pytest.approx(hull.volume, abs=1e-12)
            assert set(facet.polygon) <= set(hull.vertices)


@pytest.mark.parametrize("count", range(3, 9))
def test_oracle_verdict_equals_membership_of_the_convex_cone_of_the_contacts(count: int) -> None:
    for case, verdict in zip(cases(count, 100), verdicts(count, 100), strict=True):
        if abs(verdict.tip_angle) < 1e-6 or verdict.tip_angle == -pi:
            continue
        # nnls leaves about 1e-15 inside the cone and the sine of the angle to it outside.
        _, residual = nnls(case.contacts.T / oracle.size_of(case.contacts), case.gravity)
        assert verdict.stands == (residual < 1e-9)


@pytest.mark.parametrize(
    ("count", "total"),
    [(3, part(1500)), (4, part(2000)), (5, part(1700)), (6, part(1700))],
)
def test_verdict_sdg_height_and_tip_angle_equal_the_oracle(count: int, total: int) -> None:
    compare_with_oracle(count, total)


@pytest.mark.parametrize(("count", "total"), [(7, part(1600)), (8, part(1500))])
def test_verdict_sdg_height_and_tip_angle_equal_the_oracle_for_many_contacts(
    count: int, total: int
) -> None:
    compare_with_oracle(count, total)


def compare_with_oracle(
    count: int, total: int, upright: float | None = None, rock_angle: float | None = None
) -> None:
    """Hold lutgen to the oracle case by case."""
    drawn = cases(count, total, upright is not None)
    got = answers(drawn, upright, rock_angle)
    standing = tipping = 0
    for index, (case, want) in enumerate(
        zip(drawn, verdicts(count, total, upright, rock_angle), strict=True)
    ):
        where = describe(index, case)
        tip_angle = got["tip_angle"][index]
        # asin near +-pi/2 turns 1e-16 into 1e-8; elsewhere 1e-9 as for the lengths.
        assert tip_angle == pytest.approx(want.tip_angle, abs=3e-8), where
        if abs(np.sin(want.tip_angle)) < 0.99:
            assert tip_angle == pytest.approx(want.tip_angle, abs=RELATIVE), where
        if abs(want.tip_angle) < LIMIT:
            continue
        assert (tip_angle >= 0.0) == want.stands, where
        assert (got["facet"][index] >= 0.0) == want.stands, where
        if not want.stands:
            assert np.isnan(got["sdg"][index]), where
            assert np.isnan(got["height"][index]), where
            tipping += 1
            continue
        floor = FLOOR * oracle.size_of(case.contacts)
        assert any(
            got["height"][index] == pytest.approx(height, rel=RELATIVE, abs=0.0)
            and got["sdg"][index] == pytest.approx(sdg, rel=RELATIVE, abs=floor)
            for sdg, height in want.pierced
        ), f"{where}: {got['sdg'][index]}, {got['height'][index]} not in {want.pierced}"
        standing += 1
    assert min(standing, tipping) > total / 10


@pytest.mark.parametrize("limits", [(None, None), (UPRIGHT, ROCK_ANGLE)], ids=["free", "limited"])
@pytest.mark.parametrize("count", range(3, 9))
def test_margins_equal_the_oracle_on_both_sides_of_the_tipping_limit(
    count: int, limits: tuple[float | None, float | None]
) -> None:
    drawn = cases(count, SOME, limits[0] is not None)
    got = answers(drawn, *limits)
    for index, (case, want) in enumerate(zip(drawn, verdicts(count, SOME, *limits), strict=True)):
        if abs(want.tip_angle) < LIMIT:
            continue
        where = describe(index, case)
        size = oracle.size_of(case.contacts)
        assert (got["margin"][index] > 0.0) == want.stands, where
        # Over a ridge on a slope the robot may roll on until it tips, with no rise at all.
        assert (got["energy_margin"][index] >= 0.0) == want.stands, where
        # Distances and rises are differences of lengths of the robot's size.
        assert got["margin"][index] == pytest.approx(want.margin, rel=1e-7, abs=1e-9 * size), where
        energy = got["energy_margin"][index]
        if not want.stands:
            assert energy == pytest.approx(want.energy_margin, rel=1e-7, abs=1e-9 * size), where
        else:
            # The oracle's grid misses the top of a circle by up to 1e-3 squared over 8.
            assert any(
                energy == pytest.approx(barrier, rel=1e-7, abs=2e-7 * size)
                for barrier in barriers(case, *limits)
            ), f"{where}: {energy}, {barriers(case, *limits)}"


def barriers(
    case: Case, upright: float | None = None, rock_angle: float | None = None
) -> list[float]:
    """Return the oracle's energy margins of a robot that stands: of each facet that it may be on.

    Without rocking the least rise over a side of the facet; else the least barrier over up to
    twelve rolls.
    """
    facets = oracle.accepted(oracle.support_facets(oracle.distinct(case.contacts)), upright)
    found = []
    for facet in facets:
        if oracle.is_nearly_pierced(facet, case.gravity):
            if rock_angle is None:
                angle = pi if upright is None else upright
                found.append(least_barrier(case.contacts, facet.normal, case.gravity, angle, 12))
            else:
                sides = oracle.tip_over_axes([facet], 0.0)
                found.append(min(abs(oracle.axis_energy(side, case.gravity)) for side in sides))
    return found


@pytest.mark.parametrize("count", [3, 4, 5, 6, 8])
def test_limits_of_attitude_and_rocking_equal_the_oracle(count: int) -> None:
    compare_with_oracle(count, 200, UPRIGHT, ROCK_ANGLE)


def test_the_limited_cases_include_regions_that_are_not_convex() -> None:
    seen = [
        verdict
        for count in (3, 4, 5, 6, 8)
        for verdict in verdicts(count, 200, UPRIGHT, ROCK_ANGLE)
    ]
    bent = [verdict for verdict in seen if not verdict.convex]
    assert sum(verdict.stands for verdict in bent) >= 20
    assert sum(not verdict.stands for verdict in bent) >= 20
    # Not convex and yet the planes of all facets would say "stands" or "tips" alike is no test:
    # without the limits many of these directions change their verdict.
    free = [
        verdict
        for count in (3, 4, 5, 6, 8)
        for verdict in (
            oracle.judge(case.contacts, case.gravity) for case in cases(count, 200, True)
        )
    ]
    assert sum(a.stands != b.stands for a, b in zip(seen, free, strict=True)) >= 50
