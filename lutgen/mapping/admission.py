"""What may stand in a map file, looked at before anything of it is read.

HDF5 lets a file point at others: by links, external storage, virtual datasets.  A map that did
would return bytes of whatever its maker named, so everything has to lie in the file itself, stored
as a sweep stores it.
"""

import math
import os

import h5py
import numpy as np

from lutgen.errors import MapFileError
from lutgen.quantities import QUANTITIES

_LAYOUTS = {
    h5py.h5d.COMPACT: "compact",
    h5py.h5d.CONTIGUOUS: "contiguous",
    h5py.h5d.VIRTUAL: "virtual",
}


def require_inside(name: str, file: h5py.File) -> dict[str, tuple[int, ...]]:
    """Return the shape of every dataset at the root of an open file.

    Raises
    ------
    MapFileError
        If anything in the file lies outside of it.
    """
    shapes = {}
    for group in (file, *_groups(name, file)):
        for member in group:
            _require_hard(name, group, member)
            found = group[member]
            if not isinstance(found, h5py.Dataset):
                continue
            made = found.id.get_create_plist()
            if made.get_layout() == h5py.h5d.VIRTUAL:
                raise _outside(name, member, "a virtual dataset")
            if made.get_layout() == h5py.h5d.CONTIGUOUS and made.get_external_count():
                raise _outside(name, member, "external storage")
            if group is file:
                shapes[member] = found.shape
    return shapes


def _groups(name: str, file: h5py.File) -> list[h5py.Group]:
    """Return the groups at the root of a file; a map has no others."""
    found = []
    for member in file:
        _require_hard(name, file, member)
        if isinstance(file[member], h5py.Group):
            found.append(file[member])
    for group in found:
        for member in group:
            _require_hard(name, group, member)
            if isinstance(group[member], h5py.Group):
                raise MapFileError(
                    f"{name}: has groups within groups (got {member!r}), which no map has; sweep "
                    "it again"
                )
    return found


def _require_hard(name: str, group: h5py.Group, member: str) -> None:
    link = group.get(member, getlink=True)
    if not isinstance(link, h5py.HardLink):
        raise _outside(name, member, "a link")


def _outside(name: str, member: str, what: str) -> MapFileError:
    return MapFileError(
        f"{name}: keeps {member!r} somewhere else (got {what}); a map holds all that it says: "
        "sweep it again"
    )


def require_stored(name: str, file: h5py.File, channel: str) -> None:
    """Refuse a channel that is not stored as a sweep stores it, or of which a part is missing.

    Raises
    ------
    MapFileError
        If it has another type, another layout, other filters than Fletcher-32, or claims more
        values than the file has bytes for.
    """
    variable = file[channel]
    made = variable.id.get_create_plist()
    filters = [made.get_filter(k)[0] for k in range(made.get_nfilters())]
    wanted = np.dtype(QUANTITIES[channel].stored_type).newbyteorder("<")
    if variable.dtype != wanted:
        what = f"the type {variable.dtype}, not {wanted}"
    elif made.get_layout() != h5py.h5d.CHUNKED:
        what = f"a {_LAYOUTS.get(made.get_layout(), 'strange')} layout, not chunks"
    elif filters != [h5py.h5z.FILTER_FLETCHER32]:
        what = f"the filters {filters}, not Fletcher-32 alone"
    elif math.prod(variable.shape) * wanted.itemsize > os.stat(name).st_size:  # noqa: PTH116
        what = f"{math.prod(variable.shape)} values, for which the file is too short"
    else:
        return
    raise MapFileError(
        f"{name}: channel {channel} is not stored as a sweep stores it (got {what}); sweep it again"
    )
