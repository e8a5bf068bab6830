"""The errata of the paper that lutgen computes: printed forms are wrong, its own right.

A case returns what decides in three ways: by the form as printed, by lutgen, and by a way that
knows neither.  Errata of algebra alone change with no code, and of forces, search, path and
Table 1 other tests have the right numbers.  The com is the body frame's origin.
"""

import math
import tomllib
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import lutgen
from lutgen.analysis import heuristic_forces
from tests.fixtures.places import ROOT

ROWS = tomllib.loads((ROOT / "lutgen/paper/errata.toml").read_text())["erratum"]
# Two ways to one number pass a few 3 x 3 solves of numbers below 1000.
ROUNDING = 1e-9
# Weights of a fourth contact in the plane of three, behind an edge.
FOURTH = np.array([-0.8, 1.1, 0.7])


def robot(seed):
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0.0, 2.0 * np.pi) + np.array([0.0, 2.0, 4.0]) + rng.uniform(-0.3, 0.3, 3)
    radius, below = rng.uniform(6.0, 14.0, 3), rng.uniform(-9.0, -6.0, 3)
    wheels = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), below])
    g = rng.uniform(1.0, 20.0) * np.append(rng.uniform(-0.2, 0.2, 2), -1.0)
    return SimpleNamespace(P=wheels, g=g, n=normal_of(wheels))


def normal_of(points):
    """Return the unit normal of Eq 1 with c >= 0."""
    across = np.cross(points[1] - points[0], points[2] - points[0])
    return across * math.copysign(1.0, across[2]) / np.linalg.norm(across)


def pierced(wheels, gravity):
    """Return D_g from the line and the plane P1 + u (P2 - P1) + v (P3 - P1)."""
    matrix = np.column_stack([gravity, wheels[0] - wheels[1], wheels[0] - wheels[2]])
    return gravity * np.linalg.solve(matrix, wheels[0])[0]


def foot(wheels):
    """Return D_c, the point of the wheels' plane nearest to the com."""
    edges = np.column_stack([wheels[1] - wheels[0], wheels[2] - wheels[0]])
    return wheels[0] - edges @ np.linalg.lstsq(edges, wheels[0], rcond=None)[0]


def tip_angle(contacts, gravity):
    found = lutgen.stability(contacts[None], np.atleast_2d(gravity), ("tip_angle",))
    return found["tip_angle"][0]


def centre(contacts):
    """Return the centroid of coplanar contacts by Green's theorem, their order by angle."""
    flat = contacts[:, :2] - contacts[:, :2].mean(axis=0)
    corners = flat[np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))]
    ahead = np.roll(corners, -1, axis=0)
    doubled = corners[:, 0] * ahead[:, 1] - ahead[:, 0] * corners[:, 1]
    middle = ((corners + ahead) * doubled[:, None]).sum(axis=0) / (3.0 * doubled.sum())
    slope = np.linalg.lstsq(flat, contacts[:, 2] - contacts[:, 2].mean(), rcond=None)[0]
    return np.append(middle, slope @ middle) + contacts.mean(axis=0)


def edge_distance(triangle, point):
    """Return the distance of a point inside a triangle from the nearest edge."""
    along = np.roll(triangle, -1, axis=0) - triangle
    across = np.linalg.norm(np.cross(along, point - triangle), axis=1)
    return (across / np.linalg.norm(along, axis=1)).min()


def passing(contacts, gravity):
    """Return the triples that pass the paper's point error and intersection error."""
    found = []
    for triple in map(list, combinations(range(len(contacts)), 3)):
        n = normal_of(contacts[triple])
        n = n * np.sign(n @ gravity)
        none_beyond = (contacts @ n - n @ contacts[triple[0]]).max() < 1e-9
        if none_beyond and (np.linalg.solve(contacts[triple].T, gravity) > 0.0).all():
            found.append(triple)
    return found


def leaving(contacts, gravity):
    """Return the hull's facet by which gravity's ray leaves it, cut by its half-spaces."""
    hull = ConvexHull(contacts)
    rate, offset = hull.equations[:, :3] @ gravity, hull.equations[:, 3]
    at = -offset / rate
    out = np.where(rate > 0.0, at, np.inf)
    if out.min() <= max(at[rate < 0.0].max(), 0.0):
        return []
    return [sorted(hull.simplices[out.argmin()])]


def line_or_ray(r):
    half = np.random.default_rng(20).normal(size=(200, 3))
    down = np.vstack([half, -half])
    rate = down @ r.n / (r.n @ r.P[0])
    inside = (np.linalg.solve(r.P.T, down.T) / rate > 0.0).all(axis=0)
    yield inside.sum(), (inside & (rate > 0.0)).sum(), (tip_angle(r.P, down) >= 0.0).sum()


def triple_and_hull(r):
    rng = np.random.default_rng(20)
    sets = [(rng.uniform(-1, 1, (4 + i % 4, 3)), rng.normal(size=3)) for i in range(100)]
    same = sum(passing(*one) == leaving(*one) for one in sets)
    yield len(sets), same, len(sets)
    # Both answers are common: neither "always" nor "never" would pass.
    assert 20 < sum(not leaving(*one) for one in sets) < 80


def four_coplanar_wheels(r):
    wheels = np.vstack([r.P, FOURTH @ r.P])
    triples = passing(wheels, r.g)
    at = pierced(wheels, r.g)
    first = np.linalg.norm(at - wheels[triples[0]].mean(axis=0))
    ours = lutgen.stability(wheels[None], r.g[None], ("sdg",))["sdg"][0, 0]
    yield first, ours, np.linalg.norm(at - centre(wheels))
    yield 1, len(triples), 2


def sign_of_eq_12(r):
    for n in (3, 4, 6):
        points = np.column_stack([20.0 * np.cos(np.arange(n)), 20.0 * np.sin(np.arange(n))])
        points, off = np.column_stack([points, np.zeros(n)]), np.array([1.0, 2.0, 0.0])
        distances = np.linalg.norm(points - off, axis=1)
        shares = -(distances.sum() / (n / 2) - distances) / distances.sum()  # as printed
        yield shares.sum(), heuristic_forces(points, off).sum(), 1.0
        assert heuristic_forces(points, off) == pytest.approx(-shares, abs=1e-12)


def objective(r):
    low, high = r.P, r.P + foot(r.P)
    truth = math.atan(edge_distance(low, foot(low)) / np.linalg.norm(foot(low)))
    yield tip_angle(high, foot(low))[0], tip_angle(low, foot(low))[0], truth


CASES = {
    "text before Eq 3": line_or_ray,
    "text before Eq 3, point error and intersection error": triple_and_hull,
    "text before Eq 8, first successful case": four_coplanar_wheels,
    "Eq 12, sign": sign_of_eq_12,
    "block diagram, Figure 6": objective,
}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("place", CASES)
def test_the_correction_is_right_and_the_printed_form_is_as_the_list_says(place, seed):
    (row,) = (row for row in ROWS if row["place"] == place)
    for printed, ours, reference, *allowed in CASES[place](robot(seed)):
        tolerance = allowed[0] if allowed else ROUNDING
        assert abs(ours - reference) <= tolerance
        assert bool(abs(printed - reference) <= tolerance) is row.get("confirmed", False)
