"""The paper's choice of the three wheels that stand on the ground, against the convex hull.

Owns the two tests of the method ("point error" and "intersection error") for point contacts and
the comparison with the hull's facets.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from lutgen.paper.nominal import Array

# A contact this far from a plane, relative to the largest coordinate, is on it.
ON_PLANE = 1e-9
# Contacts of the random sets, in turn.
CONTACTS = (4, 5, 6, 7)


@dataclass(frozen=True)
class TripleStatistics:
    """How often the paper's tests found the hull's facet.

    Of `sets` random sets of contacts, `agree` have the same wheels by both ways, none included,
    and `tipping` no facet under gravity's ray; `most_passing` is the largest number of triples of
    one set that passed both tests.
    """

    sets: int
    agree: int
    tipping: int
    most_passing: int


def passing_triples(contacts: Array, gravity: Array) -> list[tuple[int, int, int]]:
    """Return the triples of contacts (n, 3) that pass both tests of the paper, in order.

    At most one where no four contacts are coplanar.  "Point error": another contact lies beyond
    the triple's plane along gravity.  "Intersection error": gravity's ray misses the inside of
    the triangle.  Collinear triples, planes parallel to gravity and planes through the com never
    pass.
    """
    near = ON_PLANE * float(np.abs(contacts).max())
    triples = list(combinations(range(len(contacts)), 3))
    corners = contacts[np.array(triples)]
    first = corners[:, 0]
    across = np.cross(corners[:, 1] - first, corners[:, 2] - first)
    length, rate = np.linalg.norm(across, axis=1), across @ gravity
    # Neither collinear nor parallel to gravity.
    kept = (length > near * near) & (rate != 0.0)
    outward = across / np.where(kept, length, 1.0)[:, None] * np.sign(rate)[:, None]
    offset = (outward * first).sum(axis=1)
    kept &= (outward @ contacts.T - offset[:, None] <= near).all(axis=1) & (np.abs(offset) > near)
    return [
        triples[i]
        for i in np.flatnonzero(kept)
        if (np.linalg.solve(corners[i].T, gravity) > 0.0).all()
    ]


def leaving_facet(contacts: Array, gravity: Array) -> tuple[int, int, int] | None:
    """Return the facet of the convex hull through which gravity's ray leaves it, if any.

    The hull of at least four contacts (n, 3) is cut out of the ray by one half-space after the
    other; no triangle is looked at.
    """
    from scipy.spatial import ConvexHull

    hull = ConvexHull(contacts)
    rate = hull.equations[:, :3] @ gravity
    offset = hull.equations[:, 3]
    if ((rate == 0.0) & (offset > 0.0)).any():
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        at = -offset / rate
    enter = at[rate < 0.0].max()
    out = np.where(rate > 0.0, at, np.inf)
    leave = int(out.argmin())
    if out[leave] <= max(float(enter), 0.0):
        return None
    first, second, third = sorted(int(i) for i in hull.simplices[leave])
    return first, second, third


def triple_statistics(sets: int = 2000, seed: int = 20) -> TripleStatistics:
    """Compare the paper's tests with the hull on random sets of contacts.

    Contacts are uniform in a cube around the com, gravity is uniform on the sphere.  If the tests
    are right, `agree` is `sets` and `most_passing` is 1.
    """
    rng = np.random.default_rng(seed)
    agree = tipping = most = 0
    for i in range(sets):
        contacts = rng.uniform(-1.0, 1.0, (CONTACTS[i % len(CONTACTS)], 3))
        gravity = rng.normal(size=3)
        passing = passing_triples(contacts, gravity)
        facet = leaving_facet(contacts, gravity)
        agree += passing == ([] if facet is None else [facet])
        tipping += facet is None
        most = max(most, len(passing))
    return TripleStatistics(sets, agree, tipping, most)
