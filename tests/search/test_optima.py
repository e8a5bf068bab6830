"""`lutgen.optimum`: the paper's numbers, its trace, and minima found from anywhere."""

import math
import re

import numpy as np
import pytest
from numpy.typing import NDArray

import lutgen
from lutgen.channels import acceptance_of
from lutgen.channels.evaluation import evaluate_each
from lutgen.channels.resting import body_gravity
from lutgen.errors import InputError
from lutgen.recipe.kinematics import forward, radii_and_kinds
from lutgen.recipe.recipe import Recipe
from lutgen.search.minimise import multistart, nelder_mead, refine
from lutgen.search.objective import Objective
from lutgen.search.optima import METHODS
from lutgen.support import pack
from tests.fixtures.length import part
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, sweep_part, tripod
from tests.oracles.primitives import reach, unit
from tests.oracles.standing import Limits, Standing

Floats = NDArray[np.float64]
LEVEL = [0.0, 0.0, -1.0]
A0 = math.atan(0.6)
HEIGHT = 12.0
# The canonical geometry, R = 23.323808: alpha and gamma (deg), then |SD_g| with gravity fixed
# relative to the contact plane (P) and fixed in the body (F).
TABLE = [
    ((30, 30), 0.065918816, 0.066340810),
    ((31, 31), 0.0025321733, 0.0025316053),
    ((31.2, 31.2), 0.016573478, 0.016549591),
    ((32, 32), 0.073875445, 0.073435114),
    ((30.88, 30.88), 0.0058371344, 0.0058401866),
    ((31.008, 31.008), 0.0030916106, 0.0030907645),
    ((30.9568, 30.9568), 0.00048558743, 0.00048560842),
    ((30.9628, 30.9605), 0.00020238995, 0.00020238762),
    ((20, 40), 1.1803992, 1.1935927),
    ((40, 20), 1.1803992, 1.1935927),
    ((10, 10), 0.6805837, 1.0208881),
    ((50, 50), 1.6878956, 1.7068262),
]
# With gamma at its nominal value: alpha (deg), |OC|, and |SD_g| as above.
ONE = [
    (0, 7.90223, 1.66803, 1.17758),
    (10, 9.32156, 1.22950, 1.01819),
    (20, 10.65532, 0.69885, 0.64413),
    (30, 11.88730, 0.06674, 0.06634),
    (40, 12.99904, 0.68072, 0.71506),
    (50, 13.96783, 1.56440, 1.71463),
    (60, 14.76289, 2.61595, 2.97179),
]


@pytest.fixture(scope="module")
def two() -> Recipe:
    """Return the paper's robot with two moving wheels."""
    return lutgen.load_recipe(MAPS / "paper_two.toml")


@pytest.fixture(scope="module")
def one() -> Recipe:
    """Return the paper's robot with one moving wheel."""
    return lutgen.load_recipe(MAPS / "paper_one.toml")


def measured(recipe: Recipe, degrees: object, convention: str) -> dict[str, Floats]:
    """Return sdg and height on level ground."""
    params = np.radians(np.array(degrees, dtype=float).reshape(-1, len(recipe.parameters)))
    down = body_gravity(recipe, params, LEVEL, convention)
    return evaluate_each(recipe, params, down, ("sdg", "height"))


@pytest.mark.parametrize(("convention", "column"), [("plane", 1), ("body", 2)])
def test_the_stability_factor_of_the_papers_robot_equals_the_table(
    two: Recipe, convention: str, column: int
) -> None:
    got = measured(two, [row[0] for row in TABLE], convention)["sdg"]
    expected = [row[column] for row in TABLE]
    # Eight digits are given; the smallest values to 1e-10.
    np.testing.assert_allclose(got, expected, rtol=0, atol=6e-8)
    np.testing.assert_allclose(got[:8], expected[:8], rtol=2e-7)


@pytest.mark.parametrize(("convention", "column"), [("plane", 2), ("body", 3)])
def test_height_and_stability_factor_over_alpha_equal_the_table(
    one: Recipe, convention: str, column: int
) -> None:
    got = measured(one, [row[0] for row in ONE], convention)
    # Five digits after the point are given.
    np.testing.assert_allclose(got["sdg"], [row[column] for row in ONE], rtol=0, atol=5.1e-6)
    np.testing.assert_allclose(got["height"], [row[1] for row in ONE], rtol=0, atol=5.1e-6)


@pytest.mark.parametrize("convention", ["plane", "body"])
def test_near_the_nominal_shape_the_first_order_formula_holds(two: Recipe, convention: str) -> None:
    for step in (1e-3, 1e-4):
        offset = step * np.random.default_rng(6).normal(size=(50, 2))
        got = measured(two, np.degrees(A0 + offset), convention)["sdg"]
        a, b = offset.T
        first = HEIGHT / 3.0 * np.sqrt(a * a + b * b - a * b)
        # The next order is as many times smaller as the offset is below 1 rad.
        assert (np.abs(got / first - 1.0) < 10.0 * np.abs(offset).max(axis=1)).all()


def test_below_zero_the_plane_convention_has_a_second_zero(two: Recipe) -> None:
    # Another equilateral triple, at -6.25 deg: a local search must be kept out by the bounds.
    found = lutgen.optimum(
        two,
        LEVEL,
        "nelder-mead",
        convention="plane",
        bounds=np.radians([[-20.0, 10.0], [-20.0, 10.0]]),
    )
    assert np.degrees(found.params) == pytest.approx([-6.25, -6.25], abs=0.01)
    assert found.value < 1e-4
    assert measured(two, [-6.25, -6.25], "body")["sdg"][0] > 0.5


@pytest.mark.parametrize("convention", ["plane", "body"])
@pytest.mark.parametrize("ends", ["left", "right"])
# From [30, 80] the second mesh would leave the bounds with left ends: its nodes stop at 30.
@pytest.mark.parametrize("first", [(0, 50), (-10, 40), (10, 60), (20, 70)])
def test_the_search_makes_the_papers_steps(
    two: Recipe, convention: str, ends: str, first: tuple[int, int]
) -> None:
    found = lutgen.optimum(
        two, LEVEL, convention=convention, ends=ends, bounds=np.radians([first, first])
    )
    steps = np.degrees([step.params for step in found.trace])
    expected = np.array([30.0, 32.0, 31.2, 30.88, 31.008, 30.9568])
    # The nodes are sums of decimals, and deg turned to rad and back: some 1e-16 of 31 each.
    np.testing.assert_allclose(steps, np.stack([expected, expected], axis=1), rtol=0, atol=1e-12)
    assert [step.evaluations for step in found.trace] == [25, 50, 75, 100, 125, 150]
    assert all(len(step.nodes) == 25 for step in found.trace)
    spacing = [10.0, 4.0, 1.6, 0.64, 0.256, 0.1024]
    for step, wanted in zip(found.trace, spacing, strict=True):
        gaps = np.diff(np.unique(np.degrees(step.nodes[:, 0]).round(9)))
        np.testing.assert_allclose(gaps, wanted, atol=2e-9)  # rounded to 1e-9 above
    assert found.evaluations == 150


def test_the_search_is_not_monotone_and_the_best_seen_is_returned(two: Recipe) -> None:
    found = lutgen.optimum(two, LEVEL, levels=2, convention="plane")
    first, last = found.trace
    assert last.value > first.value
    assert np.degrees(last.params) == pytest.approx([32.0, 32.0], abs=1e-12)
    assert found.params.tolist() == first.params.tolist()
    assert found.value == first.value == pytest.approx(0.065918816, abs=1e-9)


@pytest.mark.parametrize("convention", ["plane", "body"])
@pytest.mark.parametrize("method", ["nelder-mead", "multistart"])
def test_nelder_mead_finds_the_nominal_shape(two: Recipe, method: str, convention: str) -> None:
    found = lutgen.optimum(two, LEVEL, method, convention=convention)
    assert found.value < 1e-5
    # |SD_g| is 0.07 per deg: 1e-5 is 1.4e-4 deg on the diagonal, and at most 2.5e-4 off it.
    assert np.degrees(found.params) == pytest.approx([math.degrees(A0)] * 2, abs=2.5e-4)
    assert found.standing


def test_the_map_method_returns_the_best_node_of_the_sweep(two: Recipe) -> None:
    found = lutgen.optimum(two, LEVEL, "map")
    nodes = two.grid.params(np.arange(two.grid.size))
    sdg = lutgen.evaluate(two, nodes, LEVEL, ("sdg",))["sdg"][:, 0]
    assert found.evaluations == 2500
    assert found.value == np.nanmin(sdg)
    # Turned to deg and back.
    np.testing.assert_allclose(found.params, nodes[np.nanargmin(sdg)], rtol=1e-15)


def test_the_map_method_keeps_to_the_nodes_within_the_bounds(two: Recipe) -> None:
    found = lutgen.optimum(two, LEVEL, "map", bounds=np.radians([[35.0, 50.0], [0.0, 20.0]]))
    knots = np.degrees(two.grid.axes[0].knots)
    inside = [knots[(knots >= 35.0) & (knots <= 50.0)], knots[knots <= 20.0]]
    assert found.evaluations == len(inside[0]) * len(inside[1])
    with pytest.raises(InputError, match="no node of the sweep lies within the bounds"):
        lutgen.optimum(two, LEVEL, "map", bounds=np.radians([[30.7, 31.5], [0.0, 50.0]]))


@pytest.mark.parametrize("method", METHODS)
def test_the_evaluations_are_those_made(
    monkeypatch: pytest.MonkeyPatch, two: Recipe, method: str
) -> None:
    counted = [0]
    cost = Objective._cost

    def counting(self: Objective, rows: Floats, down: Floats) -> Floats:
        counted[0] += len(rows)
        return np.asarray(cost(self, rows, down))

    monkeypatch.setattr(Objective, "_cost", counting)
    # The ranges are no part of the method: without them nothing else is evaluated.
    monkeypatch.setattr("lutgen.search.optima.acceptable_range", lambda *_: np.zeros((2, 2)))
    found = lutgen.optimum(two, LEVEL, method)
    assert found.evaluations == counted[0] > 0
    assert found.trace[-1].evaluations == counted[0]


def test_the_value_is_that_of_the_parameters_returned() -> None:
    recipe = lutgen.parse_recipe(tripod())
    for method in METHODS:
        for name in ("sdg", "height", "tip_angle", "margin", "energy_margin"):
            found = lutgen.optimum(recipe, [0.2, 0.1, -1.0], method, name)
            exact = lutgen.evaluate(recipe, [found.params], [0.2, 0.1, -1.0], (name,))[name]
            assert found.value == pytest.approx(exact[0, 0], rel=1e-12)  # deg and back
            costs = [step.value for step in found.trace]
            best = min(costs) if name in ("sdg", "height") else max(costs)
            assert found.value == best


def test_the_search_leaves_the_geometries_that_tip() -> None:
    recipe = lutgen.parse_recipe(tripod())
    down = [0.62, 0.0, -1.0]
    box = np.array([[p.minimum, p.maximum] for p in recipe.parameters])
    start = box[:, 0]
    tilt = lutgen.evaluate(recipe, [start], down, ("tip_angle",))["tip_angle"][0, 0]
    assert tilt < -0.02
    found = lutgen.optimum(recipe, down, "nelder-mead", start=start)
    assert found.standing
    assert lutgen.evaluate(recipe, [found.params], down, ("tip_angle",))["tip_angle"][0, 0] >= 0.0


@pytest.mark.parametrize("method", METHODS)
def test_where_nothing_stands_the_least_bad_geometry_is_returned(method: str) -> None:
    recipe = lutgen.parse_recipe(tripod())
    down = [0.0, 5.0, -1.0]
    found = lutgen.optimum(recipe, down, method)
    assert not found.standing
    assert math.isnan(found.value)
    assert np.isnan(found.acceptable).all()
    assert np.isnan(found.delta).all()
    corners = [[a, b] for a in (0.0, 0.6) for b in np.radians([-40.0, 50.0])]
    tips = lutgen.evaluate(recipe, [found.params, *corners], down, ("tip_angle",))["tip_angle"]
    assert tips[0, 0] >= tips[1:, 0].max() - 0.02


@pytest.mark.parametrize("method", METHODS)
def test_the_same_robot_in_another_unit_has_the_same_optimum(method: str) -> None:
    metres = tripod()
    millimetres = metres.replace('length_unit = "m"', 'length_unit = "mm"')
    millimetres = millimetres.replace(
        'min = 0.0\nmax = 0.6\nunit = "m"', 'min = 0.0\nmax = 600.0\nunit = "mm"'
    )
    for key in ("com", "position", "origin"):
        millimetres = re.sub(
            rf"(?m)^{key} = \[(.*?)\]",
            lambda m, k=key: f"{k} = [{', '.join(str(1000 * float(x)) for x in m[1].split(','))}]",
            millimetres,
        )
    down = [0.1, 0.2, -1.0]
    m = lutgen.optimum(lutgen.parse_recipe(metres), down, method)
    mm = lutgen.optimum(lutgen.parse_recipe(millimetres), down, method)
    # Lengths differ by rounding, so Nelder-Mead may turn elsewhere in its last simplices, of
    # 2e-6 of the bounds.
    assert mm.params / [1000.0, 1.0] == pytest.approx(m.params, abs=1e-5)
    assert mm.value / 1000.0 == pytest.approx(m.value, abs=1e-5)


def spider(legs: int) -> str:
    """Return a recipe of a body on `legs` feet, each of which goes up and down by itself."""
    parts = ['[robot]\nname = "spider"\nlength_unit = "m"\n']
    for i in range(legs):
        parts.append(f'[[robot.parameter]]\nname = "leg{i}"\nmin = 0.3\nmax = 0.9\nunit = "m"\n')
        parts.append(
            f'[[robot.link]]\nname = "link{i}"\nparent = "body"\njoint = {{ type = "prismatic", '
            f'axis = [0, 0, -1], parameter = "leg{i}" }}\n'
        )
    for i in range(max(legs, 3)):
        angle = 2.0 * math.pi * i / max(legs, 3)
        place = (math.cos(angle), math.sin(angle), 0.0 if i < legs else -0.6)
        parts.append(contact(f"foot{i}", place, link=f"link{i}" if i < legs else "body"))
    return "".join(parts) + sweep_part(", ".join(f"leg{i} = 3" for i in range(legs)))


@pytest.mark.parametrize("count", [1, 2, 4, 6])
def test_any_number_of_parameters_is_searched(count: int) -> None:
    recipe = lutgen.parse_recipe(spider(count))
    down = [0.15, 0.1, -1.0]
    box = np.array([[0.3, 0.9]] * count)
    random = np.random.default_rng(9).uniform(0.3, 0.9, (500, count))
    lowest = Objective(recipe, down).cost(random).min()
    for method in ("map", "nelder-mead", "multistart"):
        found = lutgen.optimum(recipe, down, method)
        assert found.params.shape == found.delta.shape == (count,)
        assert found.acceptable.shape == (count, 2)
        assert (found.params >= box[:, 0] - 1e-12).all()
        assert (found.params <= box[:, 1] + 1e-12).all()
        if method == "multistart":
            assert found.value <= lowest
    found = lutgen.optimum(recipe, down, levels=2)
    assert found.evaluations == 2 * 5**count
    assert found.trace[0].nodes.shape == (5**count, count)


def test_too_many_parameters_for_a_mesh_are_refused_and_multistart_takes_them() -> None:
    recipe = lutgen.parse_recipe(spider(9))
    with pytest.raises(InputError, match=r"at most 8 parameters \(got 9, or 5\^9 nodes a step\)"):
        lutgen.optimum(recipe, LEVEL)
    bounds = [[0.5, 0.5]] * 3 + [[0.3, 0.9]] * 6
    found = lutgen.optimum(recipe, LEVEL, levels=1, bounds=bounds)
    assert found.evaluations == 5**6
    assert found.params[:3].tolist() == [0.5, 0.5, 0.5]


@pytest.mark.parametrize("method", METHODS)
def test_a_parameter_with_equal_bounds_keeps_its_value(two: Recipe, method: str) -> None:
    kept = math.radians(17.3)  # no node of the sweep
    found = lutgen.optimum(two, LEVEL, method, bounds=[[0.0, math.radians(50.0)], [kept, kept]])
    assert found.params[1] == kept
    assert found.acceptable[1].tolist() == [kept, kept]
    assert found.delta[1] == 0.0
    assert all(
        (step.params[1] == kept) and (step.nodes[:, 1] == kept).all() for step in found.trace
    )
    # Along the line alpha is best where the first-order form is, about (A0 + gamma) / 2.
    line = np.radians(np.linspace(0.0, 50.0, 5001))
    sdg = lutgen.evaluate(two, np.stack([line, 0 * line + kept], axis=1), LEVEL, ("sdg",))["sdg"]
    # 0.5 deg is half a step of the map.
    best = np.degrees(line[np.nanargmin(sdg)])
    assert np.degrees(found.params[0]) == pytest.approx(best, abs=0.52)
    assert found.value < np.nanmin(sdg) + 0.01


# Global optima


def flippers() -> Recipe:
    """Return Absolem without tracks and with pointed flippers: the same shape, tested quickly."""
    head, *contacts = re.split(
        r"(?m)^(?=\[\[robot\.contact\]\]|\[sweep\])",
        (MAPS / "absolem.toml").read_text(encoding="utf-8"),
    )
    text = head
    for lines in contacts:
        if lines.startswith("[[robot.contact]]"):
            if "_track_" in lines:
                continue
            lines = re.sub(r"(?m)^(radius|axis) = .*\n", "", lines)
        text += lines
    return lutgen.parse_recipe(text)


BOX = np.array([[-180.0, 180.0], [-180.0, 180.0]])


def brute_force(goal: Objective, nodes: int) -> float:
    """Return the lowest cost: a dense mesh of the box, then meshes around its 8 best regions."""
    line = np.linspace(-180.0, 180.0, nodes)
    mesh = np.stack(np.meshgrid(line, line, indexing="ij"), axis=2).reshape(-1, 2)
    costs = goal.cost(np.radians(mesh))
    centres: list[Floats] = []
    for at in np.argsort(costs, kind="stable"):
        if all(np.abs(mesh[at] - other).max() > 10.0 for other in centres):
            centres.append(mesh[at])
        if len(centres) == 8:
            break
    lowest = np.inf
    for centre in centres:
        width = 720.0 / (nodes - 1)
        best, best_cost = centre, float(goal.cost(np.radians(centre))[0])
        while width > 1e-5:
            part = np.linspace(-width, width, 13)
            local = np.stack(np.meshgrid(part, part), axis=2).reshape(-1, 2) + best
            local = np.clip(local, BOX[:, 0], BOX[:, 1])
            found = goal.cost(np.radians(local))
            if found.min() < best_cost:
                best, best_cost = local[int(found.argmin())], float(found.min())
            width *= 0.5
        lowest = min(lowest, best_cost)
    return lowest


@pytest.mark.parametrize(
    ("objective", "starts"), [("sdg", part(40, 8)), ("sdg+0.2*height", part(20, 5))]
)
def test_multistart_finds_the_global_optimum_from_every_one_of_many_starts(
    objective: str, starts: int
) -> None:
    goal = Objective(flippers(), [-0.6, 0.3, -1.0], objective)

    def cost(points: Floats) -> Floats:
        return goal.cost(np.radians(points))

    lowest = brute_force(goal, 241)
    # 1e-5 m on a robot of half a metre; the next minimum is some 1e-3 m higher.
    enough = lowest + 1e-5
    random = np.random.default_rng(0)
    many = one = 0
    for seed in range(starts):
        start = random.uniform(BOX[:, 0], BOX[:, 1])
        final = multistart(cost, BOX, start, seed)[-1].value
        many += int(final <= enough)
        assert final >= lowest - 1e-5  # or the brute force has missed the optimum
        one += int(nelder_mead(cost, BOX, start)[-1].value <= enough)
    assert many == starts
    # What the paper's own ways find: they are the reason for multistart.
    assert one < starts / 2
    assert min(step.value for step in refine(cost, BOX)) > lowest + 1e-3


def seen_by_the_oracle(goal: Objective, degrees: list[float]) -> tuple[float, float]:
    """Return |SD_g| of a posture, and by how much the nearest contact misses the support facet.

    The oracle tries all triples of contacts.
    """
    recipe, accept = goal.recipe, acceptance_of(goal.recipe)
    where = forward(recipe, np.radians([degrees]))
    rows = pack(where.centres, where.axes, *radii_and_kinds(recipe))[0]
    limits = recipe.upright, recipe.rock_angle, accept.rest_width, accept.contact_tolerance
    standing = Standing(rows, Limits(*limits))
    _, _, sdg, height = standing.read(unit(np.atleast_2d(goal.gravity)))
    rest = min(standing.rests, key=lambda f: abs(f.height - height[0]))
    missing = rest.height - reach(rows, rest.normal[None])[0]
    return float(sdg[0]), float(missing[missing > accept.contact_tolerance].min())


def test_multistart_finds_the_global_optimum_of_a_robot_on_tracks() -> None:
    goal = Objective(lutgen.load_recipe(MAPS / "absolem.toml"), [-0.6, 0.3, -1.0])

    def cost(points: Floats) -> Floats:
        return goal.cost(np.radians(points))

    # Established once by a mesh of 2 deg and finer ones around its minima; the test's own mesh
    # of 6 deg must not find anything better.  It lies where two more contacts begin to touch, which
    # they do within contact_tolerance: while that was rounding alone, 0.047387516 could be had
    # beside it.
    lowest = 0.0473900796
    line = np.linspace(-180.0, 180.0, 61)
    mesh = np.stack(np.meshgrid(line, line), axis=2).reshape(-1, 2)
    assert cost(mesh).min() > lowest
    for seed in (1, 2):
        start = np.random.default_rng(seed).uniform(BOX[:, 0], BOX[:, 1])
        assert multistart(cost, BOX, start, seed)[-1].value == pytest.approx(lowest, abs=1e-6)
    assert min(step.value for step in refine(cost, BOX)) > lowest + 1e-3
    # The oracle knows no search for facets: the value, and why there is no better one beside it.
    value, missing = seen_by_the_oracle(goal, [-169.35215779, -0.18827025])
    assert value == pytest.approx(lowest, abs=1e-9)
    touching = acceptance_of(goal.recipe).contact_tolerance
    assert touching < missing < 1.001 * touching
    assert seen_by_the_oracle(goal, [-169.354, -0.188])[0] > 0.139


# Refusals


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"method": "simplex"}, "unknown method 'simplex'; choose from map, nelder-mead"),
        ({"ends": "both"}, "unknown ends 'both'; choose from left, right"),
        ({"levels": 0}, r"at least one level \(got 0\)"),
        ({"bounds": [[0.0, 1.0]]}, r"shape \(2, 2\) \(got \[\[0.0, 1.0\]\]\)"),
        ({"bounds": [[0.0, np.nan], [0.0, 1.0]]}, "bounds must be finite"),
        ({"bounds": [[1.0, 0.0], [0.0, 1.0]]}, "no lower bound may be above the upper one"),
        ({"bounds": [[0.1, 0.1], [0.2, 0.2]]}, r"no geometry parameter to search \(got 2, all"),
        ({"start": [0.1]}, r"one number for each parameter \(got \[0.1\]\)"),
        ({"start": [0.1, 3.0]}, "the start must lie within the bounds"),
        ({"start": [0.1, np.nan]}, "the start must lie within the bounds"),
        ({"objective": "facet"}, "objective 'facet' is not understood"),
        ({"convention": "F"}, "unknown convention 'F'"),
    ],
)
def test_what_makes_no_sense_is_refused(
    two: Recipe, arguments: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        lutgen.optimum(two, LEVEL, **arguments)  # type: ignore[arg-type]


def test_a_robot_without_parameters_has_nothing_to_search() -> None:
    text = re.sub(r"(?s)\[\[robot.parameter\]\].*?(?=\[\[robot.link\]\])", "", tripod(""))
    text = re.sub(r"(?m)^joint = .*\n", "", text)
    with pytest.raises(InputError, match=r"no geometry parameter to search \(got 0"):
        lutgen.optimum(lutgen.parse_recipe(text), LEVEL)


def test_gravity_without_a_direction_is_refused(two: Recipe) -> None:
    for wrong in ([0, 0, 0], [0, 0, math.nan], [0, 0]):
        with pytest.raises(InputError):
            lutgen.optimum(two, wrong)
