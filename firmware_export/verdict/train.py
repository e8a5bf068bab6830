"""Verdict of the codec `grid` for any robot: a table that separates what stands from what tips.

Owns the fit for robots whose standing region is not one smooth cone.  What matters is the sign.
The table is trained like a support vector machine with a squared hinge: standing directions pull
it above zero, tipping ones and the outlines of `outline` push it below.  How large the tip margin
is binds it only loosely.  Then it is rounded down to codes and lowered until no outline is above
zero (`lower`), which is the proof; training only makes that cheap.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import Codes, Lattice, conjugate, to_places
from firmware_export.truth import Model, Sample, combinations, uniform, uniform_directions
from firmware_export.verdict.knots import sub_cells
from firmware_export.verdict.lower import Places, excess
from firmware_export.verdict.outline import Outlines, outlines
from lutgen.vector import Bools, Floats

SEED = 71
# Points of training: postures at most, directions of each, and points per node: configurations,
# and places on outlines.  More and longer training gives up a hundredth less in twice the time.
POSTURES, DIRECTIONS = 25_000, 60
DENSITY, ON_OUTLINES = 30.0, 8.0
ROUNDS, STEPS = 14, 12
# Sweeps that lower the table by this share of what a node by itself would have to fall (its
# neighbours fall too): by the outlines of each posture alone, which takes a ninth of the time, then
# by all next to it.  How far below zero (codes), and how far it must be in the end.
ALONE, PACES = (0.15, 0.15, 0.2, 0.2, 0.25, 0.3), (0.3, 0.4, 0.5, 0.7, 1.0, 1.0)
SPARE, TINY = 0.1, 1e-3
# Margin and range of the table, and the weights of value, of tipping points and of the prior.
MARGIN, REACH, VALUE, PUSH, PRIOR = 0.02, 0.6, 0.02, 8.0, 1e-3
# Rounds before which outlines above zero are sought, and how far below zero these must be.
MINING, FIRM = (3, 5, 7, 9, 11), 0.004
# Standing points nearer to the outline than this (rad) are left out of training.
NEAR = 0.005
# Tip angles (rad) that count in the first fit.
CLIP = 0.26


@lru_cache(maxsize=2)
def _points(model: Model) -> tuple[Floats, NDArray[np.int64], Floats]:
    """Return places, faces and tip angles of the training's points."""
    rng = np.random.default_rng(SEED)
    params = uniform(model, 40 * POSTURES, SEED).params[:POSTURES]
    sample = Sample(params, uniform_directions(model, rng, (len(params), DIRECTIONS)))
    place, face = to_places(model, sample)
    return place, face, model.exact(sample.params, sample.gravity).tip_angle.ravel()


def _corners(found: Outlines, posture: NDArray[np.int64], rng: np.random.Generator) -> list[Floats]:
    """Return of each parameter its values (n,) at random postures next to some, or at these."""
    if not found.axes:
        return []
    at = np.unravel_index(posture, tuple(map(len, found.axes)))
    return [
        axis[np.clip(index + rng.integers(-1, 2, len(posture)), 0, len(axis) - 1)]
        for axis, index in zip(found.axes, at, strict=True)
    ]


def _outline_points(
    found: Outlines, faces: int, count: int, seed: int
) -> tuple[Floats, NDArray[np.int64]]:
    """Return places and faces of random points of the outlines, at postures next to theirs.

    None where nothing is outlined, as where the robot stands nowhere by what a table may say.
    """
    rng = np.random.default_rng(seed)
    pieces = len(found.pieces)
    piece = rng.integers(max(pieces, 1), size=count if pieces else 0)
    owner = np.searchsorted(found.first, piece, side="right") - 1
    posture, face = owner // faces, owner % faces
    params = _corners(found, posture, rng)
    ends = found.pieces[piece].astype(np.float64)
    along = rng.random((len(piece), 1))
    uv = ends[:, :2] + along * (ends[:, 2:] - ends[:, :2])
    return np.column_stack([*params, uv[:, 1], uv[:, 0]]), face


def _knot_points(
    lattice: Lattice, found: Outlines, faces: int, count: int, seed: int
) -> tuple[Floats, NDArray[np.int64]]:
    """Return random knots of (u, v) that tip, at postures next to those where they do."""
    rng = np.random.default_rng([seed, 1])
    posture = rng.integers(len(found.tips), size=count)
    knot = rng.integers(found.tips.shape[1], size=count)
    tips = found.tips[posture, knot]
    posture, knot = posture[tips], knot[tips]
    params = _corners(found, posture, rng)
    v, u = lattice.ends[-2:]
    face, row, column = np.unravel_index(knot, (faces, len(v), len(u)))
    return np.column_stack([*params, v[row], u[column]]), face.astype(np.int64)


class _Points:
    """The training's points: cells and weights, what the table should be, and the verdict."""

    def __init__(self, model: Model, lattice: Lattice, found: Outlines) -> None:
        self.lattice, self.found, self.faces = lattice, found, model.faces
        place, face, tip = _points(model)
        kept = np.flatnonzero((tip < 0.0) | (tip > NEAR))
        nodes = lattice.faces * lattice.face_nodes
        kept = kept[: min(len(kept), round(DENSITY * nodes))]
        place, face, tip = place[kept], face[kept], tip[kept]
        uv = (2.0 * place[:, -2:] - 1.0) * model.chart_limit
        aim = np.sin(tip) * np.sqrt(1.0 + (uv * uv).sum(axis=1))
        self.aim = np.clip(aim, -REACH, REACH)
        self.spots = lattice.spots(place, face)
        self.distance = np.abs(tip)
        self.seed = SEED + 50

    def add_tipping(self, count: int, node: Floats | None) -> None:
        """Add points that tip: any, or of many only those where the table is too high."""
        self.seed += 1
        some = _outline_points(self.found, self.faces, count, self.seed)
        more = _knot_points(self.lattice, self.found, self.faces, count // 4, self.seed)
        place, face = (np.concatenate(pair) for pair in zip(some, more, strict=True))
        spots = self.lattice.spots(place, face)
        if node is not None:
            spots = spots.part(spots.at(node) > -0.5 * MARGIN)
        self.spots = self.spots.joined(spots)
        self.aim = np.concatenate([self.aim, np.full(len(spots), -1e-6)])
        self.distance = np.concatenate([self.distance, np.zeros(len(spots))])
        # Neighbours in the table next to each other: far fewer misses of the cache.
        order = np.argsort(self.spots.first, kind="stable")
        self.spots = self.spots.part(order)
        self.aim, self.distance = self.aim[order], self.distance[order]

    def change(self, weigh: Floats, miss: Floats, prior: float) -> Floats:
        """Return the change of the nodes (n,) that takes weighted misses away, by least squares."""
        prior *= len(miss) / self.spots.nodes
        right = self.spots.spread(weigh * miss)
        scale = self.spots.spread(weigh, power=2) + prior
        return conjugate(
            right, scale, lambda way: self.spots.spread(weigh, way) + prior * way, STEPS
        )


def train(model: Model, lattice: Lattice, found: Outlines) -> Floats:
    """Return the nodes (n,) of a table that is above zero where the robot stands, nearly."""
    points = _Points(model, lattice, found)
    count = round(ON_OUTLINES * lattice.faces * lattice.face_nodes)
    points.add_tipping(count, None)
    weigh = np.exp(-points.distance / CLIP) + 0.05
    node = points.change(weigh, points.aim, PRIOR)
    for turn in range(ROUNDS):
        if turn in MINING:
            points.add_tipping(4 * count, node)
        aim, here = points.aim, points.spots.at(node)
        safe = aim > 0.0
        floor = np.minimum(MARGIN, np.where(points.distance > 0.0, np.abs(aim), FIRM))
        low, high = np.where(safe, floor, -REACH), np.where(safe, REACH, -floor)
        miss = np.clip(here, low, high) - here
        # Standing points far on the wrong side are given up: they count less and less.
        far = safe & (here < -4.0 * MARGIN)
        weigh = np.where(far, (4.0 * MARGIN / np.minimum(here, -1e-9)) ** 2, 1.0)
        weigh = np.where(safe, weigh, PUSH * 2.0 ** min(turn / 3.0, 4.0))
        wrong = np.abs(miss) > 0.0
        weigh = np.where(wrong, weigh, VALUE)
        miss = np.where(wrong, miss, aim - here)
        node = np.clip(node + points.change(weigh, miss, 5.0 * PRIOR * VALUE), -REACH, REACH)
    return node


def fit(model: Model, lattice: Lattice, bits: int) -> tuple[Codes, Outlines]:
    """Return the codes (faces, parameters..., v, u, 1), and the outlines that they respect."""
    nodes = lattice.faces * lattice.face_nodes
    found = outlines(model, sub_cells(model, nodes), lattice.directions())
    node = train(model, lattice, found)

    step = float(np.float32(2.0 * REACH / (2**bits - 1) * (1.0 + 1e-6)))
    offset = float(np.float32(-REACH))
    shape = (lattice.faces, *lattice.shape)
    level = np.moveaxis(((node - offset) / step).reshape(shape), 0, -3)
    level = np.ascontiguousarray(level.reshape(-1, lattice.faces, *lattice.shape[-2:]))
    index, weight = lattice.posture_corners(combinations(found.axes))
    counts = np.array([len(axis) for axis in found.axes], np.int64)
    v, u = lattice.ends[-2:]
    tips = anywhere_near(found.tips, counts)
    places = Places(index, weight, counts, found.pieces, found.first, tips, u, v)
    zero = -offset / step
    for around, paces in ((False, ALONE), (True, PACES)):
        which = None
        for pace in paces:
            # Nodes only fall: a posture that is below zero stays so and is not looked at again.
            drop, which = excess(level - (zero - SPARE), places, True, which, around)
            level -= pace * drop
    code = np.maximum(np.floor(level), 0.0)
    # The proof: all postures.
    code -= np.ceil(excess(code - (zero - TINY), places, False)[0])
    by_params = np.maximum(code, 0.0)
    code = np.moveaxis(by_params.reshape(*shape[1:-2], shape[0], *shape[-2:]), -3, 0)
    return Codes(code.astype(np.int64)[..., None], offset, step), found


def anywhere_near(tips: Bools, counts: NDArray[np.int64]) -> Bools:
    """Return `tips` (P, J) of each posture or of any that is next to it, on a lattice (k,)."""
    whole = tips.reshape(*counts, -1)
    for axis in range(len(counts)):
        before = whole
        whole = before.copy()
        ends = (slice(None),) * axis
        whole[(*ends, slice(1, None))] |= before[(*ends, slice(None, -1))]
        whole[(*ends, slice(None, -1))] |= before[(*ends, slice(1, None))]
    return np.ascontiguousarray(whole.reshape(tips.shape))
