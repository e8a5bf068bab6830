"""Blocks of directions against the way node by node, and the arcsine that both share."""

import math
from decimal import Decimal, localcontext

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

import lutgen
from lutgen.channels.angles import arcsine
from lutgen.channels.batch import STRETCH
from lutgen.channels.block import BLOCK, worth_blocks
from lutgen.channels.evaluation import measure_primitives
from lutgen.channels.plain import find_wanted_ridges, measure, room_for_ridges
from lutgen.jit import njit
from lutgen.support import DISC, acceptance, empty_region, facet_table, pack, stand
from tests.fixtures.recipes import ALL_CHANNELS

Floats = NDArray[np.float64]
POINT = 0.0
EVERYTHING = np.ones(len(ALL_CHANNELS), dtype=bool)
LIMITS = ((None, None), (np.pi / 2, np.pi / 6), (1.0, None))


def node_by_node(
    primitives: Floats, gravity: Floats, limits: tuple[float | None, float | None]
) -> tuple[Floats, bool]:
    """Return the channels (6, g) of one direction after the other, and whether blocks fit."""
    table, region = facet_table(len(primitives)), empty_region(len(primitives))
    stand(table, region, primitives, acceptance(*limits))
    ridges = room_for_ridges(len(primitives), EVERYTHING)
    find_wanted_ridges(ridges, table, region, primitives, EVERYTHING)
    units = lutgen.chart.unit_directions(gravity)
    values = np.empty((len(gravity), len(ALL_CHANNELS)))
    for g, out in zip(units, values, strict=True):
        measure(region, ridges, tuple(g.tolist()), EVERYTHING, out)
    return values.T, worth_blocks(region.tally, EVERYTHING, len(gravity))


def random_robot(random: np.random.Generator, number: int) -> tuple[Floats, Floats]:
    """Return primitives (n, 8) and directions (g, 3), of a kind that the number tells."""
    n = int(random.integers(3, 13))
    contacts, gravity = random.normal(size=(n, 3)), random.normal(size=(40, 3))
    axes, radius, shape = np.zeros_like(contacts), 0.0, POINT
    kind = number % 6
    if kind == 1:
        contacts[:, 2] = -1.0
    elif kind == 2:
        # Coplanar, collinear and repeated contacts, and directions that tie.
        contacts = random.integers(-2, 3, size=(n, 3)).astype(np.float64)
        gravity = random.integers(-2, 3, size=(40, 3)).astype(np.float64)
        gravity[~gravity.any(axis=1)] = [0.0, 0.0, -1.0]
    elif kind == 3:
        contacts[:, 2] = -np.abs(contacts[:, 2])
    elif kind == 4:
        # Through a point between two contacts: on edges of facets and on tip-over axes.
        one, other = random.integers(0, n, (2, 40))
        part = random.uniform(size=(40, 1))
        gravity = part * contacts[one] + (1.0 - part) * contacts[other]
    elif kind == 5:
        # Wheels, on axles that lean a little.
        axes = 0.1 * random.normal(size=(n, 3)) + [0.0, 1.0, 0.0]
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        radius, shape = 0.2, DISC
    return pack(contacts, axes, radius, shape), gravity


def test_blocks_give_the_bits_of_the_way_node_by_node_for_any_robot() -> None:
    random = np.random.default_rng(7)
    in_blocks = tips = 0
    for number in range(180):
        primitives, gravity = random_robot(random, number)
        limits = LIMITS[number // 6 % 3]
        got = measure_primitives(primitives[None], gravity, ALL_CHANNELS, acceptance(*limits))
        want, blocks = node_by_node(primitives, gravity, limits)
        for name, row in zip(ALL_CHANNELS, want, strict=True):
            # Bit for bit: the same formulas in the same order, on one direction or on several.
            np.testing.assert_array_equal(got[name][0], row, err_msg=f"{name}, robot {number}")
        np.testing.assert_array_equal(np.isnan(got["sdg"]), got["tip_angle"] < 0.0)
        in_blocks += blocks
        tips += (got["tip_angle"] < 0.0).sum()
    # Both ways are taken, and both verdicts occur.
    assert 60 < in_blocks < 170
    assert 1000 < tips < 6500


@pytest.mark.parametrize("count", [1, 2, 3, BLOCK, BLOCK + 1, STRETCH - 1, STRETCH + 5])
def test_a_channel_alone_and_any_number_of_directions_give_the_same(count: int) -> None:
    random = np.random.default_rng(count)
    contacts = random.normal(size=(3, 6, 3))
    gravity = random.normal(size=(count, 3))
    together = lutgen.stability(contacts, gravity, ALL_CHANNELS)
    for name in ALL_CHANNELS:
        alone = lutgen.stability(contacts, gravity, (name,))[name]
        assert alone.shape == (3, count)
        np.testing.assert_array_equal(alone, together[name])
        last = lutgen.stability(contacts, gravity[-1:], (name,))[name]
        np.testing.assert_array_equal(alone[:, -1:], last)


@pytest.mark.parametrize("limits", [(None, None), (np.pi / 2, np.pi / 6)])
def test_one_posture_is_split_over_threads_without_a_change_of_a_bit(
    limits: tuple[float | None, float | None],
) -> None:
    if numba.config.NUMBA_NUM_THREADS < 2:
        pytest.skip("one core")
    random = np.random.default_rng(3)
    contacts, gravity = random.normal(size=(2, 8, 3)), random.normal(size=(130_000, 3))
    before = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        one = lutgen.stability(contacts, gravity, ALL_CHANNELS, *limits)
        numba.set_num_threads(2)
        two = lutgen.stability(contacts, gravity, ALL_CHANNELS, *limits)
    finally:
        numba.set_num_threads(before)
    for name in ALL_CHANNELS:
        np.testing.assert_array_equal(one[name], two[name], err_msg=name)


def exact_arcsine(x: float) -> Decimal:
    """Return asin(x) for |x| <= 1 to 25 digits: a step of Newton's method from `math.asin`."""
    with localcontext() as context:
        context.prec = 45
        y = Decimal(math.asin(x))
        sine = term = y
        for k in range(1, 22):
            term *= -y * y / (2 * k * (2 * k + 1))
            sine += term
        cosine = (1 - sine * sine).sqrt()
        # Near the end of the range the step squared counts, too: asin' = 1 / sqrt(1 - x^2).
        if cosine < Decimal("1e-6"):
            half = ((1 - abs(Decimal(x))) / 2).sqrt()
            angle = 2 * half * (1 + half * half / 6 + 3 * half**4 / 40)
            right = Decimal("1.57079632679489661923132169163975144209858")
            return (right - angle).copy_sign(Decimal(x))
        off = Decimal(x) - sine
        return y + off / cosine + sine * off * off / (2 * cosine**3)


def places_off(x: float, angle: float) -> float:
    """Return by how many units in the last place of asin(x) the angle is off."""
    exact = exact_arcsine(x)
    return float(abs(Decimal(float(angle)) - exact) / Decimal(math.ulp(float(exact))))


@njit()
def arcsines(x: Floats, out: Floats) -> None:
    """Fill `out` with the arcsines of x, in vector instructions."""
    for i in range(out.shape[0]):
        out[i] = arcsine(x[i])


def test_the_arcsine_is_right_to_a_unit_in_the_last_place() -> None:
    random = np.random.default_rng(1)
    x = np.concatenate(
        [
            random.uniform(-1.0, 1.0, 1500),
            random.uniform(0.45, 0.55, 500),
            10.0 ** random.uniform(-30.0, 0.0, 300),
            1.0 - 10.0 ** random.uniform(-16.0, 0.0, 700),
            [-1.0, np.nextafter(-1.0, 0.0), -0.5, 0.5, np.nextafter(0.5, 1.0), 1.0, 5e-324],
        ]
    )
    out = np.empty_like(x)
    arcsines(x, out)
    # As its docstring says: half a unit for the last rounding, the rest for those before it.
    assert max(places_off(*pair) for pair in zip(x.tolist(), out.tolist(), strict=True)) < 0.7
    if hasattr(arcsine, "py_func"):
        # Python does not fuse a product and a sum: no worse than this on any processor.
        plain = [arcsine.py_func(one) for one in x.tolist()]
        assert max(places_off(*pair) for pair in zip(x.tolist(), plain, strict=True)) < 1.3


def test_the_arcsine_of_what_rounding_took_beyond_one_is_a_right_angle() -> None:
    x = np.array([1.0 + 1e-15, 2.0, -1.0 - 1e-15, -0.0, np.nan, 0.5, -0.5])
    out = np.empty_like(x)
    arcsines(x, out)
    expected = [math.pi / 2, math.pi / 2, -math.pi / 2, -0.0, math.nan, math.asin(0.5), -out[5]]
    np.testing.assert_array_equal(out, expected)
    assert math.copysign(1.0, out[3]) == -1.0
