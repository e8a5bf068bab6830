"""Robots that cannot change their shape: what holds them compiles clean and answers."""

import numpy as np
import pytest

from firmware_export.codecs import usable
from firmware_export.emit import package
from firmware_export.model import Model
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import parse_recipe
from tests.fixtures.compiled import STRICT, HostLibrary, compile_c
from tests.fixtures.fits import few_points
from tests.fixtures.recipes import feet, rigid

CORNERS = [(0.3, 0.2, -0.4), (-0.3, 0.2, -0.4), (0.0, -0.3, -0.4), (0.35, -0.2, -0.4)]
# Its centre of mass is below all contacts: no posture has a facet to make room for.
HUNG = '[[robot.link]]\nname = "body"\nmass = 3.0\ncom = [0, 0, -2.0]\n'
# Three contacts as `grid` gave warnings at some level; four did not export as `grid` at all.
KINDS = [
    *((3, "", codec, "float") for codec in ("contacts", "grid")),
    (3, "", "grid", "integer"),
    (4, "", "contacts", "float"),
    (4, "", "grid", "integer"),
    (4, HUNG, "contacts", "float"),
]


@pytest.mark.parametrize(("count", "body", "codec", "arithmetic"), KINDS)
def test_a_robot_of_fixed_shape_compiles_clean_and_is_never_falsely_safe(
    tmp_path, count, body, codec, arithmetic
):
    model = Model(parse_recipe(rigid(body + feet(CORNERS[:count]))))
    with few_points():
        export = usable(model, arithmetic, codec)[0].export(model, "rigid", EXPORTABLE, arithmetic)
        package.write(export, tmp_path)
    # Many contacts take a compiler seconds.
    for level in ("-Os",) if count > 3 else ("-O3", "-Os"):
        words = [*STRICT, level, "-std=c99", "-ffp-contract=off", "-I."]
        compile_c([*words, "-c", "rigid.c", "-o", "rigid.o"], tmp_path)

    rng = np.random.default_rng(3)
    gravity = np.column_stack([rng.uniform(-1.2, 1.2, (4000, 2)), -np.ones(4000)])
    gravity = np.rint(gravity * 16000.0)
    library, none = HostLibrary(tmp_path), np.zeros((4000, 0))
    said = (library.read_i if arithmetic == "integer" else library.read)(none, gravity)[0]
    exact = model.exact(np.zeros((1, 0)), gravity[None]).tip_angle[0]
    safe = np.isin(said, (0, 1))
    assert not (safe & (exact < 0.0)).any()
    # A table of the smallest size gives up a part; a constant would give up all, or be unsafe.
    assert safe[exact > 0.1].mean() > 0.5 if not body else not safe.any()
