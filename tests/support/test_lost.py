"""Facets of wheels that lie nearly flat: the search must not lose its way on their rims."""

import math

import numpy as np

from lutgen.channels import evaluate_each
from lutgen.recipe import forward, parse_recipe, radii_and_kinds
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
from tests.fixtures.odd_robots import odd_robot
from tests.fixtures.recipes import contact, sweep_part

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


def facets_of(seed: int, params: list[float]) -> list[tuple[np.ndarray, set[int]]]:
    """Return the normals and contacts of the facets of a random robot that face down."""
    recipe = odd_robot(seed)
    where, (radius, kind) = forward(recipe, [params]), radii_and_kinds(recipe)
    table = facet_table(len(radius))
    stand(
        table,
        empty_region(len(radius)),
        pack(where.centres[0], where.axes[0], radius, kind),
        LIMITS,
    )
    hull = table.hull
    return [
        (hull.facet[f, :3], set(hull.link[slice(*hull.span[f : f + 2, 0]), 0].tolist()))
        for f in range(hull.tally[0])
    ]


def test_facets_that_only_those_above_the_horizon_join_to_others_are_found() -> None:
    for params in ([-2.989064, -0.149233, -1.724806], [-2.989064, -0.149233, -1.7]):
        assert any(carriers == {3, 4, 5} for n, carriers in facets_of(1419, params) if n[2] < 0.0)


def test_a_contact_that_carries_for_a_moment_while_a_leaning_wheel_rolls_is_not_missed() -> None:
    found = facets_of(1119, [0.086476, -0.011551, 2.057765, 1.692075])
    assert any({3, 5, 7} <= carriers for _, carriers in found)


def track(wheels: tuple[float, ...]) -> str:
    """Return a recipe of a car whose front wheels of one size stand in a row on a link."""
    rows = "".join(
        contact(f"{name}{side}{k}", (x, y, -0.1), 0.1, (0, 1, 0), link)
        for side, y in (("left", 0.3), ("right", -0.3))
        for name, link, places in (("front", "flipper", wheels), ("rear", "body", (-0.5,)))
        for k, x in enumerate(places)
    )
    return (
        '[robot]\nname = "track"\nlength_unit = "m"\n'
        '[[robot.parameter]]\nname = "pitch"\nmin = -180\nmax = 180\nunit = "deg"\n'
        '[[robot.link]]\nname = "body"\nmass = 5\ncom = [0, 0, 0.1]\n'
        '[[robot.link]]\nname = "flipper"\nparent = "body"\norigin = [0.4, 0, 0]\n'
        'joint = { type = "revolute", axis = [0, 1, 0], parameter = "pitch" }\n'
        + rows
        + sweep_part("pitch = 2")
    )


def test_wheels_of_one_size_in_a_row_carry_as_the_outer_two_of_them() -> None:
    # Rounding had each of them above the next, round and round, until there was no more room.
    rng = np.random.default_rng(2)
    pitch = rng.uniform(-math.pi, math.pi, (3000, 1))
    g = rng.normal(size=(3000, 3)) - (0.0, 0.0, 1.5)
    wanted = ("tip_angle", "status")
    whole = evaluate_each(parse_recipe(track((0.0, 0.21, 0.37, 0.6))), pitch, g, wanted)
    outer = evaluate_each(parse_recipe(track((0.0, 0.6))), pitch, g, wanted)
    assert (whole["status"] == outer["status"]).mean() > 0.999
    assert 0.2 < (outer["status"] == 0).mean() < 0.9
    both = (whole["status"] == 0) & (outer["status"] == 0)
    assert np.abs(whole["tip_angle"] - outer["tip_angle"])[both].max() < 1e-6
