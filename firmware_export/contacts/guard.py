"""Guard of the `contacts` codec: how far its verdict can be off, from geometry alone.

A direction g on the boundary of the real standing region points at a point x of the segment between
two contact points (i, j), at the distance |x| >= d from the com.  The stored tip-over plane, unit
normal m', contains the same combination of the stored contacts, so the stored clearance of g is at
most asin(max |m' . e| / d) with e the errors of the two contacts.  That is computed with the real
plane's normal m over a lattice of postures; between its places the errors drift (bounded slope
times half a step), the planes turn (speed / d) and m' is not m (at most 2 |e| / d apart).  A disc's
contact point also moves along its rim when the facet's normal turns in its rolling direction: by at
most the sum of the errors of two of the facet's contacts over its extent in that direction, and the
same again for a skewed facet.  Both are taken facet by facet: those with a short extent stand on
contacts near each other, which are seldom those that err most.  The
runtime merges what lies within its tolerance of a plane; a rim of radius r stays as near to it over
sqrt(2 r tolerance).

A robot of many parameters has few places along each: random postures join its lattice, so that the
least width and extent of a facet are not those of the box's corners alone.

The least distance d is that over the lattice less what an edge moves between its places.  Where
that is little, as it is with few places along each parameter, the runtime refuses
facets to which the com is nearer than `lowest`: their edges are then that far away, and so is a
chord of a rolling rim but for its sag.

The com may lie anywhere within `com_uncertainty` rho of the computed one: that turns the plane of
an axis at the distance d by at most asin(rho / d), and the least d of all is counted everywhere.
The runtime refuses facets that may lie less than rho below the com.

The limit `upright` compares facet normals, which the same error turns.  The runtime gets it
tightened by twice 2 |e| over the facet's width.  Facets narrower than a twentieth of the robot,
whose normals mean little, are left out.

The runtime stands on rests and answers tips in the gaps between them, so every edge of a rest is
one of its tip-over axes, also where the robot would be caught beyond.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.contacts.fit import Codes
from firmware_export.contacts.modes import DENSE, Separation, evaluate
from firmware_export.truth import Model, combinations
from lutgen.channels import acceptance_of
from lutgen.jit import in_threads, njit
from lutgen.support import (
    FACETS,
    FIRST,
    HEIGHT,
    KIND,
    MASK,
    PLANE,
    POINT,
    SEGMENTS,
    SOURCE,
    SPHERE,
    START,
    STOP,
    TIP_PLANE,
    Acceptance,
    empty_region,
    facet_table,
    pack,
    stand,
    vector_at,
)
from lutgen.vector import Floats, cross, dot, length, subtract

POSTURES = 20_000
# With fewer places than this along each parameter as many random postures as RANDOM join them.
FEW_PLACES, RANDOM = 16, 4000
# Postures that are measured at once: bounds the memory, 14 kB of segments for each contact.
AT_ONCE = 256
NARROW = 0.05
# Postures and directions of each that are looked at for the heights at which the robot stands, and
# the share of them that may be refused.
SEEN, SEEN_DIRECTIONS, RARE = 2000, 16, 0.0005
HEADROOM = 0.97
# float32 rounding of a width, in robot sizes.
WIDER = 1e-5
ROUNDING = 4e-6
"""rad; float32 rounding of a direction, of the chart's rim and of the arcsine."""


class Guard(NamedTuple):
    """What the runtime needs to be never falsely safe.

    The guard (rad), by how much limits are tightened (rad), the height of the com above a facet
    from which on it is accepted (length), by how much a rest must be wider (length), and a sentence
    about them.
    """

    angle: float
    tighter: float
    lowest: float
    wider: float
    text: str


class _Measures(NamedTuple):
    """What the guard needs of postures, a row for each.

    `out` (m, 5): the least distance of a boundary segment; the least width of a facet; the number
    of segments and of facets; the least height of the com above a facet.  `segments` (m, S, 6): the
    normal of the tip-over plane, the segment's distance, its two contacts.  Per facet `touching`
    (m, F), the bit set of its contacts, and `extent` (m, F), the least along the rolling direction
    of a disc.
    """

    out: Floats
    segments: Floats
    touching: NDArray[np.int64]
    extent: Floats


@njit()
def _measure(
    primitives: Floats, acceptance: Acceptance, narrow: float, row: int, found: _Measures
) -> None:
    """Write a row of measures: those of one posture."""
    n = primitives.shape[0]
    table, region = facet_table(n), empty_region(n)
    stand(table, region, primitives, acceptance)
    out, segments = found.out[row], found.segments[row]
    nearest = narrowest = lowest = math.inf
    for k in range(region.tally[FACETS]):
        begin, end = region.span[k, FIRST], region.span[k + 1, FIRST]
        normal = vector_at(region.facet, k, PLANE)
        lowest = min(lowest, region.facet[k, HEIGHT])
        width = shortest = math.inf
        rolls = False
        for i in range(n):
            rolls = rolls or primitives[i, KIND] == SPHERE
            axle = (primitives[i, 3], primitives[i, 4], primitives[i, 5])
            track = cross(axle, normal)
            size = length(track)
            if size > 0.0:
                low, high = math.inf, -math.inf
                for e in range(begin, end):
                    ahead = dot(vector_at(region.edge, e, POINT), track) / size
                    low, high = min(low, ahead), max(high, ahead)
                if high - low > narrow:
                    shortest = min(shortest, high - low)
        for e in range(begin, end):
            start = vector_at(region.edge, e, POINT)
            along = subtract(vector_at(region.edge, e + 1 if e + 1 < end else begin, POINT), start)
            size = length(along)
            furthest = 0.0
            for other in range(begin, end):
                arm = subtract(vector_at(region.edge, other, POINT), start)
                if size > 0.0:
                    furthest = max(furthest, length(cross(arm, along)) / size)
            width = min(width, furthest)
        if width > narrow:
            narrowest = min(narrowest, width)
            if rolls:  # spheres roll any way
                shortest = min(shortest, width)
        found.touching[row, k] = table.span[region.span[k, SOURCE], MASK]
        found.extent[row, k] = shortest
    for b in range(region.tally[SEGMENTS]):
        start = vector_at(region.segment, b, START)
        along = subtract(vector_at(region.segment, b, STOP), start)
        size = dot(along, along)
        part = min(max(-dot(start, along) / size, 0.0), 1.0) if size > 0.0 else 0.0
        distance = length(
            (
                start[0] + part * along[0],
                start[1] + part * along[1],
                start[2] + part * along[2],
            )
        )
        nearest = min(nearest, distance)
        for i in range(3):
            segments[b, i] = region.segment[b, TIP_PLANE + i]
        segments[b, 3] = distance
        segments[b, 4], segments[b, 5] = region.contacts[b, 0], region.contacts[b, 1]
    out[0], out[1], out[2] = nearest, narrowest, region.tally[SEGMENTS]
    out[3], out[4] = region.tally[FACETS], lowest


@njit()
def _measure_some(
    begin: int,
    end: int,
    primitives: Floats,
    acceptance: Acceptance,
    narrow: float,
    found: _Measures,
) -> int:
    for posture in range(begin, end):
        _measure(primitives[posture], acceptance, narrow, posture, found)
    return end - begin


class Geometry:
    """A model over a lattice of postures; what does not depend on the tables is measured once."""

    def __init__(self, model: Model, separation: Separation) -> None:
        # The search for facets of many contacts takes 30 times as long as that of three points.
        postures = POSTURES if model.is_tripod else POSTURES // 4
        per_axis = max(2, math.floor(postures ** (1.0 / max(model.k, 1))))
        per_axis = min(per_axis, DENSE)
        self.step = 1.0 / (per_axis - 1) + 1.0 / (DENSE - 1)
        knots = np.rint(np.linspace(0, DENSE - 1, per_axis)).astype(np.int64)
        self.places = combinations([knots] * model.k)
        if per_axis < FEW_PLACES and model.k > 0:
            # A lattice of two or three places per axis sees corners and next to nothing between.
            random = np.random.default_rng(1).integers(0, DENSE, (RANDOM, model.k))
            self.places = np.concatenate([self.places, random])
        self.model = model
        self.exact = evaluate(separation, self.places)
        where = model.postures(model.at(self.places / (DENSE - 1)))
        self.primitives = pack(where.centres, where.axes, model.radius, model.kind)
        reach = float(np.sqrt((where.centres**2).sum(axis=2)).max())
        self.size = reach + float(model.radius.max(initial=0.0))
        found = self._measured()
        self.nearest, self.narrowest = float(found[:, 0].min()), float(found[:, 1].min())
        self.lowest = float(found[:, 4].min())
        self.low = self._low()

    def _low(self) -> float:
        """Return a height that next to nothing of what stands on the chart falls below."""
        model, rng = self.model, np.random.default_rng(0)
        params = model.at(rng.random((SEEN, model.k)))
        face = rng.integers(0, model.faces, (SEEN, SEEN_DIRECTIONS))
        u, v = rng.uniform(-model.chart_limit, model.chart_limit, (2, *face.shape))
        seen = model.exact(params, model.uv_to_gravity(face, u, v))
        heights = seen.height[seen.tip_angle >= 0.0]
        return HEADROOM * float(np.quantile(heights, RARE)) if heights.size else 0.0

    def _measured(self) -> Floats:
        """Return rows of measures and keep what no table changes: segments, and facets' extents."""
        recipe, primitives = self.model.recipe, self.primitives
        accept = acceptance_of(recipe)
        out = np.empty((len(primitives), 5))
        region = empty_region(primitives.shape[1])
        room = np.empty((AT_ONCE, len(region.segment), 6))
        facets = AT_ONCE, len(region.facet)
        touching, extent = np.empty(facets, np.int64), np.empty(facets)
        kept, of = [np.empty((0, 6))], [np.empty(0, np.intp)]
        self._extents: dict[int, float] = {}
        for begin in range(0, len(primitives), AT_ONCE):
            some = slice(begin, min(begin + AT_ONCE, len(primitives)))
            in_threads(
                *(_measure_some, some.stop - begin, primitives[some], accept),
                *(NARROW * self.size, _Measures(out[some], room, touching, extent)),
            )
            there = np.arange(facets[1]) < out[some, 3][:, None]
            sets, which = np.unique(touching[: len(there)][there], return_inverse=True)
            least = np.full(len(sets), math.inf)
            np.minimum.at(least, which, extent[: len(there)][there])
            for one, size in zip(sets.tolist(), least.tolist(), strict=True):
                self._extents[one] = min(size, self._extents.get(one, math.inf))
            count = out[some, 2].astype(np.intp)
            here = np.arange(room.shape[1]) < count[:, None]
            kept.append(room[: len(count)][here])
            of.append(np.repeat(np.arange(begin, begin + len(count)), count))
        self._segments, self._posture = np.concatenate(kept), np.concatenate(of)
        return out

    def across(self, stored: Separation, floor: float) -> tuple[float, float]:
        """Return the largest error across a tip-over plane over its distance, and of an axis.

        The distance counts as `floor` at least.
        """
        n = len(self.model.kind)
        apart = evaluate(stored, self.places) - self.exact
        error = apart[:, : 3 * n].reshape(-1, n, 3)
        hinge = np.sqrt((apart[:, 3 * n :].reshape(len(apart), -1, 3) ** 2).sum(axis=2))
        normal, distance = self._segments[:, :3], np.maximum(self._segments[:, 3], floor)
        ends = self._segments[:, 4:].astype(np.intp)
        worst = [
            np.abs((error[self._posture, end] * normal).sum(axis=1)) / distance for end in ends.T
        ]
        return float(np.max(worst, initial=0.0)), float(hinge.max(initial=0.0))

    def rolled(self, error: Floats) -> float:
        """Return how far a contact moves along its rim (length), with errors (n,) of contacts."""
        radius = self.model.radius
        furthest = 4.0 * float(error.max()) / self.size * float(radius.max(initial=0.0))
        for touching, extent in self._extents.items():
            of = [i for i in range(len(error)) if touching >> i & 1]
            turned = 2.0 * float(np.sort(error[of])[-2:].sum()) / extent
            furthest = max(furthest, turned * float(radius[of].max()))
        return furthest


def contacts_guard(model: Model, geometry: Geometry, codes: Codes, merged: float) -> Guard:
    """Return the guard of tables.

    `merged` is the distance from a facet's plane within which the runtime takes a contact to touch.

    A robot that stands in no posture of the lattice, or whose com may reach one of its edges, gets
    the guard pi: nothing is then called safe.
    """
    delta = float(codes.position_error.max())
    half = geometry.step / 2.0
    moved = float(codes.speed.sum(axis=0).max(initial=0.0)) * half
    largest = float(model.radius.max(initial=0.0))
    nearest, lowest = geometry.nearest - moved, merged
    sag = largest * (1.0 - math.cos(model.recipe.rock_angle / 2.0))
    if not nearest >= geometry.low - sag - delta:
        nearest, lowest = geometry.low - sag - delta, geometry.low
    if not math.isfinite(nearest) or nearest <= 2.0 * delta:
        text = "the com may reach an edge of its support: nothing is safe"
        return Guard(math.pi, 0.0, merged, 0.0, text)
    rho = model.recipe.com_uncertainty
    if rho > 0.0 and nearest <= rho + 2.0 * delta:
        text = "the uncertain com may reach an edge of its support: nothing is safe"
        return Guard(math.pi, 0.0, lowest, 0.0, text)
    if rho > 0.0 and geometry.lowest - moved <= rho + 2.0 * delta:
        # Then the runtime itself must tell which facets are below every com of the ball.
        lowest = max(lowest, rho + 2.0 * delta)
    across, hinge = geometry.across(codes.stored, nearest)
    turned = (2.0 * delta + merged) / min(geometry.narrowest, geometry.size)
    rolled = geometry.rolled(codes.position_error) + 2.0 * largest * hinge
    round_part = rolled + math.sqrt(2.0 * largest * merged)
    between = codes.drift * half + delta * (moved + 2.0 * delta) / nearest
    sine = min(across + between / nearest, delta / nearest) + round_part / nearest
    angle = math.asin(min(sine, 1.0)) + ROUNDING
    swayed = math.asin(min(rho / nearest, 1.0))
    angle += swayed
    tighter = min(2.0 * turned, math.radians(5.0))
    unit = model.recipe.length_unit
    named = "" if unit == "1" else f" {unit}"
    text = (
        f"stored contacts lie within {delta:.3g}{named} of the real ones and move a tip-over plane "
        f"by at most {math.degrees(angle):.3g} deg, {nearest:.4g}{named} being the least distance "
        f"of an edge from the com; limits of normals are tightened by {math.degrees(tighter):.3g} "
        "deg"
    )
    if lowest > merged:
        text += f"; facets to which the com is nearer than {lowest:.4g}{named} are refused"
    if rho > 0.0:
        text += f"; the com's ball of {rho:.4g}{named} takes {math.degrees(swayed):.3g} deg of it"
    wider = 4.0 * delta + merged + WIDER * geometry.size
    return Guard(angle, tighter, lowest, wider, text)
