"""What exports compile to by themselves, of every codec: the bits that the certificate saw."""

import numpy as np
import pytest

from firmware_export.codecs import usable
from firmware_export.emit import package
from firmware_export.host import Host
from firmware_export.model import Model
from firmware_export.protocol import describe
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import parse_recipe
from proofs.subjects import SUBJECTS
from targets.cases import of_robot
from tests.fixtures.compiled import FLAGS, STRICT, HostLibrary, compile_c
from tests.fixtures.fits import few_points
from tests.fixtures.length import LONG, part
from tests.fixtures.queries import integer_queries, random_queries
from tests.fixtures.recipes import feet, quadruped, rigid

OK, ROCKS, TIPS, OFF_CHART, OFF_RANGE, INVALID = 0, 1, 2, 3, 4, 6
# Without optimisation: with it the checks take the compiler up to half a minute, and it may leave
# out what it can tell is undefined before a check sees it.  The square root is that of chips
# without one.
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g", "-O0")
SANITIZERS += ("-DSMAP_SOFT_ROOT",)
# Fast code with the square root in software; small code is what chips are asked, too.
BUILDS = (("-O3", "-DSMAP_SOFT_ROOT"),)
if LONG:
    BUILDS += (("-Os",), ("-O3",), ("-DSMAP_SOFT_ROOT",))
# How a Cortex-M finds a whole root.
DIVIDES = ("-D__ARM_FEATURE_IDIV=1", "-D__ARM_FEATURE_CLZ=1")
# A robot that stands on balls.
MADE = SUBJECTS | {"quadruped": lambda: of_robot(quadruped(), "quadruped", "contacts")}
# Many contacts take up to 20 us a query.
CASES = {
    "paper_two": part(300_000),
    "absolem": part(40_000),
    "articulated": part(20_000),
    "tractor": part(20_000),
    "quadruped": part(20_000),
    "legs_by_code": part(100_000),
    "wheels_by_code": part(20_000),
    "tables_float": part(300_000),
    "tables_integer": part(300_000),
}
# Whose code is that of another one.
LIKE_ANOTHER = ("tractor", "quadruped", "wheels_by_code")


@pytest.mark.parametrize("name", CASES)
def test_every_build_of_an_export_gives_the_bits_of_the_host_and_does_nothing_undefined(
    name, tmp_path
):
    export, count = MADE[name](), CASES[name]
    package.write(export, tmp_path / "out")
    way, queries = ("read_i", integer_queries) if export.integer else ("read", random_queries)
    params, gravity = queries(export.model, count)
    status, reading = getattr(Host(describe(export)), way)(params, gravity)
    builds = [(flags, count) for flags in (*BUILDS, *[DIVIDES] * export.integer)]
    if name not in LIKE_ANOTHER:
        builds.append((SANITIZERS, count // 10))
    for flags, most in builds:
        own = HostLibrary(tmp_path / "out", (*FLAGS, *flags))
        found = getattr(own, way)(params[:most], gravity[:most])
        np.testing.assert_array_equal(found[0], status[:most])
        assert found[1].tobytes() == reading[:most].tobytes()
    # All answers occur, each many times; no direction is off a chart of the whole sphere.
    kinds, times = np.unique(status, return_counts=True)
    wanted = {INVALID, OK, TIPS, OFF_RANGE} - ({INVALID} if export.integer else set())
    wanted |= {OFF_CHART} if export.model.faces == 1 else set()
    assert wanted <= set(kinds.tolist()) <= {*wanted, ROCKS, INVALID}
    # Some rock only on slivers: seldom.
    assert times[np.isin(kinds, list(wanted))].min() > count // 3000


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
