"""Codec `grid` for three contacts whose facet is a rest in every posture.

Positions are looked up over the parameters alone; facet, walls and
readings follow from them exactly for every direction, with floats or without.  The guard is what
wrong positions can turn a tip-over plane (`across`).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from firmware_export.grid.points import (
    MOST_AXES,
    Point,
    bounds,
    curvature,
    depends_on,
    fit_point,
    reach_of,
    turned,
)
from firmware_export.model import Cells, Model, least_edge_of, rounds, sensor_tolerance, widened
from firmware_export.protocol import CArray, CBody, Channels, Codec
from firmware_export.protocol import Tables as AnyTables

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
