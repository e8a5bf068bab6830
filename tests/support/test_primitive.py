"""The kinds of contact primitives have one number each in the whole product."""

import ast
from pathlib import Path

import lutgen
from lutgen.analysis import rolling
from lutgen.recipe.kinematics import radii_and_kinds
from lutgen.support import primitive
from tests.fixtures.recipes import rover

ROOT = Path(lutgen.__file__).resolve().parents[1]


def numbered(path):
    """Return the kinds that a file gives a number; a region has a column called POINT."""
    names = {
        name.id
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Assign)
        for target in node.targets
        for name in ast.walk(target)
        if isinstance(name, ast.Name)
    }
    return names & {"SPHERE", "DISC"}


def test_one_file_gives_the_kinds_their_numbers():
    files = [path for name in ("lutgen", "firmware_export") for path in (ROOT / name).rglob("*.py")]
    found = {path.stem: numbered(path) for path in files if numbered(path)}
    assert found == {"primitive": {"SPHERE", "DISC"}}


def test_a_disc_is_a_disc_where_it_rolls_and_where_it_stands():
    kinds = radii_and_kinds(lutgen.parse_recipe(rover()))[1]
    assert set(kinds.tolist()) == {primitive.DISC}
    assert (rolling.SPHERE, rolling.DISC) == (primitive.SPHERE, primitive.DISC)
    assert rolling.BRAKED not in (primitive.SPHERE, primitive.DISC)
