"""The codec `grid`: tables of positions and of lengths, and trees that are never too safe."""

import subprocess
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware_export.certify.answers import device
from firmware_export.emit import package
from firmware_export.grid import codec as grid
from firmware_export.grid import fit as grid_fit
from firmware_export.grid import lookup
from firmware_export.grid.points import bounds, depends_on, fit_point
from firmware_export.grid.spec import Spec, of_nodes
from firmware_export.grid.tables import Tables, Trees, places_of
from firmware_export.protocol.exported import Export
from firmware_export.truth import biased, uniform, widened
from firmware_export.truth.model import Exact, Model
from firmware_export.verdict import codec as verdict
from firmware_export.verdict import middles
from firmware_export.verdict.fold import FLAT, fold_of, folded
from firmware_export.verdict.grow import Forest, Nodes
from firmware_export.verdict.middles import Middles
from firmware_export.verdict.outline import Slab, View, draw, empty_sheet, may_tip, view_of
from firmware_export.verdict.planes import kept_by
from firmware_export.verdict.prove import prove
from firmware_export.verdict.prune import HALF, INNER, SAFE
from firmware_export.verdict.tree import fitting, packed, whole
from lutgen.jit import njit
from lutgen.quantities import EXPORTABLE
from lutgen.recipe.recipe import load_recipe, parse_recipe
from targets.noise import noise
from tests.export.test_programs import STRICT
from tests.fixtures.compiled import compile_c
from tests.fixtures.fits import few_points
from tests.fixtures.recipes import CAR, contact, rigid, rover, sweep_part, tripod

OK, OFF_CHART = 0, 3


@pytest.fixture(scope="module")
def model() -> Model:
    return Model(load_recipe("maps/paper_two.toml"))


@pytest.fixture(scope="module", autouse=True)
def small_samples() -> Iterator[None]:
    """Fit on few points."""
    with few_points():
        yield


def places(model: Model, count: int, seed: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return params and gravity, a third of the coordinates at an end."""
    rng = np.random.default_rng(seed)
    x = rng.random((count, model.k + 2))
    x = np.where(rng.random(x.shape) < 1 / 3, np.round(x), x)
    u, v = ((2.0 * x[:, model.k :] - 1.0) * model.chart_limit).T
    params = model.lower + (model.upper - model.lower) * x[:, : model.k]
    gravity = model.uv_to_gravity(rng.integers(0, model.faces, count), u, v)
    return params.astype(np.float32), gravity.astype(np.float32)


def truth(model: Model, params: NDArray[np.float32], gravity: NDArray[np.float32]) -> Exact:
    return model.exact(params.astype(np.float64), gravity[:, None].astype(np.float64))


def export_of(model: Model, tables: Tables, arithmetic: str = "float") -> Export:
    return Export("robot", model.recipe, model, "grid", arithmetic, tables.channels, tables)


@pytest.fixture(scope="module", params=["float", "integer"])
def looked_up(request: pytest.FixtureRequest, model: Model) -> Export:
    tables = lookup.encode(model, EXPORTABLE, lookup.Spec(16, ((1, 7), (7, 1), (1, 1))))
    return Export("two", model.recipe, model, "grid", request.param, EXPORTABLE, tables)


def test_three_contacts_looked_up_are_never_safer_than_the_truth_and_as_exact_in_every_direction(
    model: Model, looked_up: Export
) -> None:
    params, gravity = places(model, 40_000, 3)
    if looked_up.integer:
        share = (params - model.lower) / (model.upper - model.lower)
        params = np.rint(share * 32767.0).astype(np.int16)
        gravity = np.rint(gravity / np.abs(gravity).max(axis=1, keepdims=True) * 32000.0)
    reader = device(looked_up)
    status, reading = reader.read(params, gravity)
    values = reader._units(reading)
    asked = model.at(params / 32767.0) if looked_up.integer else params.astype(np.float64)
    exact = model.exact(asked, np.asarray(gravity, np.float64)[:, None])
    safe = status == OK
    tip = exact.tip_angle[:, 0]
    assert not np.any(safe & (tip < 0.0))
    # An arcsine of 1/32767 is off by up to 0.008 rad where the sine is near 1.
    low = np.minimum(tip, 1.4)
    assert np.all(
        values[safe, 1] <= low[safe] + (0.01 if looked_up.integer else 0.0) + (tip > 1.4)[safe]
    )
    assert safe[tip > 3.0 * looked_up.tables.guard].all()
    span = np.ptp(exact.sdg[tip >= 0.0, 0])
    # Seven nodes over 51 degrees: chords of 8.5 degrees, halved by the fit, are off by 0.07 %.
    assert np.abs(values[safe, 0] - exact.sdg[safe, 0]).max() < 0.01 * span
    assert np.abs(values[safe, 2] - exact.height[safe, 0]).max() < 0.003 * 23.3
    assert looked_up.tables.bytes < 100


def test_a_point_has_the_axes_on_which_it_depends(model: Model) -> None:
    wide, unit = bounds(model)
    for foot, axes in ((0, (0,)), (1, (1,)), (2, ())):
        assert depends_on(wide, foot) == axes
        assert fit_point(wide, foot, (5,) * len(axes), 16, unit).codes.shape == (5,) * len(axes) + (
            3,
        )


def test_a_size_grows_along_one_parameter_at_a_time_and_is_read_from_its_label(
    model: Model,
) -> None:
    first, wider = lookup.start(model, EXPORTABLE, "float")
    assert (first.bits, wider.bits) == (8, 16)
    grown = lookup.grow(model, first)
    assert len(grown) == 3
    for spec in grown:
        assert lookup.read_label(spec.label) == spec
        assert spec.bytes > first.bytes
        assert lookup.encode(model, EXPORTABLE, spec).spec == spec


def walked(tree: bytes, bits: int, x: list[int]) -> bool:
    """Tell what a tree says of a place (d,), 0 to 65535: written from docs/reference/format.md."""
    d, leaf = len(x), (12 + 7 * len(x) + 7) // 8
    x = list(x)
    u, x[-2] = divmod(x[-2] << bits, 65536)
    v, x[-1] = divmod(x[-1] << bits, 65536)
    cell = u * 2**bits + v
    mine, at = divmod(int.from_bytes(tree[2 * cell : 2 * cell + 2], "little"), 1 << 14)
    while mine == 3:
        head = tree[at]
        axis, kinds = head % 16, (head // 16 % 4, head // 64)
        upper, x[axis] = divmod(2 * x[axis], 65536)
        mine, other = kinds[upper], kinds[1 - upper]
        at += 1
        if mine == 3 and other == 3:
            skip, at = tree[at], at + 1
            if skip == 255:
                skip, at = int.from_bytes(tree[at : at + 2], "little"), at + 2
            at += upper * skip
        elif mine >= 2 and other == 2:
            at += leaf * (mine == 3 or upper)
    if mine < 2:
        return mine == 1
    word = int.from_bytes(tree[at : at + leaf], "little")
    signed = [(word >> (12 + 7 * k)) % 128 for k in range(d)]
    total = sum((c - 128 * (c > 63)) * place for c, place in zip(signed, x, strict=True))
    return total > (word % 4096 - 2048) * 2016 * d


def fixed(**sweep: object) -> Model:
    """Return a robot of fixed shape on four points: its trees have the two axes of the chart."""
    corners = [(0.3, 0.2, -0.4), (-0.3, 0.2, -0.4), (0.0, -0.3, -0.4), (0.35, -0.2, -0.4)]
    contacts = "".join(contact(f"P{i}", p) for i, p in enumerate(corners))
    return Model(parse_recipe(rigid(contacts, **sweep)))


def lone(model: Model, bytes_: int) -> Export:
    """Return an export of a verdict alone."""
    tables = verdict.encode(model, ("tip_angle",), Spec(8, bytes_))
    return export_of(model, tables, "integer")


@pytest.mark.parametrize(
    ("make", "bits"),
    [
        (
            lambda chart: noise(
                "noise", Model(parse_recipe(tripod(chart=chart))), "integer", 3_000
            ),
            0,
        ),
        (lambda chart: lone(fixed(chart=chart), 3_000), 3),
        (lambda chart: lone(fixed(chart=chart), 600 if chart == "sphere" else 100), 2),
    ],
    ids=["a root", "64 cells", "16 cells"],
)
@pytest.mark.parametrize("chart", ["cone", "sphere"])
def test_the_c_walks_a_tree_as_its_format_says(
    make: Callable[[str], Export], bits: int, chart: str
) -> None:
    export = make(chart)
    robot, trees, fold = export.model, export.tables.trees.held, export.tables.trees.fold
    assert export.tables.trees.bits == bits
    rng = np.random.default_rng(2)
    params = rng.integers(0, 32768, (5_000, robot.k)).astype(np.int16)
    gravity = rng.integers(-32767, 32768, (5_000, 3)).astype(np.int16)
    gravity[:, 2] = -np.abs(gravity[:, 2]) if chart == "cone" else gravity[:, 2]
    status = device(export).read(params, gravity)[0]
    limit = np.ceil(robot.chart_limit * 8193.0)
    checked = Counter[bool]()
    for q, g, said in zip(params.tolist(), gravity.tolist(), status.tolist(), strict=True):
        if said == OFF_CHART:
            continue
        sizes = [-g[2], g[0], -g[0], g[1], -g[1], g[2]]
        face = int(np.argmax(sizes)) if chart == "sphere" else 0
        across = [axis for axis in range(3) if axis != (2, 0, 0, 1, 1, 2)[face]]
        scale = 1 << (16 - max(g[i] ^ -(g[i] < 0) for i in range(3)).bit_length() - 1)
        deep = int(sizes[face] * scale * limit) >> 13
        u, v = (int(g[i] * scale * 32768 / deep) for i in across)
        rate = fold.behind if v < 0 else fold.ahead
        x = [
            min(max(place.first + int(place.rate * one / 16384), 0), 65535)
            for place, one in zip(export.tables.places, q, strict=True)
        ]
        x += [32768 + u, fold.base + (v * rate >> 13)]
        expected = walked(trees[face], bits, x)
        checked[expected] += 1
        assert (said == OK) == expected
    # Of a fixed shape on a sphere one direction in eighteen stands.
    assert min(checked.values()) > (200 if bits else 500)


def test_bytes_are_known_before_anything_is_encoded() -> None:
    wheels = Model(parse_recipe(rover()))
    for most in (200, 2_000):
        spec = Spec(8, most)
        before, made = (make(wheels, ("tip_angle",), spec) for make in (grid.blank, verdict.encode))
        assert before.bytes == most
        # What is fitted is never larger, and a leaf or two smaller, or all that is of any use.
        assert made.bytes <= most
        assert made.bytes > 0.9 * most
        assert made.bytes == sum(a.bytes for a in made.body(False).arrays if a.table)


@pytest.mark.parametrize(
    ("arithmetic", "chart"), [("float", "cone"), ("integer", "cone"), ("integer", "sphere")]
)
def test_a_robot_on_wheels_is_never_called_safe_where_it_tips(arithmetic: str, chart: str) -> None:
    wheels = Model(parse_recipe(rover(chart=chart)))
    tables = verdict.encode(wheels, ("tip_angle",), Spec(8, 2_000))
    reader = device(export_of(wheels, tables, arithmetic))
    for sample in (uniform(wheels, 60_000, 6), biased(wheels, 60_000, 6)):
        found = reader.measure(sample)
        assert not found.false_safe.any()
        # It says 0 where the robot stands, and so never more than the truth.
        said = found.answers.tip_angle
        assert set(np.unique(said)) <= {0.0, np.float32(-np.pi), -1.5707963267948966}
        assert (said <= np.maximum(found.exact.tip_angle, 0.0)).all()
    assert reader.measure(uniform(wheels, 60_000, 7)).false_tip < 0.2


def test_the_alarm_of_a_verdict_alone_is_clear_where_the_robot_stands(tmp_path: Path) -> None:
    # Its angle is 0 there, which is below any level.
    wheels = Model(parse_recipe(rover()))
    tables = verdict.encode(wheels, ("tip_angle",), Spec(8, 2_000))
    package.write(export_of(wheels, tables, "integer"), tmp_path / "out")
    compile_c([*STRICT, "-I..", "../robot.c", "alarm.c", "-o", "a"], tmp_path / "out" / "examples")
    said = subprocess.run(
        [tmp_path / "out" / "examples" / "a"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    words = [line.rsplit(" ", 1)[1] for line in said]
    assert words == ["danger", "clear", "danger", "clear"]
    # It leans by 27 deg and more before it may tip, and comes back as far.
    leans = [int(line[4:9]) / 4096.0 for line in said[2:]]
    assert min(leans) > 0.5


def test_a_robot_of_fixed_shape_has_a_tree_of_a_few_bytes() -> None:
    for chart, most, lost in (("cone", 100, 0.02), ("cone", 400, 0.005), ("sphere", 2_400, 0.005)):
        model = fixed(chart=chart)
        found = device(lone(model, most)).measure(uniform(model, 60_000, 3))
        assert not found.false_safe.any()
        # On a sphere it was 10 %: boxes of many points that one plane divides were given up.
        assert found.false_tip < lost


def test_a_few_bytes_go_a_long_way_as_large_boxes_have_planes_too() -> None:
    # 2.5 and 10.4 % where boxes of many points were always halved.
    for text, most, lost in ((CAR, 150, 0.002), (rover(), 200, 0.06)):
        model = Model(parse_recipe(text))
        found = device(lone(model, most)).measure(uniform(model, 60_000, 3))
        assert not found.false_safe.any()
        assert found.false_tip < lost


def grown(model: Model, faces: int, seed: int) -> Nodes:
    """Return trees that were grown on nothing: boxes halved anywhere, planes that mean nothing."""
    rng = np.random.default_rng(seed)
    d, halved = model.k + 2, 120
    count = faces + 2 * halved
    axis = np.where(np.arange(count) < halved, rng.integers(d, size=count), -1).astype(np.int8)
    child, parent = np.zeros(count, np.int64), np.zeros(count, np.int64)
    low, size = np.zeros((count, d)), np.ones((count, d))
    for i in range(halved):
        child[i] = faces + 2 * i
        for s in range(2):
            n = child[i] + s
            parent[n], low[n], size[n] = i, low[i], size[i]
            size[n, axis[i]] *= 0.5
            low[n, axis[i]] += s * size[n, axis[i]]
    plane = rng.integers(-63, 64, (count, d + 1)) / 63.0
    plane[:, d] = -np.inf
    worth = np.zeros(count)
    return Nodes(axis, child, parent, low, size, plane, worth, worth, worth, child, child)


@pytest.mark.parametrize("chart", ["cone", "sphere"])
def test_any_tree_is_safe_once_its_leaves_are_moved_as_far_as_the_proof_says(chart: str) -> None:
    wheels = Model(parse_recipe(rover(chart=chart)))
    wide = widened(wheels)
    middles, fold = Middles(wide), fold_of(wide)
    view = view_of(wide.recipe.chart.basis(), wide.chart_limit)
    nodes = grown(wide, wide.faces, 5)
    kind = np.where(nodes.axis >= 0, INNER, HALF).astype(np.int8)
    rng = np.random.default_rng(4)
    kind[kind == HALF] = np.where(rng.random((kind == HALF).sum()) < 0.2, SAFE, HALF)
    need = prove(nodes, kind, middles, view, fold).limit
    safe = {}
    for name, limit in (("proved", need), ("not", np.where(kind == SAFE, -4.0, need - 0.3))):
        held, levels = packed(nodes, kind, whole(limit, wide.k + 2), 0, wide.faces)
        trees = Trees(fold, 0, levels, held)
        tables = Tables(
            Spec(8, 9_999), ("tip_angle",), trees, (), wide.chart_limit, places_of(wheels), ""
        )
        reader = device(export_of(wheels, tables, "integer"))
        seen = [reader.measure(make(wheels, 100_000, 8)) for make in (uniform, biased)]
        safe[name] = sum(int(one.false_safe.sum()) for one in seen)
        if name == "proved":
            # What the proof allows is not nothing, though no plane was turned for this robot.
            assert seen[0].false_tip < 0.9
    assert safe["proved"] == 0
    assert safe["not"] > 100


def test_trees_take_no_more_bytes_than_there_are_and_lose_what_is_worth_least() -> None:
    wheels = Model(parse_recipe(rover()))
    nodes = grown(wheels, 1, 6)
    kind = np.where(nodes.axis >= 0, INNER, HALF).astype(np.int8)
    limit = whole(np.full(len(kind), -0.5), wheels.k + 2)
    # As many points in each leaf as its number; the planes call some of them safe.
    leaves = np.flatnonzero(kind == HALF)
    counts = np.where(kind == HALF, np.arange(len(kind)), 0)
    last = np.cumsum(counts)
    nodes = nodes._replace(first=last - counts, last=last)
    rng = np.random.default_rng(7)
    of = np.repeat(np.arange(len(kind)), counts)
    x = (nodes.low[of] + nodes.size[of] * rng.random((len(of), wheels.k + 2))).astype(np.float32)
    forest = Forest(nodes, x, np.ones(len(of), np.float32))
    height = (nodes.plane[of, :-1] * (x - nodes.low[of]) / nodes.size[of]).sum(axis=1)
    kept = np.bincount(of[height > limit[0]], minlength=len(kind))
    np.testing.assert_allclose(kept_by(forest, limit), kept)
    (full,), _ = packed(nodes, kind, limit, 0, 1)
    # All but the leaf that keeps least, and no other.
    few = limit.copy()
    few[leaves[np.argmin(kept[leaves])]] = np.inf
    assert fitting(forest, kind, limit, 0, 1, len(full) - 1)[0] == packed(nodes, kind, few, 0, 1)[0]
    before = len(full)
    for most in (before, before - 1, before // 2, 30, 2):
        (tree,), _ = fitting(forest, kind, limit, 0, 1, most)
        assert len(tree) <= most
        assert len(tree) > most - 40 or most == before
        before = len(tree)
    assert tree == bytes(2)


def _sheet(
    model: Model, at: NDArray[np.float64], gravity: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return for the middles around a place (k,), a row each, which directions (d, 3) may tip."""
    middles = Middles(model)
    first = np.floor(at * middles.per_axis - 0.5).astype(np.int64)
    first = np.clip(first, 0, middles.per_axis - 2)
    slab = middles.slab(first, first + 2)
    view = view_of(model.recipe.chart.basis(), model.chart_limit)
    return _asked(slab, view, gravity)


@njit()
def _asked(slab: Slab, view: View, gravity: NDArray[np.float64]) -> NDArray[np.bool_]:
    sheet = empty_sheet(slab.primitives.shape[1], len(view.basis))
    out = np.zeros((len(slab.low), len(gravity)), np.bool_)
    for p in range(len(slab.low)):
        draw(sheet, slab, p, view)
        for i in range(len(gravity)):
            out[p, i] = may_tip(sheet, (gravity[i, 0], gravity[i, 1], gravity[i, 2]))
    return out


def test_outlines_hold_what_tips_nearby() -> None:
    wheels = Model(parse_recipe(rover()))
    rng = np.random.default_rng(7)
    limit = wheels.chart_limit
    down = wheels.uv_to_gravity(0, *rng.uniform(-limit, limit, (2, 400)))
    down /= np.linalg.norm(down, axis=1)[:, None]
    missed = held = all_ = 0
    for _ in range(100):
        at = rng.random(wheels.k)
        tips = wheels.exact(wheels.at(at[None]), down[None]).tip_angle[0] < 0.0
        said = _sheet(wheels, at, down).any(axis=0)
        missed += int((tips & ~said).sum())
        held, all_ = held + int(said.sum()), all_ + int(tips.sum())
    assert missed == 0
    # Not by calling all of it doubtful.
    assert held < 1.1 * all_


def test_where_a_region_jumps_one_of_the_postures_around_knows_what_the_nearest_does_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wide = widened(Model(load_recipe("maps/absolem.toml")))
    # Found among 3.2 million configurations: it tips where what is nearest to it stands, with room.
    posture = np.array([[2.9165471108881995, -2.806358183819956]])
    down = np.array([[0.43122, -0.05026, -0.90085]])
    assert wide.exact(posture, down[None]).tip_angle[0, 0] < 0.0
    monkeypatch.setattr(middles, "MOST", 512**2)
    at = ((posture - wide.lower) / (wide.upper - wide.lower))[0]
    said = _sheet(wide, at, down)[:, 0]
    assert said.any()
    # The first of the four is that of its own sub-cell.
    own = np.floor(at * 512) - np.floor(at * 512 - 0.5)
    assert not said[int(own @ [2, 1])]


def car(left: float) -> Model:
    """Return a robot on two wheels and two wheels on an arm, its com so far to the left."""
    wheels = "".join(
        contact(f"{link}{y}", (x, y - left, z), 0.2, (0, 1, 0), link)
        for x, z, link in ((0.5, 0.0, "arm"), (-0.5, -0.3, "body"))
        for y in (0.4, -0.4)
    )
    return Model(
        parse_recipe(
            '[robot]\nname = "car"\nlength_unit = "m"\n[[robot.parameter]]\nname = "lift"\n'
            'min = 0.1\nmax = 0.5\nunit = "m"\n[[robot.link]]\nname = "arm"\nparent = "body"\n'
            'joint = { type = "prismatic", axis = [0, 0, -1], parameter = "lift" }\n'
            + wheels
            + sweep_part("lift = 3")
        )
    )


def test_v_is_folded_where_a_robot_is_mirrored_and_nowhere_else() -> None:
    # A lifted wheel on one side only; a com to the left stretches that side.
    rovers = Model(parse_recipe(rover()))
    for robot, mirrored in (
        (car(0.0), True),
        (car(0.004), True),
        (car(0.06), True),
        (rovers, False),
    ):
        fold = fold_of(robot)
        assert (fold != FLAT) == mirrored
        # At the rim, -32768 of 32768, all places are on the axis: one beyond it is the first again.
        ends = [
            fold.base + (v * rate >> 13) for v, rate in ((32767, fold.ahead), (-32768, fold.behind))
        ]
        assert all(0 <= end <= 65535 for end in ends)
        v = np.linspace(-1.0, 1.0, 9)
        places = folded(fold, v)
        assert places.min() >= 0.0
        assert places.max() <= 1.0
        if mirrored:
            assert (np.diff(places[4:]) > 0.0).all()
            assert (np.diff(places[:5]) < 0.0).all()
    evenly, unevenly = fold_of(car(0.0)), fold_of(car(0.004))
    assert evenly.ahead == -evenly.behind
    assert unevenly.ahead != -unevenly.behind


def test_a_node_below_the_ground_does_not_shift_the_heights_without_floats(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fit(*_: object) -> NDArray[np.float64]:
        # One node where nothing stands: its height is no length.
        return np.append(np.linspace(0.2, 0.4, 26), -1.0)[:, None]

    monkeypatch.setattr(grid_fit, "fit", fit)
    wheels = Model(parse_recipe(rover()))
    part = grid.length_table(wheels, "height", (3, 3, 3), 8)
    heights = part.offset[0] + part.step * part.codes.ravel().astype(np.float64)
    read = part.height_step * (
        part.zero[0] + np.arange(256) * 256.0 * part.fine_step / part.height_step
    )
    np.testing.assert_allclose(heights[:26], np.linspace(0.2, 0.4, 26), atol=0.001)
    np.testing.assert_allclose(read[part.codes.ravel()[:26]], heights[:26], atol=0.001)


def test_nodes_are_shared_out_evenly_and_never_more_than_asked() -> None:
    wheels = Model(parse_recipe(rover()))
    before = (3, 3, 3)
    for nodes in (27, 200, 1_000, 5_000):
        spec = of_nodes(wheels, EXPORTABLE, {"tip": 10 * nodes, "sdg": nodes, "height": nodes}, 8)
        assert Spec.of_label(spec.label) == spec
        assert spec.tree == 10 * nodes
        names, (shape, _) = zip(*spec.nodes, strict=True)
        assert names == ("sdg", "height")
        assert 0.5 * nodes <= np.prod(shape) <= nodes
        assert max(shape) - min(shape) <= 1
        assert all(more >= few for more, few in zip(shape, before, strict=True))
        before = shape
    assert of_nodes(wheels, ("tip_angle",), {"tip": 1 << 20}, 8).tree == 65535
