"""Postures of chance of every kind that the definition singles out, and what to ask of them."""

import math

import numpy as np

from lutgen.channels.measuring import measure_postures
from lutgen.support import acceptance, empty_region, stand
from tests.oracles.primitives import size_of, unit
from tests.oracles.standing import TIPS, Limits, facets_of

POINT, SPHERE, DISC = 0.0, 1.0, 2.0
FAMILIES = ("points", "mixed", "cars", "leaning")
CHANNELS = ("status", "tip_angle", "sdg", "height")
EXACT = ("rectangle", "rows", "polygon", "repeated", "in line", "on an edge", "all but flat")


def rows_of(centre, axis=None, radius=0.0, kind=POINT):
    """Return primitives (n, 8)."""
    rows = np.zeros((len(centre), 8))
    rows[:, :3], rows[:, 6], rows[:, 7] = centre, radius, kind
    if axis is not None:
        rows[:, 3:6] = np.where(rows[:, 7:] == DISC, axis, 0.0)
    return rows


def limits_of(rows):
    """Return the limits that a recipe has if it says nothing."""
    size = size_of(rows)
    return Limits(math.radians(80.0), math.radians(30.0), 0.01 * size, 1e-4 * size)


def read(rows, g, channels=CHANNELS, limits=None):
    """Return the channels (g,) of one posture, by default with the limits of `limits_of`."""
    limits = limits or limits_of(rows)
    accept = acceptance(*limits[:2], 0.0, *limits[2:])
    found = measure_postures(np.ascontiguousarray(rows)[None], g[None], channels, accept)
    return {name: values[0] for name, values in found.items()}


def drawn(family, rng):
    """Return a posture of 3 to 12 primitives."""
    n = int(rng.integers(3, 13))
    centre = rng.uniform([-1.0, -0.7, -0.6], [1.0, 0.7, -0.3], (n, 3))
    radius, level = rng.uniform(0.05, 0.3, n), np.tile([0.0, 1.0, 0.0], (n, 1))
    if family == "points":
        return rows_of(centre)
    if family == "cars":
        return rows_of(centre, level, radius, DISC)
    lean = unit(level + rng.uniform(-0.5, 0.5, (n, 3)))
    if family == "leaning":
        return rows_of(centre, lean, radius, DISC)
    kind = rng.integers(0, 3, n)
    return rows_of(centre, lean, np.where(kind == POINT, 0.0, radius), kind)


def exact(family, rng):
    """Return a posture with contacts in one plane or line, or at one place, in any order."""
    n, half = int(rng.integers(4, 9)), np.round(rng.uniform(0.1, 0.6, 2), 2)
    square = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * half
    turn = np.arange(n) * 2.0 * math.pi / n
    ring = np.stack([np.cos(turn), np.sin(turn)], -1)
    flat = {
        "rectangle": square,
        "rows": np.stack([np.repeat(np.linspace(-1, 1, n), 2), np.tile([-1, 1], n)], -1) * half,
        "polygon": ring * half[0],
        "repeated": np.concatenate([square, square[rng.integers(0, 4, 3)]]),
        "in line": np.concatenate([square, 0.5 * (square + np.roll(square, 1, 0)), [[0, 0]]]),
        "on an edge": square + half * [0.0, 1.0],
        "all but flat": np.concatenate([square, ring * half[0]]),
    }[family]
    if family != "on an edge":
        flat = flat + np.round(rng.uniform(-0.05, 0.05, 2), 2)
    centre = np.c_[flat, np.full(len(flat), -np.round(rng.uniform(0.2, 0.6), 2))]
    if rng.random() < 0.3:
        slope = np.round(rng.uniform(-0.3, 0.3, 2), 2)
        centre[:, 2] += flat @ slope
    if family == "all but flat":
        centre[:, 2] += 10.0 ** -rng.integers(6, 13) * rng.uniform(-1.0, 1.0, len(flat))
    wheels = rng.random() < 0.3
    rows = rows_of(centre, np.tile([0.0, 1.0, 0.0], (len(flat), 1)), 0.1 * wheels, DISC * wheels)
    return np.asarray(rows[rng.permutation(len(rows))])


def assert_one_verdict(found):
    """Demand that all channels, of those that are there, tell the verdict of the tip angle."""
    tips = found["tip_angle"] < 0.0
    for name in found.keys() - {"tip_angle", "energy_margin", "least_share"}:
        told = {"facet": found[name] == -1.0, "status": found[name] == TIPS}
        told |= {"margin": found[name] < 0.0}
        np.testing.assert_array_equal(told.get(name, np.isnan(found[name])), tips, name)


def assert_every_facet_once(rows, upright):
    """Demand that lutgen finds the support facets within `upright` (deg) that the oracle does."""
    region, least = empty_region(), math.cos(math.radians(upright))
    stand(region, rows, acceptance(math.radians(upright), 0.5))
    shown = region.shown[: region.counts.shown].copy()
    truth = [f.normal for f in facets_of(shown) if -f.normal[2] > least]
    normals = region.facet[: region.counts.facets]["normal"]
    found = normals[-normals[:, 2] > least]
    assert len(found) == len(truth) > 0
    for normal in truth:
        assert np.abs(found - normal).max(axis=1).min() < 1e-8


def below(rng, count):
    g = rng.normal(size=(count, 3))
    g[:, 2] = -np.abs(g[:, 2]) - 0.3
    return unit(g)


def asked(standing, count, rng):
    """Return unit directions: anywhere below, on edges and in gaps, and beside the boundary."""
    tilt, way = (
        np.arccos(rng.uniform(math.cos(math.radians(75.0)), 1.0, count)),
        rng.uniform(0, 7, count),
    )
    g = np.stack([np.sin(tilt) * np.cos(way), np.sin(tilt) * np.sin(way), -np.cos(tilt)], -1)
    off = 10.0 ** rng.uniform(-8.0, -2.0, (count, 1)) * rng.normal(size=(count, 3))
    if len(standing.sides):
        a, b = standing.sides[rng.integers(0, len(standing.sides), count // 5)].swapaxes(0, 1)
        g[: len(a)] = unit(unit(a + rng.random((len(a), 1)) * (b - a)) + off[: len(a)])
    for k, (_, arc) in enumerate(standing.gaps):
        at = np.arange(count // 5 + k, 2 * count // 5, len(standing.gaps))
        t, w = rng.integers(0, len(arc.p), len(at)), rng.random((len(at), 1))
        g[at] = unit(arc.p[t] + w * (arc.q[t] - arc.p[t]))
    return g
