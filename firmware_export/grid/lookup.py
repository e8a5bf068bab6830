"""Codec `grid` for three contacts whose facet is a rest in every posture.

Positions are looked up over the parameters alone; facet, walls and readings follow from them
exactly for every direction, with floats or without.  Nodes are evenly spaced and shifted by half of
the distance between chord and arc, so that errors lie on both sides alike.  A table has the axes on
which its point depends.

The guard is what wrong positions can turn a tip-over plane.  The true contacts P_i span a cone; M
is the stored normal of edge i.  Where gravity is inside the cone and edge i the nearest, the foot
of gravity on it lies on the arc from P_i to P_(i+1), so the tip angle is too large by at most the
largest angle of that arc above the stored plane.  Errors along the legs lie in that plane and turn
nothing.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from firmware_export.model import (
    Cells,
    Model,
    combinations,
    least_edge_of,
    rounds,
    sensor_tolerance,
    widened,
)
from firmware_export.protocol import CArray, CBody, Channels, Codec
from firmware_export.protocol import Tables as AnyTables
from lutgen.mapping.stability_map import interpolate, locate
from lutgen.vector import Floats

# Units from the com to the furthest contact: products of two of them stay in 31 bits.
UNITS = 16000
MOST_AXES = 4
LINES, PROBES = 12, 9
NEGLIGIBLE = 1e-9


@dataclass(frozen=True, eq=False)
class Point:
    """The table of one contact over the parameters on which it depends.

    `codes` (nodes..., 3) are x, y, z in units, or of 8 bits in 128 units.
    """

    axes: tuple[int, ...]
    codes: NDArray[np.int16] | NDArray[np.int8]


@lru_cache(maxsize=16)
def _lines(model: Model, axis: int) -> Floats:
    """Return the contacts (LINES, PROBES, 3, 3) along some lines that follow an axis."""
    t = np.repeat(np.random.default_rng(6).random((LINES, 1, model.k)), PROBES, axis=1)
    t[:, :, axis] = np.linspace(0.0, 1.0, PROBES)
    return model.postures(model.at(t.reshape(-1, model.k))).centres.reshape(LINES, PROBES, 3, 3)


def depends_on(model: Model, contact: int) -> tuple[int, ...]:
    """Return the parameters on which a contact's position relative to the com depends."""
    lines = [_lines(model, axis)[:, :, contact] for axis in range(model.k)]
    moves = [np.abs(p - p[:, :1]).max() > NEGLIGIBLE * np.abs(p).max() for p in lines]
    return tuple(np.flatnonzero(moves).tolist())


def curvature(model: Model, axis: int) -> float:
    """Return how far (length) any contact's arc along an axis is from its chord at most."""
    second = np.diff(_lines(model, axis), 2, axis=1)
    return float(np.abs(second).max()) * (PROBES - 1) ** 2 / 8.0


def reach_of(model: Model) -> float:
    """Return how far (length) a contact is from the com at most, in many postures."""
    t = np.random.default_rng(7).random((4000, model.k))
    t[:1000] = np.rint(t[:1000])
    return 1.02 * float(np.sqrt((model.postures(model.at(t)).centres ** 2).sum(axis=2)).max())


def fit_point(model: Model, contact: int, nodes: tuple[int, ...], bits: int, unit: float) -> Point:
    """Return the table of one contact, in units, of so many nodes along each of its axes."""
    axes = depends_on(model, contact)

    def exact(places: list[Floats]) -> Floats:
        grid = combinations(places)
        t = np.full((len(grid), model.k), 0.5)
        t[:, list(axes)] = grid
        shape = (*(len(one) for one in places), 3)
        return model.postures(model.at(t)).centres[:, contact].reshape(shape)

    knots = [np.linspace(0.0, 1.0, n) for n in nodes]
    values = exact(knots)
    shift = np.zeros_like(values)
    for axis, knot in enumerate(knots):
        middles = [*knots]
        middles[axis] = (knot[1:] + knot[:-1]) / 2.0
        before = np.moveaxis(values, axis, 0)
        sag = np.moveaxis(exact(middles), axis, 0) - (before[1:] + before[:-1]) / 2.0
        both = np.concatenate([sag[:1], (sag[1:] + sag[:-1]) / 2.0, sag[-1:]])
        shift += np.moveaxis(both, 0, axis) / 2.0
    step = unit * (128 if bits == 8 else 1)
    most = 127 if bits == 8 else 16383
    codes = np.clip(np.rint((values + shift) / step), -most, most)
    return Point(axes, codes.astype(np.int8) if bits == 8 else codes.astype(np.int16))


def bounds(model: Model) -> tuple[Model, float]:
    """Return the model over what sensors may say, and the length of a unit."""
    wide = widened(model)
    return wide, reach_of(wide) / UNITS


# Places between two nodes at which errors are looked at, by the number of parameters; what may lie
# between.
BETWEEN = {0: 1, 1: 16, 2: 8, 3: 4, 4: 3}
MORE = 1.05
# Postures that are looked at, of more some at random; and at once.
MOST, AT_ONCE = 200_000, 20_000


def turned(model: Model, order: tuple[int, int, int], points: tuple[Point, ...]) -> float:
    """Return how far (rad) an arc is above its stored plane at most; pi where there is no plane."""
    nodes = np.ones(model.k, np.intp)
    for one in points:
        for axis, count in zip(one.axes, one.codes.shape, strict=False):
            nodes[axis] = max(nodes[axis], count)
    between = BETWEEN.get(model.k, 2)
    fine = [np.linspace(0.0, 1.0, (n - 1) * between + 1) for n in nodes]
    count = int(np.prod([float(len(one)) for one in fine]))
    few = count <= MOST
    t = combinations(fine) if few else np.random.default_rng(8).random((MOST, model.k))
    most = 0.0
    for first in range(0, len(t), AT_ONCE):
        here = t[first : first + AT_ONCE]
        true = model.postures(model.at(here)).centres[:, list(order)]
        stored = np.stack([_read(one, here) for one in points], axis=1)
        most = max(most, _above(true, stored))
    return MORE * most


def _read(point: Point, t: Floats) -> Floats:
    """Return what is looked up (m, 3), in units of its codes, at places t (m, k) of the box."""
    codes = point.codes.astype(np.float64)
    if not point.axes:
        return np.broadcast_to(codes, (len(t), 3))
    sizes = zip(point.axes, codes.shape, strict=False)
    places = [locate(np.linspace(0.0, 1.0, n), t[:, axis]) for axis, n in sizes]
    return np.stack([interpolate(codes[..., i], places)[0] for i in range(3)], axis=1)


def _above(true: Floats, stored: Floats) -> float:
    """Return the largest angle (rad) of an arc (m, 3, 3) above the plane of stored points."""
    most = 0.0
    for i in range(3):
        normal = np.cross(stored[:, i - 1], stored[:, i])
        ends = [true[:, j] / np.linalg.norm(true[:, j], axis=1, keepdims=True) for j in (i - 1, i)]
        size = np.linalg.norm(normal, axis=1)
        a, b = ((normal * end).sum(axis=1) / size for end in ends)
        # Between the ends the greatest is where the arc's plane is steepest, if that is on the arc.
        c = (ends[0] * ends[1]).sum(axis=1)
        inner = np.sqrt((a * a + b * b - 2.0 * a * b * c) / np.maximum(1.0 - c * c, 1e-300))
        on_arc = (b > a * c) & (a > b * c)
        above = np.where(on_arc, inner, np.maximum(a, b))
        if not np.isfinite(above).all():
            return np.pi
        most = max(most, float(np.arcsin(np.clip(above, 0.0, 1.0)).max()))
    return most


# Its number in runtime/smap_map.h; words of a pose: head, floats and integers, and without floats.
TABLES, POSE, POSE_I = 3, (1 + 20 + 8, 1 + 8), (1 + 8, 1 + 8)
MOST_NODES, MOST_CODES = 65, 1 << 15
# rad; rounding of the float path.  Units by which integers misplace a point, and 1/32767 by which
# they read a sine too high.
ROUNDING, MISPLACED, ROUNDED = 4e-6, 4.0, 9
# Units of a chord's distance from its arc, which the fit halves, below which wider codes gain more
# than further nodes do: codes of 8 bits round by up to 64.
COARSE = 256.0


@dataclass(frozen=True)
class Spec:
    """A size: bits of a code; per point the nodes along each parameter, 1 where nothing depends."""

    bits: int
    nodes: tuple[tuple[int, ...], ...]

    @property
    def label(self) -> str:
        """Short text, such as ``grid i8 4x1 1x4 1x1``."""
        return f"grid i{self.bits} " + " ".join(
            "x".join(map(str, one)) or "1" for one in self.nodes
        )

    @property
    def bytes(self) -> int:
        """Bytes of the codes, known before anything is encoded."""
        return sum(3 * math.prod(one) for one in self.nodes) * self.bits // 8

    def grown(self, axis: int) -> "Spec":
        """Return the next larger size along one parameter."""
        rows = [list(one) for one in self.nodes]
        for row in rows:
            row[axis] = min(row[axis] + 1 + row[axis] // 8, MOST_NODES) if row[axis] > 1 else 1
        return Spec(self.bits, tuple(map(tuple, rows)))


@dataclass(frozen=True, eq=False)
class Tables(AnyTables):
    """The three points in the order of the runtime; `unit` is the length of a unit."""

    spec: Spec
    points: tuple[Point, ...]
    places: tuple[tuple[float, float, int, int], ...]
    order: int
    unit: float
    guard: float
    guard_text: str

    def body(self, integer: bool) -> CBody:
        """Return the tables for the emitter, in the layout of runtime/smap_lookup.h."""
        wide = [int(self.spec.bits == 16), 0, 0, self.order]
        arrays = [
            CArray("unit", "float", [self.unit], "length of one unit", False),
            CArray("order", "uint8_t", wide, "bits, order", False),
        ]
        for low, inverse, first, rate in self.places:
            begins = "where an axis begins, 1 / span"
            arrays.append(CArray("place", "float", [low, inverse], begins, False))
            steps = [first, rate]
            arrays.append(CArray("place in steps", "uint16_t", steps, "the same of steps", False))
        for one in self.points:
            axes = [n for pair in zip(one.axes, one.codes.shape, strict=False) for n in pair]
            comment = "axes: parameter, nodes"
            arrays.append(CArray("axes", "uint8_t", [len(one.axes), *axes], comment))
        ctype = f"int{self.spec.bits}_t"
        arrays += [CArray("codes", ctype, one.codes, "x, y, z of each node") for one in self.points]
        pose = POSE_I if integer else POSE
        return CBody(TABLES, tuple(arrays), 3, (), pose, self.unit, rounded=ROUNDED)

    def cells(self, model: Model) -> Cells:
        """Return the knots of the tables."""
        knots = []
        for axis, p in enumerate(model.recipe.parameters):
            room = sensor_tolerance(p) / (p.maximum - p.minimum)
            counts = [n[axis] for n in self.spec.nodes]
            t = np.linspace(0.0, 1.0, max(*counts, 2)) * (1.0 + 2.0 * room) - room
            knots.append(np.unique(np.clip(t, 0.0, 1.0)))
        return tuple(knots)


class Lookup(Codec):
    """The codec; it grows along the parameter whose chords are furthest from their arcs."""

    name = "grid"

    def refusal(self, model: Model, arithmetic: str) -> str | None:
        """Return why the codec cannot be used, or None."""
        if model.recipe.com_uncertainty > 0.0:
            return "grid holds no com_uncertainty; choose the codec contacts"
        if not model.is_tripod or least_edge_of(model) <= 0.0:
            return "grid looks up three contacts whose facet is a rest in every posture"
        if any(len(depends_on(widened(model), one)) > MOST_AXES for one in range(3)):
            return f"grid looks up contacts that depend on at most {MOST_AXES} parameters"
        return None

    def sizes(self, model: Model, channels: Channels = (), most: int | None = None) -> list[Spec]:
        """Return sizes from three nodes on; wider codes where narrow ones round too much."""
        (wide, unit), order = bounds(model), rounds(model)
        moves = [[axis in depends_on(wide, one) for axis in range(model.k)] for one in order]
        bends = [curvature(wide, axis) for axis in range(model.k)]
        spec = Spec(8, tuple(tuple(3 if move else 1 for move in one) for one in moves))
        found = [spec]
        while spec.bytes <= MOST_CODES:
            nodes = [max(one[axis] for one in spec.nodes) for axis in range(model.k)]
            sags = [
                bend / (n - 1) ** 2 if n > 1 else 0.0 for bend, n in zip(bends, nodes, strict=True)
            ]
            axis = max(range(model.k), key=lambda at: sags[at], default=0)
            if spec.bits == 8 and (not model.k or sum(sags) < COARSE * unit):
                spec = replace(spec, bits=16)
            elif not model.k or nodes[axis] in (1, MOST_NODES):
                break
            else:
                spec = spec.grown(axis)
            found.append(spec)
        return found

    def encode(self, model: Model, channels: Channels, spec: Spec) -> Tables:
        """Fit the tables of one size, and bound the guard."""
        wide, unit = bounds(model)
        order = rounds(model)
        points = tuple(
            fit_point(wide, one, tuple(n for n in nodes if n > 1), spec.bits, unit)
            for one, nodes in zip(order, spec.nodes, strict=True)
        )
        # Integers misplace both points of an edge, which turns its normal.
        misplaced = MISPLACED * unit
        off = misplaced * (2.0 * reach_of(wide) + misplaced) / least_edge_of(model)
        guard = ROUNDING + turned(wide, order, points) + (math.asin(off) if off < 1.0 else math.pi)
        places = []
        for p in model.recipe.parameters:
            room, span = sensor_tolerance(p), p.maximum - p.minimum
            whole = span + 2.0 * room
            first, rate = round(room / whole * 65536.0), round(span / whole * 2.0**30 / 32767.0)
            places.append((p.minimum - room, 1.0 / whole, first, rate))
        text = "what the errors of the tables' positions can turn a tip-over plane"
        code = order[0] | order[1] << 2 | order[2] << 4
        return Tables(spec, points, tuple(places), code, unit, guard, text)


INFO = Lookup()
