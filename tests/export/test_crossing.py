"""Where arcs leave the standing region: both ends judged by `evaluate_each`, and on their arcs."""

import numpy as np
import pytest

from firmware_export.truth.crossing import cross_boundary
from firmware_export.truth.model import Model
from lutgen.channels import evaluate_each
from lutgen.recipe import Recipe, parse_recipe
from lutgen.recipe.recipe import load_recipe
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import tripod

PULL = '[[robot.force]]\nname = "pull"\nlink = "body"\nforce = [1.0, 2.0, -3.0]\n'


def loaded() -> Recipe:
    """Return a robot that something pulls at."""
    head, sweep = tripod().split("[sweep]")
    return parse_recipe(f"{head}{PULL}position = [0.1, 0.0, 0.2]\n[sweep]{sweep}")


def robot(name: str) -> Recipe:
    """Return a robot of the gallery, or the one that something pulls at."""
    return loaded() if name == "loaded" else load_recipe(MAPS / f"{name}.toml")


@pytest.mark.parametrize("name", ["paper_two", "absolem", "articulated", "loaded"])
def test_a_crossing_stands_on_one_side_and_tips_on_the_other(name: str) -> None:
    recipe, rng = robot(name), np.random.default_rng(5)
    ends = np.array([[p.minimum, p.maximum] for p in recipe.parameters])
    rows = rng.uniform(*ends.T, (200, len(ends)))
    downs = rng.normal(size=(200, 40, 3)) - [0.0, 0.0, 0.5]
    downs /= np.linalg.norm(downs, axis=-1, keepdims=True)
    angle = evaluate_each(recipe, rows, downs, ("tip_angle",))["tip_angle"]
    both = (angle.max(axis=1) >= 0.0) & (angle.min(axis=1) < 0.0)
    assert both.sum() > 100
    rows, downs, angle = rows[both], downs[both], angle[both]
    here = np.arange(len(rows))[:, None]
    # The four that stand best, each with one of the four that tip most.
    order = np.argsort(angle, axis=1)
    inside, outside = downs[here, order[:, -4:]], downs[here, order[:, :4]]
    keep = (angle[here, order[:, -4:]] >= 0.0).all(1) & (angle[here, order[:, :4]] < 0.0).all(1)
    rows, inside, outside = rows[keep], inside[keep], outside[keep]
    last, first = cross_boundary(Model(recipe), rows, inside, outside)
    for side, stands in ((last, True), (first, False)):
        found = evaluate_each(recipe, rows, side, ("tip_angle",))["tip_angle"]
        assert ((found >= 0.0) == stands).all()
        np.testing.assert_allclose(np.linalg.norm(side, axis=-1), 1.0, atol=1e-15)  # rounding
        # On the great circle of its ends, up to rounding: opposite ends would amplify that.
        normal = np.cross(inside, outside)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        assert np.abs((normal * side).sum(axis=-1)).max() < 1e-12
    apart = np.linalg.norm(last - first, axis=-1)
    assert np.quantile(apart, 0.8) < 1e-7
    # No step widens an arc, which is less than half a circle, and three of them halve it.
    assert apart.max() < np.pi / 8.0
    # Nothing was written over.
    assert (np.linalg.norm(inside - last, axis=-1) > 0.0).any()
