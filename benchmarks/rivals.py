"""What a user would otherwise put into flash for paper_two: tables of samples, and their errors.

Every rival is given what is known to help it: nodes beyond the tip-over boundary continue the
facet's own function instead of a saturated constant, and all errors are those of |SD_g| alone.
None of them carries the verdict "tips", which ours do.
"""

from collections.abc import Callable, Iterator
from itertools import product
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from firmware_export.model.exact import Model
from lutgen.recipe.kinematics import postures
from lutgen.vector import Floats

# Nodes per parameter and per side of the chart.
PARAMETER_NODES = (3, 5, 7, 9, 13, 17, 25)
CHART_NODES = (5, 9, 13, 17, 25, 33, 49, 65)
MOST_BYTES = 4 << 20
CUBIC_NODES = ((4, 6, 9, 13), (6, 9, 13, 17, 25))
ZFP_NODES = ((5, 7, 9, 13), (9, 13, 17, 25))
# In the length unit; paper_two's |SD_g| has a range of 22.
ZFP_TOLERANCES = tuple(2.0**n for n in range(-4, 7))


class Points(NamedTuple):
    """Standing points: `place` (n, k + 2) in [0, 1] over the parameters, v and u; `sdg` (n,)."""

    place: Floats
    sdg: Floats


class Result(NamedTuple):
    """A table of `bytes` bytes whose largest error is `error`, in percent of the range."""

    bytes: int
    error: float
    label: str


def exact_components(model: Model, params: Floats, gravity: Floats) -> Floats:
    """Return the components (m, d, 2) of D_g - s and their hypotenuse for every direction.

    D_g is held within three times the robot's size: a ray that hardly meets the facet's plane, or
    never, would fill a whole axis with one large number.
    """
    contacts = postures(model.recipe, params)[0]
    first, second, third = contacts[:, 0], contacts[:, 1], contacts[:, 2]
    normal = np.cross(second - first, third - first)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    height = np.sum(normal * first, axis=1)
    normal *= np.sign(height)[:, None]
    middle = contacts.mean(axis=1)
    along = np.array([1.0, 0.0, 0.0]) - normal * normal[:, :1]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    axes = np.stack([along, np.cross(normal, along)], axis=1)
    unit = gravity / np.linalg.norm(gravity, axis=-1, keepdims=True)
    rate = np.einsum("mc,mdc->md", normal, unit) / np.abs(height)[:, None]
    largest = 3.0 * np.linalg.norm(contacts, axis=2).max()
    length = np.where(rate * largest > 1.0, 1.0 / np.where(rate > 0.0, rate, 1.0), largest)
    offset = length[..., None] * unit - middle[:, None]
    return np.asarray(np.einsum("mac,mdc->mda", axes, offset))


def nodes(model: Model, per_parameter: int, per_side: int) -> Floats:
    """Return the components at the nodes of a regular grid, (parameters..., v, u, 2)."""
    t = np.array(list(product(np.linspace(0.0, 1.0, per_parameter), repeat=model.k)))
    place = np.linspace(-model.chart_limit, model.chart_limit, per_side)
    v, u = (a.ravel() for a in np.meshgrid(place, place, indexing="ij"))
    gravity = np.broadcast_to(model.uv_to_gravity(0, u, v), (len(t), len(u), 3))
    values = exact_components(model, model.lower + t * (model.upper - model.lower), gravity)
    return values.reshape(*[per_parameter] * model.k, per_side, per_side, 2)


@numba.njit(parallel=True)
def _interpolate(values: Floats, shape: NDArray[np.int64], place: Floats, out: Floats) -> None:
    """Interpolate multilinearly; values (nodes, c) in C order, out (n, c)."""
    axes, channels = len(shape), values.shape[1]
    for i in numba.prange(len(place)):
        for corner in range(1 << axes):
            index, weight = 0, 1.0
            for a in range(axes):
                x = place[i, a] * (shape[a] - 1)
                cell = min(int(x), shape[a] - 2)
                upper = corner >> a & 1
                weight *= x - cell if upper else 1.0 - (x - cell)
                index = index * shape[a] + cell + upper
            for c in range(channels):
                out[i, c] += weight * values[index, c]


def interpolate(values: Floats, place: Floats) -> Floats:
    """Return (n, c) from node values (nodes..., c)."""
    shape = np.array(values.shape[:-1])
    out = np.zeros((len(place), values.shape[-1]))
    flat = np.ascontiguousarray(values.reshape(-1, values.shape[-1]), np.float64)
    _interpolate(flat, shape, place, out)
    return out


def error(points: Points, found: Floats) -> float:
    """Return the largest error of |SD_g|, percent, from |SD_g| (n, 1) or components (n, 2)."""
    off = np.abs(np.linalg.norm(found, axis=1) - points.sdg).max()
    return float(100.0 * off / np.ptp(points.sdg))


def _grids(model: Model) -> Iterator[tuple[int, int, Floats]]:
    """Yield node counts and components of grids that fit as float32 values of |SD_g|."""
    for q, g in product(PARAMETER_NODES, CHART_NODES):
        if 4 * q**model.k * g * g <= MOST_BYTES:
            yield q, g, nodes(model, q, g)


def multilinear(model: Model, points: Points) -> dict[str, list[Result]]:
    """Measure regular grids, float32 and as SciPy's RegularGridInterpolator holds them."""
    results: dict[str, list[Result]] = {
        "float32 grid of \\|SD_g\\|, multilinear": [],
        "float32 grid of the two components, multilinear": [],
        "SciPy RegularGridInterpolator of \\|SD_g\\|, linear": [],
    }
    length, components, scipy = results.values()
    for q, g, values in _grids(model):
        label = f"{q}x{q}x{g}x{g}"
        count = values.size // 2
        single = values.astype(np.float32).astype(np.float64)
        norm = np.linalg.norm(values, axis=-1, keepdims=True)
        off = error(points, interpolate(norm.astype(np.float32).astype(np.float64), points.place))
        length.append(Result(4 * count, off, label))
        # The same interpolant: SciPy keeps its values as float64.
        scipy.append(Result(8 * count, error(points, interpolate(norm, points.place)), label))
        if 8 * count <= MOST_BYTES:
            off = error(points, interpolate(single, points.place))
            components.append(Result(8 * count, off, label))
    return results


def cubic(model: Model, points: Points) -> dict[str, list[Result]]:
    """Measure cubic splines through the nodes: RegularGridInterpolator's method "cubic".

    That interpolant is the tensor product of not-a-knot splines; it is built here axis by axis,
    which takes no linear solver over all nodes.
    """
    from scipy.interpolate import NdBSpline, make_interp_spline

    results: dict[str, list[Result]] = {
        "SciPy RegularGridInterpolator of \\|SD_g\\|, cubic": [],
        "SciPy RegularGridInterpolator of the two components, cubic": [],
    }
    length, components = results.values()
    for q, g in product(*CUBIC_NODES):
        if 8 * q**model.k * g * g > MOST_BYTES // 4:
            continue
        values = nodes(model, q, g)
        label = f"{q}x{q}x{g}x{g}"
        norm = np.linalg.norm(values, axis=-1, keepdims=True)
        for which, array in ((length, norm), (components, values)):
            knots = []
            for axis, n in enumerate(array.shape[:-1]):
                spline = make_interp_spline(np.linspace(0.0, 1.0, n), array, 3, axis=axis)
                knots.append(spline.t)
                array = np.moveaxis(spline.c, 0, axis) if axis else spline.c
            found = NdBSpline(tuple(knots), array, 3)(points.place)
            which.append(Result(8 * array.size, error(points, found), label))
    return results


def zfp(model: Model, points: Points) -> dict[str, list[Result]]:
    """Measure grids of the components that zfp holds at fixed accuracy, read multilinearly."""
    import zfpy

    found = []
    for q, g in product(*ZFP_NODES):
        values = nodes(model, q, g).astype(np.float32)
        parts = [np.ascontiguousarray(values[..., c]) for c in range(2)]
        for tolerance in ZFP_TOLERANCES:
            packed = [zfpy.compress_numpy(part, tolerance=tolerance) for part in parts]
            whole = np.stack([zfpy.decompress_numpy(one) for one in packed], axis=-1)
            off = error(points, interpolate(whole, points.place))
            size = sum(len(one) for one in packed)
            found.append(Result(size, off, f"{q}x{q}x{g}x{g} to {tolerance:g}"))
    return {"zfp of the two components, fixed accuracy": found}


RIVALS: tuple[Callable[[Model, Points], dict[str, list[Result]]], ...] = (multilinear, cubic, zfp)
