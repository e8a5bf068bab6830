"""The paper's choice of the three wheels that stand on the ground, against the convex hull.

Owns the two tests of the method ("point error" and "intersection error") for point contacts and
the comparison with the hull's facets.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# A contact this far from a plane, relative to the largest coordinate, is on it.
ON_PLANE = 1e-9


@dataclass(frozen=True)
class TripleStatistics:
    """How often the paper's tests found the hull's facet.

    Attributes
    ----------
    sets : int
        Random contact sets.
    agree : int
        Of these, with the same wheels by both ways, none included.
    tipping : int
        Of these, with no facet under gravity's ray.
    most_passing : int
        Largest number of triples of one set that passed both tests.
    """

    sets: int
    agree: int
    tipping: int
    most_passing: int


def passing_triples(contacts: Array, gravity: Array) -> list[tuple[int, int, int]]:
    """Return the triples that pass both tests of the paper, in ascending order.

    Parameters
    ----------
    contacts : (n, 3) float64
        Contact points relative to the com.
    gravity : (3,) float64
        Pointing down, any length.

    Returns
    -------
    list of tuple
        At most one where no four contacts are coplanar.  "Point error": another contact lies
        beyond the triple's plane along gravity.  "Intersection error": gravity's ray misses the
        inside of the triangle.  Collinear triples, planes parallel to gravity and planes through
        the com never pass.
    """
    near = ON_PLANE * float(np.abs(contacts).max())
    found: list[tuple[int, int, int]] = []
    for triple in combinations(range(len(contacts)), 3):
        corners = contacts[list(triple)]
        across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        length = float(np.linalg.norm(across))
        if length <= near * near or abs(across @ gravity) <= 0.0:
            continue
        outward = across / length * np.sign(across @ gravity)
        if ((contacts - corners[0]) @ outward > near).any():
            continue
        if abs(outward @ corners[0]) > near and (np.linalg.solve(corners.T, gravity) > 0.0).all():
            found.append(triple)
    return found


def leaving_facet(contacts: Array, gravity: Array) -> tuple[int, int, int] | None:
    """Return the facet of the convex hull through which gravity's ray leaves it.

    Parameters
    ----------
    contacts : (n, 3) float64
        At least four points that are not coplanar.
    gravity : (3,) float64
        Pointing down, any length.

    Returns
    -------
    tuple or None
        Its three contacts in ascending order; None if the ray misses the hull.

    Notes
    -----
    The hull is cut out of the ray by one half-space after the other; no triangle is looked at.
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
    """Compare the paper's tests with the hull on random sets of 4 to 7 contacts.

    Parameters
    ----------
    sets : int
        How many.
    seed : int
        Of the contacts, uniform in a cube around the com, and of gravity, uniform on the sphere.

    Returns
    -------
    TripleStatistics
        With `agree` equal to `sets` and `most_passing` equal to 1 if the tests are right.
    """
    rng = np.random.default_rng(seed)
    agree = tipping = most = 0
    for i in range(sets):
        contacts = rng.uniform(-1.0, 1.0, (4 + i % 4, 3))
        gravity = rng.normal(size=3)
        passing = passing_triples(contacts, gravity)
        facet = leaving_facet(contacts, gravity)
        agree += passing == ([] if facet is None else [facet])
        tipping += facet is None
        most = max(most, len(passing))
    return TripleStatistics(sets, agree, tipping, most)
