"""Facets of wheels that lie nearly flat: the search must not lose its way on their rims."""

import math

import numpy as np

from lutgen.support import (
    edges_at,
    empty_region,
    facet_table,
    facets_in,
    pack,
    source_at,
    stand,
    support_height,
)
from lutgen.support.region import acceptance

LIMITS = acceptance(math.radians(80), math.radians(45), 0.0, 0.009, 9e-5)


def rows(lift: float) -> np.ndarray:
    """Return eight contacts; the tilted wheels touch where their rims run ahead."""
    centres = [
        [-0.0557, -0.448, -0.1113],
        [0.5245, -0.2084, -0.0616],
        [0.406, 0.1421, -0.3372],
        [0.4214, 0.368, -0.3],
        [0.1011, -0.448, -0.3],
        [0.2199, -0.2084, -0.3],
        [0.5516, 0.1421, -0.1841],
        [0.0298, 0.368, -0.2733 + lift],
    ]
    axes = np.zeros((8, 3))
    axes[:2] = (0.0, 1.0, 0.0)
    axes[3] = (0.4544, -0.5575, 0.6947)
    axes[6] = (0.7495, 0.6606, -0.0422)
    axes[7] = (-0.9533, 0.2044, 0.2223)
    axes[3:] /= np.maximum(np.linalg.norm(axes[3:], axis=1), 1e-300)[:, None]
    radii = np.array([0.2561, 0.2058, 0.0, 0.2387, 0.1131, 0.0361, 0.2988, 0.0201])
    return pack(np.array(centres), axes, radii, np.array([2, 2, 0, 2, 1, 1, 2, 2]))


def test_the_contacts_of_a_facet_lie_on_its_plane_and_nothing_lies_below() -> None:
    found = 0
    for lift in np.linspace(-0.05, 0.05, 41):
        robot = rows(float(lift))
        table, region = facet_table(8), empty_region(8)
        stand(table, region, robot, LIMITS)
        for k in range(facets_in(region.tally)):
            f = source_at(region.span, k)
            normal, height = table.hull.facet[f, :3], table.hull.facet[f, 3]
            corners = table.hull.corner[slice(*edges_at(table.hull.span, f))]
            # Noise joins what is within 1e-9; the search was lost by 1e-5 to 1e-2.
            assert np.abs(corners @ normal - height).max() < 1e-6
            assert max(support_height(robot, i, tuple(normal)) for i in range(8)) < height + 1e-6
            found += 1
    assert found > 80
