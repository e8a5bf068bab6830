"""T_g: how gravity turns in the body of a robot that is put on a plane."""

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.channels import body_gravity, evaluate_each
from lutgen.errors import InputError
from tests.fixtures.recipes import feet, rigid, tripod

UP = np.array([0.0, 0.0, 1.0])


def settled(points, gravity):
    """Return gravity in the body for a robot of points, the slow way: SciPy's hull and Rodrigues.

    Of the facets below the com on which it stands when they lie on the plane, the flattest.
    """
    hull = ConvexHull(points)
    best, best_up, nearest, nearest_sine = None, -2.0, gravity, -2.0
    for corners, (*normal, offset) in zip(hull.simplices, hull.equations, strict=True):
        outward = np.array(normal)
        if offset >= 0.0 or outward[2] >= 0.0:
            continue
        hinge = np.cross(UP, -outward)
        angle = math.atan2(np.linalg.norm(hinge), -outward[2])
        turn = Rotation.from_rotvec(hinge / np.linalg.norm(hinge) * angle)
        down = turn.apply(gravity)
        share = np.linalg.solve(points[corners].T, down)
        triangle = points[corners]
        sines = []
        for i in range(3):
            wall = np.cross(triangle[i - 1], triangle[i])
            wall *= np.sign(wall @ triangle[(i + 1) % 3]) / np.linalg.norm(wall)
            sines.append(float(wall @ down))
        if (share > 0.0).all() and -outward[2] > best_up:
            best, best_up = down, -outward[2]
        if min(sines) > nearest_sine:
            nearest, nearest_sine = down, min(sines)
    return nearest if best is None else best


def test_robots_with_several_facets_settle_as_a_slow_hull_says():
    random = np.random.default_rng(11)
    tips = stands = 0
    for _ in range(200):
        points = random.normal(size=(7, 3)) * [1.0, 1.0, 0.4] - [0.0, 0.0, 0.3]
        gravity = np.append(random.normal(0.0, 0.6, 2), -1.0)
        gravity /= np.linalg.norm(gravity)
        # As narrow and as steep as the slow hull's facets.
        head = "upright = 90.0\nrest_width = 0.0"
        recipe = lutgen.parse_recipe(rigid(feet(points.tolist()), head=head))
        down = body_gravity(recipe, np.empty((1, 0)), gravity, "plane")
        assert down[0] == pytest.approx(settled(points, gravity), abs=1e-11)
        tipping = evaluate_each(recipe, np.empty((1, 0)), down)["tip_angle"][0] < 0.0
        tips, stands = tips + int(tipping), stands + int(not tipping)
    assert tips > 5
    assert stands > 40


def test_wrong_words_and_shapes_are_refused():
    recipe = lutgen.parse_recipe(tripod())
    with pytest.raises(InputError, match="unknown convention 'P'; choose from body, plane"):
        body_gravity(recipe, [[0.1, 0.1]], [0, 0, -1], "P")
    with pytest.raises(InputError, match=r"\(3,\) or \(1, 3\) \(got \(2, 3\)\)"):
        body_gravity(recipe, [[0.1, 0.1]], [[0, 0, -1], [0, 0, -1]], "plane")
