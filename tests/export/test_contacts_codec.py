"""The codec that stores contacts: modes found by probing, fitted tables, exact geometry."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware_export.certify.answers import device
from firmware_export.contacts import codec as contacts
from firmware_export.contacts.fit import Codes, fit_line
from firmware_export.contacts.modes import DENSE, Coordinates, evaluate, separate
from firmware_export.protocol.exported import Export
from firmware_export.truth.model import Model
from lutgen.errors import InputError
from lutgen.quantities import EXPORTABLE
from lutgen.recipe.recipe import load_recipe, parse_recipe
from tests.fixtures.recipes import contact, feet, rigid, rover, sweep_part, tripod

OK, CLAMPED, TIPS = 0, 1, 2


def model_of(name: str) -> Model:
    return Model(load_recipe(f"maps/{name}.toml"))


def made(model: Model, nodes: int, bits: int = 16) -> Export:
    spec = contacts.start(model, EXPORTABLE, "float")[-1]
    spec = contacts.Spec(tuple(nodes if n > 2 else n for n in spec.nodes), bits)
    tables = contacts.encode(model, EXPORTABLE, spec)
    return Export("robot", model.recipe, model, "contacts", "float", EXPORTABLE, tables)


def queries(
    model: Model, postures: int, directions: int, seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return params (m, k) and gravity (m, d, 3), both representable as float32."""
    rng = np.random.default_rng(seed)
    params = rng.uniform(model.lower, model.upper, (postures, model.k)).astype(np.float32)
    u, v = rng.uniform(-0.999, 0.999, (2, postures, directions)) * model.chart_limit
    gravity = model.uv_to_gravity(rng.integers(0, model.faces, u.shape), u, v)
    return params.astype(np.float64), gravity.astype(np.float32).astype(np.float64)


def asked(
    export: Export, params: NDArray[np.float64], gravity: NDArray[np.float64]
) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Return status (m, d) and reading (m, d, 3)."""
    m, d = gravity.shape[:2]
    status, reading = device(export).read(np.repeat(params, d, axis=0), gravity.reshape(-1, 3))
    return status.reshape(m, d), reading.reshape(m, d, 3)


@pytest.mark.parametrize(
    ("name", "modes"),
    # A revolute joint gives a cosine and a sine; the two angles never meet in one product but in
    # the robot whose leg swings and spreads.
    [("paper_one", [2]), ("paper_two", [2, 2]), ("absolem", [2, 2]), ("three_leg_sphere", [2, 2])],
)
def test_each_parameter_gets_the_modes_that_its_joints_need(name: str, modes: list[int]) -> None:
    found = separate(model_of(name))
    assert [len(part) for part in found.modes] == modes
    both = found.weights[1:, 1:] if len(modes) == 2 else np.zeros(1)
    assert bool(np.any(both)) == (name == "three_leg_sphere")


def test_a_prismatic_joint_under_a_revolute_one_is_separated_exactly() -> None:
    model = Model(parse_recipe(tripod()))
    found = separate(model)
    assert [len(part) for part in found.modes] == [1, 2]  # travel; cosine and sine
    places = np.random.default_rng(1).integers(0, DENSE, (500, 2))
    exact = Coordinates(model)(places / (DENSE - 1))
    # Rounding of a handful of float64 operations on lengths of about 1.
    np.testing.assert_allclose(evaluate(found, places), exact, atol=1e-11)


def test_a_rigid_robot_needs_no_modes() -> None:
    corners = [(0.3, 0.2, -0.4), (-0.3, 0.2, -0.4), (0.0, -0.3, -0.4)]
    model = Model(parse_recipe(rigid("".join(contact(f"P{i}", p) for i, p in enumerate(corners)))))
    export = made(model, 3)
    status, reading = device(export).read(np.zeros((1, 0)), [[0.0, 0.0, -1.0]])
    assert status[0] == OK
    exact = model.exact(np.zeros((1, 0)), [[[0.0, 0.0, -1.0]]])
    # Positions are stored to 16 bits: 0.4 / 32767 and some.
    np.testing.assert_allclose(reading[0, 0], exact.sdg[0, 0], atol=3e-5)


FEET = """
import numpy as np

def feet(q):
    a, b = q[:, 0], q[:, 1]
    reach = 1.0 + REACH
    one, none = np.ones_like(a), np.zeros_like(a)
    rows = [(reach, none, -one), (-one, one, -one), (-one, -one, -one)]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=1), np.zeros((len(a), 3))
"""


def coded(reach: str, module: str, folder: Path) -> Model:
    """Return the model of three points given by code; the first reaches as the parameters say."""
    (folder / f"{module}.py").write_text(FEET.replace("REACH", reach))
    parameters = "".join(
        f'[[robot.parameter]]\nname = "{name}"\nmin = 0.0\nmax = 1.0\nunit = "m"\n'
        for name in ("a", "b")
    )
    head = f'[robot]\nname = "code"\nlength_unit = "m"\npython = "{module}:feet"\n'
    text = head + parameters + sweep_part("a = 3, b = 3")
    return Model(parse_recipe(text, str(folder / "code.toml"), allow_python=True))


def test_a_function_in_python_is_probed_like_any_robot(tmp_path: Path) -> None:
    model = coded("np.exp(a) * (0.5 + b**3)", "feet_product", tmp_path)
    assert contacts.refusal(model, "float") is None
    found = separate(model)
    assert [len(part) for part in found.modes] == [1, 1]
    assert np.count_nonzero(found.weights[1, 1]) == 1  # the product of both


def test_contacts_that_are_no_sum_of_products_are_refused(tmp_path: Path) -> None:
    model = coded("np.sqrt(0.01 + (3.0 * a - 2.0 * b) ** 2)", "feet_tangled", tmp_path)
    refusal = contacts.refusal(model, "float")
    assert refusal is not None
    assert "--codec grid" in refusal
    with pytest.raises(InputError, match="--codec grid"):
        contacts.encode(model, EXPORTABLE, contacts.Spec((3, 3), 16))


def test_more_contacts_than_the_runtime_has_bits_for_are_refused() -> None:
    around = np.radians(np.arange(33) * 360.0 / 33)
    ring = [(math.cos(a), math.sin(a), -1.0) for a in around]
    refusal = contacts.refusal(Model(parse_recipe(rigid(feet(ring)))), "float")
    assert refusal == "codec contacts holds up to 32 contacts (got 33); use --codec grid"
    assert contacts.refusal(Model(parse_recipe(rigid(feet(ring[:32])))), "float") is None


def test_integers_are_refused() -> None:
    assert "floating point" in str(contacts.refusal(model_of("paper_two"), "integer"))


def test_the_fitted_line_halves_the_error_of_the_sampled_one() -> None:
    x = np.linspace(0.0, 1.0, DENSE)
    curve = np.cos(2.0 * x)
    knots = np.linspace(0.0, 1.0, 6)
    sampled = np.abs(np.interp(x, knots, np.cos(2.0 * knots)) - curve).max()
    fitted = np.abs(np.interp(x, knots, fit_line(curve, 6)) - curve).max()
    # Half is what can be had where the curvature is even; it is not quite here.
    assert fitted < 0.6 * sampled


@pytest.mark.parametrize(("name", "nodes", "bits"), [("paper_two", 4, 8), ("absolem", 65, 16)])
def test_stored_positions_keep_their_bound(name: str, nodes: int, bits: int) -> None:
    model = model_of(name)
    codes: Codes = made(model, nodes, bits).tables.codes
    places = np.random.default_rng(3).integers(0, DENSE, (4000, model.k))
    n = len(model.kind)
    exact = Coordinates(model)(places / (DENSE - 1))[:, : 3 * n].reshape(-1, n, 3)
    stored = evaluate(codes.stored, places)[:, : 3 * n].reshape(-1, n, 3)
    off = np.sqrt(((exact - stored) ** 2).sum(axis=2)).max(axis=0)
    assert np.all(off <= codes.position_error)
    # The bound is no idle one: some contact comes within a third of it.
    assert np.any(off > codes.position_error / 3.0)


def test_contacts_of_one_link_share_their_tables() -> None:
    codes: Codes = made(model_of("absolem"), 33).tables.codes
    # Twelve discs and a moving com, but four modes; what all contacts share is stored once.
    assert len(codes.modes) == 4 * 33
    assert codes.bytes < 480


def test_the_papers_robot_takes_less_than_100_bytes_for_1_percent() -> None:
    model = model_of("paper_two")
    export = made(model, 4, 8)
    params, gravity = queries(model, 5000, 20, 4)
    status, reading = asked(export, params, gravity)
    exact = model.exact(params, gravity)
    both = (status == OK) & (exact.tip_angle >= 0.0)
    span = np.nanmax(exact.sdg) - np.nanmin(exact.sdg)
    error = np.abs(reading[..., 0] - exact.sdg)[both].max() / span
    assert export.tables.bytes <= 100
    assert 1e-4 < error <= 0.01


@pytest.mark.parametrize(
    ("name", "nodes"),
    [("paper_one", 9), ("paper_two", 9), ("three_leg_sphere", 17), ("absolem", 129)],
)
def test_the_verdict_is_never_falsely_safe_and_gives_little_up(name: str, nodes: int) -> None:
    model = model_of(name)
    export = made(model, nodes)
    params, gravity = queries(model, 3000, 25, 5)
    status, reading = asked(export, params, gravity)
    exact = model.exact(params, gravity)
    stands = exact.tip_angle >= 0.0
    safe = status == OK
    assert not np.any(safe & ~stands)
    # Boundary slivers as wide as the guard, and for Absolem the ends of its gaps (5.4 % of what
    # stands, most of it near the rim of the chart).
    assert 0.0 < np.mean(~safe[stands]) < 0.08
    assert set(np.unique(status)) <= {OK, TIPS}
    np.testing.assert_array_equal(np.isnan(reading[..., 0]), ~safe)


def test_many_contacts_are_read_as_exactly_as_their_tables_are() -> None:
    model = model_of("absolem")
    export = made(model, 255)
    params, gravity = queries(model, 2000, 25, 6)
    status, reading = asked(export, params, gravity)
    exact = model.exact(params, gravity)
    both = (status == OK) & (exact.tip_angle >= 0.0)
    error = np.abs(reading[..., 0] - exact.sdg)[both] / (np.nanmax(exact.sdg))
    # Contacts are off by 4e-5 m of 0.3 m; only slivers beside folds belong to another facet.
    assert np.percentile(error, 98) < 5e-4
    assert np.mean(error > 0.01) < 0.02
    angle = reading[..., 1] + np.float32(export.tables.guard) - exact.tip_angle
    # tip_angle falls short where the robot could rock onto another rest, since the C tips there; it
    # never exceeds the truth by more than the guard.
    assert np.median(np.abs(angle[both])) < np.radians(0.01)
    assert angle[both].max() < export.tables.guard


def test_gaps_are_rocked_over_and_missing_facets_tip() -> None:
    model = Model(parse_recipe(rover()))
    export = made(model, 9)
    params, gravity = queries(model, 400, 50, 8)
    status, reading = asked(export, params, gravity)
    exact = model.exact(params, gravity)
    stands = exact.tip_angle >= 0.0
    assert not np.any((status == OK) & ~stands)
    assert np.mean(status[stands] != OK) < 0.04
    both = (status == OK) & stands
    # The diagonal on which four wheels rock is a fold: one side of it differs from the other.
    assert np.percentile(np.abs(reading[..., 0] - exact.sdg)[both], 98) < 1e-3


def warped(drop: float) -> Model:
    """Return four feet of which one is short: the robot rocks over the diagonal."""
    feet = [(0.3, 0.2, -0.3), (-0.3, 0.2, -0.3), (-0.3, -0.2, -0.3), (0.3, -0.2, -0.3 + drop)]
    return Model(parse_recipe(rigid("".join(contact(f"P{i}", p) for i, p in enumerate(feet)))))


def test_an_edge_beyond_which_the_robot_may_rock_is_no_safer_than_the_truth_has_it() -> None:
    # On the diagonal of four warped feet it rocks, but for its ends; the C takes all of it for a
    # tip-over axis.
    model = warped(0.04)
    export = made(model, 3)
    t = np.linspace(0.02, 0.98, 97)
    ends = np.array([(0.3, 0.2, -0.3), (-0.3, -0.2, -0.3)])
    along = ends[0] + t[:, None] * (ends[1] - ends[0])
    across = np.array([0.2, -0.3, 0.0]) / np.hypot(0.2, 0.3)
    for side in (-0.004, 0.004):
        gravity = along + side * across
        gravity = gravity.astype(np.float32).astype(np.float64)
        _, reading = device(export).read(np.zeros((97, 0)), gravity)
        exact = model.exact(np.zeros((1, 0)), gravity[None])
        assert np.all(reading[:, 1] <= exact.tip_angle[0] + 1e-5)  # rounding of float32, in rad
        assert exact.tip_angle[0, 48] > np.radians(5.0)


def test_what_is_narrower_than_a_rest_is_not_stood_on() -> None:
    for half, wide in ((0.002, False), (0.02, True)):
        feet = [(0.3, half, -0.3), (-0.3, half, -0.3), (-0.3, -half, -0.3), (0.3, -half, -0.3)]
        for some in (feet, [(0.3, 0.0, -0.3), *feet[1:3]]):
            model = Model(
                parse_recipe(rigid("".join(contact(f"P{i}", p) for i, p in enumerate(some))))
            )
            status, _ = device(made(model, 3)).read(np.zeros((1, 0)), [[0.0, 0.0, -1.0]])
            exact = model.exact(np.zeros((1, 0)), [[[0.0, 0.0, -1.0]]])
            assert (status[0] == OK) == wide == bool(exact.tip_angle[0, 0] >= 0.0)


def test_the_reading_depends_on_the_direction_of_gravity_alone() -> None:
    model = model_of("absolem")
    export = made(model, 33)
    params, gravity = queries(model, 300, 1, 9)
    first, same = (device(export).read(params, gravity[:, 0] * scale) for scale in (1.0, 1024.0))
    np.testing.assert_array_equal(first[0], same[0])
    np.testing.assert_array_equal(first[1], same[1])


def test_parameters_outside_are_clamped_and_said_so() -> None:
    model = model_of("paper_two")
    export = made(model, 9)
    inside = device(export).read(np.radians([[50.0, 31.0]]), [[0.0, 0.0, -1.0]])
    outside = device(export).read(np.radians([[57.0, 31.0]]), [[0.0, 0.0, -1.0]])
    assert (inside[0][0], outside[0][0]) == (OK, CLAMPED)
    np.testing.assert_array_equal(inside[1], outside[1])
