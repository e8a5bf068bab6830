"""Points that a tree learns from: configurations that stand or tip, and places on outlines.

Owns what trees are fitted to.  None of it decides what is safe: that is proved afterwards.
"""

import math
from typing import NamedTuple

import numpy as np

from firmware_export.grid import Fold
from firmware_export.truth import Model, uniform_directions, uniform_params
from firmware_export.verdict.fold import folded
from firmware_export.verdict.middles import AT_ONCE, Middles, each
from firmware_export.verdict.outline import Slab, View, draw, empty_sheet, too_many_pieces
from lutgen.jit import njit
from lutgen.vector import Floats, Ints, Singles

# Postures and directions of each.  Places on the outlines of every middle: so many in all, some at
# least of each, and at most so many of those that are drawn at once.
POSTURES, DIRECTIONS = 150_000, 40
PLACES, FEWEST, MOST = 7_000_000, 14, 1_000_000
# Postures that are measured at once.
MEASURED = 5_000
# Tip angles (rad) up to which every standing point is taken; the shares of the others and of those
# that tip; where tip angles are clipped; how fast the weight of a point falls with its tip angle,
# and to what; the weight of a place on an outline.
NEAR, SHARE_INSIDE, SHARE_OUTSIDE = math.radians(5.0), 0.15, 0.1
CLIP, FADE, LEAST, ON_OUTLINE = math.radians(6.0), math.radians(3.0), 0.02, 0.5
SEED = 71


class Points(NamedTuple):
    """Points of one face: places x (n, d), and (n,) each what the tree's value should be there.

    `aim`: the tip angle (rad), clipped; 0 on an outline.  `weight` in fits.  `worth`: how many
    configurations a point stands for, 0 where the tree must not say that it is safe.
    """

    x: Singles
    aim: Singles
    weight: Singles
    worth: Singles


class _Mixed(NamedTuple):
    """Points of all faces, and the face of each (n,)."""

    points: Points
    face: Ints


def _measured(model: Model, fold: Fold, params: Floats, rng: np.random.Generator) -> _Mixed:
    """Return configurations of some postures, thinned out far from where they tip."""
    gravity = uniform_directions(model, rng, (len(params), DIRECTIONS))
    tip = model.tip_angle(model.postures(params), gravity)
    share = np.where(tip < 0.0, SHARE_OUTSIDE, np.where(tip < NEAR, 1.0, SHARE_INSIDE))
    post, way = np.nonzero(rng.random(tip.shape) < share)
    kept, towards = tip[post, way], gravity[post, way]
    face, u, v, _ = model.recipe.chart.locate(towards)
    x = np.empty((len(kept), model.k + 2), np.float32)
    x[:, :-2] = ((params - model.lower) / (model.upper - model.lower))[post]
    x[:, -2] = 0.5 + 0.5 * np.clip(u / model.chart_limit, -1.0, 1.0)
    x[:, -1] = folded(fold, np.clip(v / model.chart_limit, -1.0, 1.0))
    worth = np.where(kept < 0.0, 0.0, 1.0 / share[post, way])
    weight = (np.exp(-np.abs(kept) / FADE) + LEAST) * np.maximum(worth, 1.0)
    aim = np.clip(kept, -CLIP, CLIP)
    return _Mixed(Points(x, *(a.astype(np.float32) for a in (aim, weight, worth))), face)


def _of_sample(model: Model, fold: Fold) -> list[_Mixed]:
    """Return the configurations of a sample."""
    params = uniform_params(model, np.random.default_rng(SEED), POSTURES)

    def measured(at: int) -> _Mixed:
        rng = np.random.default_rng([SEED, at])
        return _measured(model, fold, params[at : at + MEASURED], rng)

    return each(measured, range(0, len(params), MEASURED))


@njit()
def _pick(slab: Slab, view: View, lots: Floats, out: Floats, faces: Ints) -> int:
    """Fill `out` (m, n, k + 2) with places on outlines, u and v from -1 to 1, and `faces` (m, n).

    `lots` (m, n, k + 2) decide.  A face of -1 is none.  Returns 1 where pieces are too many.
    """
    sheet = empty_sheet(slab.primitives.shape[1], len(view.basis))
    k = slab.low.shape[1]
    faces[:] = -1
    for p in range(len(out)):
        total = draw(sheet, slab, p, view)
        if total < 0:
            return 1
        if total == 0:
            continue
        for n in range(out.shape[1]):
            at = int(lots[p, n, 0] * total)
            piece = sheet.pieces[at]
            face = 0
            while at >= sheet.counts[face]:
                at -= sheet.counts[face]
                face += 1
            faces[p, n] = face
            for a in range(k):
                # At one of the corners for which the middle speaks.
                side = slab.low if lots[p, n, 2 + a] < 0.5 else slab.high
                out[p, n, a] = side[p, a]
            for c in range(2):
                out[p, n, k + c] = piece[c] + lots[p, n, 1] * (piece[2 + c] - piece[c])
    return 0


def _of_outlines(middles: Middles, view: View, fold: Fold) -> list[_Mixed]:
    """Return places on the outlines of all middles."""
    slabs = list(middles.slabs())
    count = middles.per_axis**middles.k
    places = max(FEWEST, min(PLACES // count, MOST // min(count, AT_ONCE)))
    seeds = np.random.default_rng([SEED, 6]).integers(1 << 62, size=len(slabs))

    def picked(at: int) -> _Mixed:
        slab = middles.slab(*slabs[at])
        m, k = slab.low.shape
        lots = np.random.default_rng(seeds[at]).random((m, places, k + 2))
        out, face = np.empty((m, places, k + 2)), np.empty((m, places), np.int64)
        if _pick(slab, view, lots, out, face):
            raise too_many_pieces(middles.model)
        held = face >= 0
        x = out[held]
        x[:, -2] = 0.5 + 0.5 * x[:, -2]
        x[:, -1] = folded(fold, x[:, -1])
        nothing = np.zeros(len(x), np.float32)
        weight = np.full(len(x), ON_OUTLINE, np.float32)
        return _Mixed(Points(x.astype(np.float32), nothing, weight, nothing), face[held])

    return each(picked, range(len(slabs)))


def points_of(middles: Middles, view: View, fold: Fold) -> list[Points]:
    """Return per face the points from which its tree learns."""
    parts = _of_sample(middles.model, fold) + _of_outlines(middles, view, fold)

    def on(face: int) -> Points:
        here = [part.face == face for part in parts]
        return Points(
            *(
                np.concatenate([column[which] for which, column in zip(here, columns, strict=True)])
                for columns in zip(*(part.points for part in parts), strict=True)
            )
        )

    return [on(face) for face in range(middles.model.faces)]
