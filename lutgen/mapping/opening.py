"""Open a map file: refuse what is not a map, not whole, or not of this lutgen, in a sentence."""

import os
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from lutgen.errors import LutgenError, MapFileError, reject
from lutgen.mapping.head import COMPLETE, DEFINITION, DIGESTS, FORMAT, ROWS, Layout, check_seal
from lutgen.mapping.stability_map import StabilityMap
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe, parse_recipe, recipe_digest


def load_map(path: str | os.PathLike[str], unsealed: bool = False) -> StabilityMap:
    """Open a map file.

    MapFileError is raised if it is missing, held by another program, no lutgen map, damaged,
    rewritten, incomplete, or of another format or definition of what stands.  One that another
    program has rewritten or edited is read if it may be `unsealed`: its values may be wrong then,
    and a file that was made to do harm may crash HDF5.
    """
    name, sealed = os.fspath(path), True
    try:
        try:
            check_seal(Path(name))
        except MapFileError:
            if not unsealed:
                raise
            sealed = False
        with h5py.File(name, "r") as file:
            # xarray writes a number as a list of one.
            attributes = {
                key: value.item() if np.size(value) == 1 and hasattr(value, "item") else value
                for key, value in file.attrs.items()
            }
            # Names and texts must be texts, to be compared and printed.
            "".join(map(str, [*file, *attributes.values()])).encode()
            _require_ours(name, attributes)
            recipe = _recipe(name, attributes)
            if not sealed:
                for channel in recipe.channels:
                    _require_inside(name, file, channel, recipe)
                return StabilityMap(name, recipe, attributes)
            digests = file[DIGESTS]
            rows, version = int(digests.attrs[ROWS]), str(attributes["lutgen_version"])
            places = tuple(int(file[channel].id.get_offset()) for channel in recipe.channels)
            layout = Layout(recipe, rows, places, version)
            return StabilityMap(name, recipe, attributes, layout, digests[...])
    except LutgenError:
        raise
    except Exception as error:
        # h5py may raise nearly anything on damaged metadata.
        raise MapFileError(f"{name}: {_reason(error, Path(name))}") from error


def _reason(error: Exception, path: Path) -> str:
    got = error.strerror if isinstance(error, OSError) and error.strerror else error
    if isinstance(error, FileNotFoundError):
        return "there is no such file; check the path"
    if path.is_dir():
        return "is a folder; name a map file"
    if isinstance(error, BlockingIOError):
        return f"is open for writing in another program (got {got}); close it there, then read it"
    if isinstance(error, PermissionError):
        return f"cannot be read (got {got}); check the permissions"
    return f"cannot be read as HDF5 (got {got}); it is damaged or no map: sweep it again"


def _require_ours(name: str, attributes: dict[str, Any]) -> None:
    again = "make it again with `lutgen sweep`"
    for key, wanted, what, way_out in (
        ("lutgen_format", FORMAT, "is no lutgen map of this format", again),
        ("lutgen_definition", DEFINITION, "is by another definition of what stands", again),
        (COMPLETE, 1, "is not complete", "finish it with `lutgen sweep --resume`"),
    ):
        found: Any = attributes.get(key)
        if not np.array_equal(found, wanted):
            raise MapFileError(f"{name}: {what} (got {key} = {found}, not {wanted}); {way_out}")
    for key in ("title", "lutgen_version", "recipe", "recipe_sha256"):
        if key not in attributes:
            raise MapFileError(f"{name}: lacks the attribute `{key}` (got none); {again}")


def _recipe(name: str, attributes: dict[str, Any]) -> Recipe:
    text, urdf = str(attributes["recipe"]), attributes.get("urdf")
    own, stored = recipe_digest(text, urdf), str(attributes["recipe_sha256"])
    if own != stored:
        what, got = "its recipe does not match its digest", f"{own[:12]} instead of {stored[:12]!r}"
        reject(name, what, got, "the file was edited: sweep it again", MapFileError)
    try:
        return parse_recipe(text, f"{name} (recipe inside)", inert=True, urdf=urdf)
    except LutgenError as error:
        raise MapFileError(str(error)) from error


def _require_inside(name: str, file: h5py.File, channel: str, recipe: Recipe) -> None:
    """Refuse a channel that another program has written unless it is whole and in this file.

    HDF5 lets a file point at others; a map must not return bytes of a file that its maker named.
    """
    link = file.get(channel, getlink=True)
    found = file[channel] if isinstance(link, h5py.HardLink) else link
    inside = isinstance(found, h5py.Dataset) and not (found.is_virtual or found.external)
    if not (
        inside
        and found.shape == (*recipe.grid.shape, *recipe.chart.shape)
        and np.can_cast(found.dtype, QUANTITIES[channel].stored_type, "same_kind")
        and found.id.get_storage_size()
    ):
        what = "is not in the file as its recipe says"
        reject(f"{name}: channel {channel}", what, found, "sweep it again", MapFileError)
