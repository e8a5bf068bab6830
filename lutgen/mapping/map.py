"""The map file opened: what it holds, its values, and the checks on reading.

What is not a map, or not whole, is refused here in a sentence; how a map is laid out is said in
`template`.
"""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.chart import Chart
from lutgen.errors import InputError, LutgenError, MapFileError
from lutgen.grid import Axis
from lutgen.mapping.admission import require_inside, require_stored
from lutgen.mapping.blocks import Plan, plan
from lutgen.mapping.interpolate import Place, interpolate, worst
from lutgen.mapping.labelled import labelled
from lutgen.mapping.probe import require_readable
from lutgen.mapping.seal import Seal, check_head
from lutgen.mapping.template import COMPLETE, DEFINITION, FORMAT
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe, parse_recipe, recipe_digest

if TYPE_CHECKING:
    import xarray

# Parts of a cell by which a place may be beside a node and be at it, where nothing is interpolated:
# a direction comes back from its unit vector to 2e-16, and from degrees to a few times that.
AT = 1e-9


@dataclass(frozen=True)
class StabilityMap:
    """A stability map on disk; values are read when they are asked for.

    `path` is the file, `recipe` the recipe it was made from, `attributes` the root attributes,
    `seal` its digest (None for a file that has none).
    """

    path: str
    recipe: Recipe
    attributes: dict[str, Any]
    seal: Seal | None = None
    _values: dict[str, NDArray[Any]] = field(default_factory=dict, repr=False)

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

    def channel(self, name: str) -> NDArray[Any]:
        """Return all values of a channel, axes (parameters..., face, v, u).

        They are float32, and uint8 of `status`: 0 stands, 1 rocks, 2 tips.
        """
        if name not in self.channels:
            raise InputError(
                f"{self.path}: the map has no channel {name!r} (it has "
                f"{', '.join(self.channels)}); add it to `sweep.gravity.channels` and sweep again"
            )
        if name not in self._values:
            try:
                with h5py.File(self.path, "r") as file:
                    values = file[name][...]
            except Exception as error:
                raise damaged(self.path, f"channel {name} cannot be read", error) from error
            values.setflags(write=False)
            self._values[name] = values
        return self._values[name]

    def to_xarray(self) -> "xarray.Dataset":
        """Return the whole map as an xarray Dataset, in memory, as xarray reads it from the file.

        Returns
        -------
        xarray.Dataset
            A variable for each channel with the dimensions (parameters..., face, v, u), their
            knots as coordinates, `units` and `long_name` as attributes.

        Raises
        ------
        InputError
            Where xarray is not installed.
        MapFileError
            If a channel cannot be read.
        """
        return labelled(self.path, self.recipe, self.attributes, self.channel)

    def pieces(self, name: str) -> Iterator[tuple[int, NDArray[Any]]]:
        """Yield all values of a channel block by block, for maps that are larger than the memory.

        Yields
        ------
        row : int
            Number of the first row, counted through the map: posture * (faces * nodes) + face *
            nodes + v.
        values : (rows, nodes) float32, or uint8 of `status`
            The rows of the block, along u.
        """
        try:
            with h5py.File(self.path, "r") as file:
                variable = file[name]
                layout = Plan(variable.shape, variable.chunks)
                for block in layout.blocks():
                    ends = zip(block.offset, layout.chunk, strict=True)
                    values = variable[tuple(slice(start, start + size) for start, size in ends)]
                    yield block.first_row, values.reshape(-1, variable.shape[-1])
        except (OSError, KeyError, RuntimeError) as error:
            raise damaged(self.path, f"channel {name} cannot be read", error) from error

    def read(
        self, params: ArrayLike, gravity_dir: ArrayLike, channels: Sequence[str] | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Interpolate the map, in float64.

        Parameters
        ----------
        params : (m, k) array_like
            Geometry parameters, rad or length; clamped to the axes.
        gravity_dir : (m, 3) array_like
            One direction per row, pointing down, any length > 0.
        channels : sequence of str, optional
            All of the map's by default; `facet` is taken from the nearest node, and `status` is
            the worst of the cell's nodes.

        Returns
        -------
        dict of str to (m,) float64
            NaN off the chart.  Beside the tip-over boundary `sdg` and `height` are means over
            those corners that stand; they are NaN where the interpolated `tip_angle` is negative
            or, in a map without it, where less than half of the weight stands.
        """
        names = tuple(channels) if channels is not None else self.channels
        points = np.atleast_2d(np.asarray(params, np.float64))
        if points.ndim != 2 or points.shape[1] != len(self.axes):
            raise InputError(
                f"params must have the shape (m, {len(self.axes)}) (got {np.shape(params)}); give "
                f"one column for each of {', '.join(axis.name for axis in self.axes)}"
            )
        face, u, v, inside = self.chart.locate(gravity_dir)
        if len(points) != len(face):
            raise InputError(
                f"params and gravity_dir must have as many rows (got {len(points)} and "
                f"{len(face)}); repeat the single one"
            )
        places: list[Place] = []
        for column, axis in enumerate(self.axes):
            index, frac, _ = axis.locate(points[:, column])
            places.append((index, frac))
        coords = Axis("u", "1", self.chart.coords)
        for value in (v, u):
            index, frac, _ = coords.locate(np.where(inside, value, 0.0))
            places.append((index, frac))
        result = {name: self._interpolated(name, places, face, inside) for name in names}
        if "tip_angle" in self.channels:
            tips = self._interpolated("tip_angle", places, face, inside) < 0.0
            for name in ("sdg", "height"):
                if name in result:
                    result[name] = np.where(tips, np.nan, result[name])
        return result

    def _interpolated(
        self, name: str, places: list[Place], face: NDArray[np.intp], inside: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        if QUANTITIES[name].words:
            near = [(i, np.where(np.abs(f - np.rint(f)) < AT, np.rint(f), f)) for i, f in places]
            found = worst(self.channel(name), near, (face,))
            return np.where(inside, found, np.nan)
        if name == "facet":
            places = [(i + (frac > 0.5), np.zeros_like(frac)) for i, frac in places]
        values, present = interpolate(self.channel(name), places, (face,))
        if "tip_angle" not in self.channels:
            values = np.where(present < 0.5, np.nan, values)
        return np.where(inside, values, np.nan)


def damaged(path: str, what: str, error: Exception) -> MapFileError:
    """Return the error of a file that is damaged."""
    return MapFileError(f"{path}: {what} (got {error}); the file is damaged: sweep it again")


def load_map(path: str | os.PathLike[str], unsealed: bool = False) -> StabilityMap:
    """Open a map file.

    Parameters
    ----------
    path : path
        The file.
    unsealed : bool
        Whether a file without a digest is read, too: a map that was edited by other programs and
        whose `digest` was removed.  Nobody can tell then what its values are.

    Raises
    ------
    MapFileError
        If there is no such file, or it is not a lutgen map, damaged, incomplete, of another
        format, not sealed, keeps values outside of the file, or was computed by another definition
        of what stands.
    """
    name = os.fspath(path)
    try:
        seal = check_head(Path(name))
        require_readable(Path(name), seal)
        with h5py.File(name, "r") as file:
            attributes = dict(file.attrs)
            # Names and texts must be texts, to be compared and printed.
            "".join(map(str, [*file, *attributes.values()])).encode()
            shapes = require_inside(name, file)
    except FileNotFoundError:
        raise MapFileError(f"{name}: there is no such file; check the path") from None
    except PermissionError as error:
        raise MapFileError(
            f"{name}: cannot be read (got {error.strerror}); check the permissions"
        ) from error
    except MapFileError:
        raise
    except Exception as error:
        # Of damaged metadata without a digest h5py may raise nearly anything.
        if Path(name).is_dir():
            raise MapFileError(f"{name}: is a folder; name a map file") from None
        raise MapFileError(
            f"{name}: cannot be read as HDF5 (got {error}); is it a map written by `lutgen sweep`?"
        ) from error
    if "lutgen_format" not in attributes:
        raise MapFileError(
            f"{name}: is HDF5 but no lutgen map (got no attribute `lutgen_format`); "
            "make one with `lutgen sweep`"
        )
    found = attributes["lutgen_format"]
    if not np.array_equal(found, FORMAT):
        raise MapFileError(
            f"{name}: has the map format {found}, this lutgen reads {FORMAT}; "
            "install the lutgen that wrote it, or sweep again"
        )
    found = attributes.get("lutgen_definition", "none")
    if not np.array_equal(found, DEFINITION):
        raise MapFileError(
            f"{name}: was computed by another definition of what stands (got lutgen_definition = "
            f"{found}, this lutgen has {DEFINITION}); sweep it again"
        )
    if not np.array_equal(attributes.get(COMPLETE, 0), 1):
        raise MapFileError(
            f"{name}: is not complete (got {COMPLETE} = {attributes.get(COMPLETE)}); "
            "finish it with `lutgen sweep --resume`"
        )
    if seal is None and not unsealed:
        raise MapFileError(
            f"{name}: is not sealed (got no digest that can be read), so nobody can tell what its "
            "values are; sweep it again, or say that you want it all the same: "
            "`load_map(path, unsealed=True)`, `lutgen info --unsealed`"
        )
    missing = sorted({"title", "lutgen_version"} - set(attributes))
    if missing:
        raise damaged(name, f"lacks the attribute `{missing[0]}`", KeyError(missing[0]))
    try:
        text = str(attributes["recipe"])
        urdf = str(attributes["urdf"]) if "urdf" in attributes else None
        if recipe_digest(text, urdf) != str(attributes["recipe_sha256"]):
            raise MapFileError(
                f"{name}: its recipe does not match its digest; the file is damaged: sweep it again"
            )
        recipe = parse_recipe(text, f"{name} (recipe inside)", inert=True, urdf=urdf)
        expected = plan(recipe).shape
    except (KeyError, LutgenError) as error:
        if isinstance(error, MapFileError):
            raise
        raise damaged(name, "its recipe is missing or wrong", error) from error
    for channel in recipe.channels:
        if shapes.get(channel) != expected:
            raise MapFileError(
                f"{name}: channel {channel} has the shape {shapes.get(channel)}, its recipe says "
                f"{expected}; the file is damaged: sweep it again"
            )
    try:
        with h5py.File(name, "r") as file:
            for channel in recipe.channels:
                require_stored(name, file, channel)
    except (OSError, KeyError, RuntimeError) as error:
        if isinstance(error, MapFileError):
            raise
        raise damaged(name, "cannot be read", error) from error
    return StabilityMap(name, recipe, attributes, seal)
