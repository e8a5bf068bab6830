"""Read a stability map: its values, what lies between its nodes, and figures about the whole.

It is interpolated multilinearly in float64: the reference for every decoder.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.chart import Chart
from lutgen.errors import InputError, MapFileError, optional, reject
from lutgen.grid import Axis
from lutgen.mapping.head import Layout, check_seal
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe, within_limits

# Lower knot (m,) and place inside the cell (m,), 0 to 1, on an axis; the lower knot may be the last
# where the place is 0.
Place = tuple[NDArray[np.intp], NDArray[np.float64]]


def locate(knots: NDArray[np.float64], values: NDArray[np.float64]) -> Place:
    """Return the cells of values (m,) and the places in them; what is beyond an end is at it."""
    if len(knots) == 1:
        return np.zeros(len(values), np.intp), np.zeros(len(values))
    index = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, len(knots) - 2)
    low, high = knots[index], knots[index + 1]
    return index, np.clip((values - low) / (high - low), 0.0, 1.0)


def _corners(
    values: NDArray[Any], places: Sequence[Place], extra: tuple[NDArray[np.intp], ...]
) -> Iterator[tuple[NDArray[Any], NDArray[np.float64]]]:
    """Yield the values (m,) at each of the 2^d corners of the queries' cells, and their weights.

    Corners that weigh nothing for every query are left out.  The weights of a query add up to 1,
    and at a node the node's weight is exactly 1.
    """
    for corner in product((False, True), repeat=len(places)):
        index: list[NDArray[np.intp]] = []
        weight = np.ones(len(places[-1][0]))
        for (lower, frac), upper in zip(places, reversed(corner), strict=True):
            # Where frac is 0 the upper knot may not exist and does not count.
            index.append(np.where(frac > 0.0, lower + 1, lower) if upper else lower)
            weight *= frac if upper else 1.0 - frac
        if (weight > 0.0).any():
            yield values[(*index[:-2], *extra, *index[-2:])], weight


def interpolate(
    values: NDArray[np.floating], places: Sequence[Place], extra: tuple[NDArray[np.intp], ...] = ()
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return means (m,) of the cells' corners that are not NaN, and the shares (m,) of these.

    The axes of `values` are in the order of `places`, whose last two are v and u, with those of
    `extra` in between, taken as they are: the face of each query (m,).  A result is NaN where no
    corner with a weight is a number; a share is 1 away from the tip-over boundary.
    """
    total, present = np.zeros((2, len(places[-1][0])))
    for node, weight in _corners(values, places, extra):
        usable = ~np.isnan(node) & (weight > 0.0)
        total += np.where(usable, node * weight, 0.0)
        present += np.where(usable, weight, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        # Where all corners count the weights add up to 1 but for rounding, which stays out.
        whole = present > 1.0 - 1e-12
        return np.where(whole, total, total / present), np.where(whole, 1.0, present)


def worst(
    values: NDArray[np.uint8], places: Sequence[Place], extra: tuple[NDArray[np.intp], ...] = ()
) -> NDArray[np.uint8]:
    """Return the largest value (m,) among the corners of each query's cell that have a weight."""
    largest = np.zeros(len(places[-1][0]), np.uint8)
    for node, weight in _corners(values, places, extra):
        largest = np.where(weight > 0.0, np.maximum(largest, node), largest)
    return largest


if TYPE_CHECKING:
    import xarray

# Parts of a cell by which a place may be beside a node and be at it, where nothing is interpolated:
# a direction comes back from its unit vector to 2e-16, and from degrees to a few times that.
AT = 1e-9
# Root attributes that are about the bytes of the file, and not about its content.
OF_THE_FILE = ("digest", "complete")


@dataclass(frozen=True, repr=False)
class StabilityMap:
    """A stability map on disk; values are read on access.

    `layout` says where a sealed file has its values, and `digests` (blocks, channels, bytes) what
    they must match; None for a file that is read though it is not sealed.
    """

    path: str
    recipe: Recipe
    attributes: dict[str, Any]
    layout: Layout | None = None
    digests: NDArray[np.uint8] | None = None
    _values: dict[str, NDArray[Any]] = field(default_factory=dict)

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The geometry parameters with their knots (rad or length)."""
        return self.recipe.grid.axes

    @property
    def chart(self) -> Chart:
        """The chart of gravity directions."""
        return self.recipe.chart

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels that the file holds."""
        return self.recipe.channels

    @property
    def dims(self) -> dict[str, int]:
        """Sizes of the dimensions (parameters..., face, v, u) by name."""
        names = (*(axis.name for axis in self.axes), "face", "v", "u")
        sizes = (*self.recipe.grid.shape, *self.chart.shape)
        return dict(zip(names, sizes, strict=True))

    def __repr__(self) -> str:
        dims = ", ".join(f"{name}: {size}" for name, size in self.dims.items())
        return f"<StabilityMap {self.recipe.name} ({dims}) {' '.join(self.channels)}>"

    def _repr_html_(self) -> str:
        rows = {
            axis.name: f"{axis.knots[0]:.6g} to {axis.knots[-1]:.6g} {axis.unit}"
            for axis in self.axes
        }
        rows |= {name: QUANTITIES[name].title for name in self.channels}
        body = "".join(f"<tr><th>{k}</th><td>{escape(v)}</td></tr>" for k, v in rows.items())
        return f"<table><caption>{escape(repr(self))}</caption>{body}</table>"

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.channel(name)

    def channel(self, name: str) -> NDArray[Any]:
        """Return all values of a channel, axes (parameters..., face, v, u).

        They are float32, and uint8 of `status`: 0 stands, 1 rocks, 2 tips.  MapFileError is raised
        if they do not match their digests.
        """
        self._index(name)
        if name not in self._values:
            shape = tuple(self.dims.values())
            values = np.empty((int(np.prod(shape[:-1])), shape[-1]), QUANTITIES[name].stored_type)
            for row, piece in self.pieces(name):
                values[row : row + len(piece)] = piece
            values = values.reshape(shape)
            values.setflags(write=False)
            self._values[name] = values
        return self._values[name]

    def pieces(self, name: str) -> Iterator[tuple[int, NDArray[Any]]]:
        """Yield a channel block by block: the number of a first row, and values (rows, nodes)."""
        index = self._index(name)
        kind, width = np.dtype(QUANTITIES[name].stored_type), self.chart.nodes
        try:
            if self.layout is None or self.digests is None:
                with h5py.File(self.path, "r") as file:
                    yield 0, file[name][...].reshape(-1, width).astype(kind, copy=False)
                return
            with Path(self.path).open("rb", buffering=0) as file:
                for number, digests in enumerate(self.digests):
                    place, size = self.layout.span(index, number)
                    file.seek(place)
                    data = file.read(size)
                    own = self.layout.digest(data, index, number)
                    if own != digests[index].tobytes():
                        raise MapFileError(
                            f"{self.path}: channel {name} has values that do not match their "
                            f"digest (got {own.hex()[:12]} in block {number}); the file is "
                            "damaged or was edited: copy it or sweep it again"
                        )
                    values = np.frombuffer(data, kind).reshape(-1, width)
                    yield self.layout.block(number).first, values
        except (OSError, KeyError, RuntimeError) as error:
            if isinstance(error, MapFileError):
                raise
            way_out = "the file is damaged: copy it or sweep it again"
            reject(self.path, f"channel {name} cannot be read", error, way_out, MapFileError)

    def _index(self, name: str) -> int:
        if name in self.channels:
            return self.channels.index(name)
        raise InputError(
            f"{self.path}: the map has no channel {name!r} (it has {', '.join(self.channels)}); "
            "add it to `sweep.gravity.channels` and sweep again"
        )

    def read(
        self, params: ArrayLike, gravity_dir: ArrayLike, channels: Sequence[str] | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Interpolate the map, in float64.

        Values are NaN off the chart; `facet` is that of the nearest node, `status` the worst of the
        cell's nodes.  Beside the tip-over boundary `sdg` and `height` are means over those corners
        that stand; they are NaN where the interpolated `tip_angle` is negative or, in a map without
        it, where less than half of the weight stands.  InputError is raised for what is not as
        here:

        Parameters
        ----------
        params : (m, k) array_like
            Geometry parameters within their axes, rad or length; one row may stand for all.
        gravity_dir : (m, 3) array_like
            Directions pointing down, of any length > 0; one may stand for all.
        channels : sequence of str, optional
            All of the map's by default.
        """
        names = tuple(channels) if channels is not None else self.channels
        ends = [(float(axis.knots[0]), float(axis.knots[-1])) for axis in self.axes]
        points = within_limits(self.recipe, np.atleast_2d(np.asarray(params, np.float64)), ends)
        face, u, v, inside = self.chart.locate(np.atleast_2d(np.asarray(gravity_dir, np.float64)))
        if 1 not in (len(points), len(face)) and len(points) != len(face):
            raise InputError(
                f"params and gravity_dir must have as many rows (got {len(points)} and "
                f"{len(face)}), or one of them a single row"
            )
        count = max(len(points), len(face)) if len(points) and len(face) else 0
        columns = [*points.T, *np.where(inside, (v, u), 0.0)]
        knots = [*(axis.knots for axis in self.axes), *[self.chart.coords] * 2]
        places = [
            locate(some, np.broadcast_to(column, count))
            for some, column in zip(knots, columns, strict=True)
        ]
        face, inside = np.broadcast_to(face, count), np.broadcast_to(inside, count)
        result = {name: self._interpolated(name, places, face, inside) for name in names}
        none = {"sdg", "height", "least_share"} & set(names)
        if "tip_angle" in self.channels and none:
            tips = self._interpolated("tip_angle", places, face, inside) < 0.0
            for name in none:
                result[name] = np.where(tips, np.nan, result[name])
        return result

    def _interpolated(
        self, name: str, places: list[Place], face: NDArray[np.intp], inside: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        values = self.channel(name)
        if QUANTITIES[name].words:
            near = [(i, np.where(np.abs(f - np.rint(f)) < AT, np.rint(f), f)) for i, f in places]
            return np.where(inside, worst(values, near, (face,)), np.nan)
        if name == "facet":
            places = [(i + (frac > 0.5), np.zeros_like(frac)) for i, frac in places]
        found, present = interpolate(values, places, (face,))
        if "tip_angle" not in self.channels:
            found = np.where(present < 0.5, np.nan, found)
        return np.where(inside, found, np.nan)

    def to_xarray(self) -> "xarray.Dataset":
        """Return the whole map as an xarray Dataset, in memory, as xarray reads it from a file."""
        xarray = optional(self.path, "xarray", "xarray", "take arrays from `channel`")
        dims = tuple(self.dims)
        with h5py.File(self.path, "r") as file:
            shown = ("units", "long_name", "flag_values", "flag_meanings")
            facts = {
                name: {key: file[name].attrs[key] for key in shown if key in file[name].attrs}
                for name in (*dims, *self.channels)
            }
            coords = {name: (name, file[name][...], facts[name]) for name in dims}
        variables = {name: (dims, self.channel(name), facts[name]) for name in self.channels}
        of_the_map = {k: v for k, v in self.attributes.items() if k not in OF_THE_FILE}
        return xarray.Dataset(variables, coords, of_the_map)


def verify(stability_map: StabilityMap) -> None:
    """Check the whole file, which needs a seal; MapFileError is raised at the first difference."""
    check_seal(Path(stability_map.path))
    for name in stability_map.channels:
        for _ in stability_map.pieces(name):
            pass


def channel_range(stability_map: StabilityMap, name: str) -> tuple[float | None, float | None]:
    """Return the smallest and largest finite value of a channel, or None."""
    finite = (values[np.isfinite(values)] for _, values in stability_map.pieces(name))
    ends = [(float(some.min()), float(some.max())) for some in finite if some.size]
    return min((low for low, _ in ends), default=None), max((up for _, up in ends), default=None)


def share_that_tips(stability_map: StabilityMap) -> float | None:
    """Return the share of the chart's solid angle in which the robot tips, over all postures.

    None for a map without `tip_angle`, `status`, `sdg` and `height`.
    """
    verdicts = ("tip_angle", "status", "sdg", "height")
    name = next((n for n in verdicts if n in stability_map.channels), None)
    if name is None:
        return None
    worst = len(QUANTITIES[name].words) - 1
    weight = stability_map.chart.solid_angle()
    # How many postures tip in each direction.
    tipping = np.zeros(weight.shape, np.int64)
    for _, values in stability_map.pieces(name):
        if worst >= 0:
            tips = values == worst
        else:
            tips = values < 0.0 if name == "tip_angle" else np.isnan(values)
        tipping += tips.reshape(-1, *weight.shape).sum(axis=0)
    mean = tipping / stability_map.recipe.grid.size
    return float((mean * weight).sum() / weight.sum())
