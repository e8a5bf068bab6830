"""A map as an xarray Dataset: its values with the names of their axes beside them.

Owns what is handed to xarray, which is loaded here and nowhere else, and only when it is asked for.
"""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from lutgen.errors import InputError
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe

if TYPE_CHECKING:
    import xarray

# Root attributes that are about the bytes of the file, and not about what it holds.
OF_THE_FILE = ("digest", "complete")


def labelled(
    path: str,
    recipe: Recipe,
    attributes: Mapping[str, Any],
    channel: Callable[[str], NDArray[Any]],
) -> "xarray.Dataset":
    """Return all channels of a map as a Dataset; InputError where xarray is not installed."""
    try:
        import xarray
    except ImportError as error:
        raise InputError(
            f"{path}: a Dataset needs the package xarray (got {error}); install it "
            "with `pip install xarray`, or take arrays from `StabilityMap.channel`"
        ) from None
    chart = recipe.chart
    scales: dict[str, tuple[NDArray[Any], str, str]] = {
        axis.name: (np.asarray(axis.knots), axis.unit, f"geometry parameter {axis.name}")
        for axis in recipe.grid.axes
    }
    scales["face"] = (np.arange(chart.faces, dtype=np.int32), "1", "face of the gravity chart")
    for name in ("v", "u"):
        text = f"gnomonic face coordinate {name} of the gravity direction"
        scales[name] = (np.asarray(chart.coords), "1", text)
    variables = {}
    for name in recipe.channels:
        one = QUANTITIES[name]
        facts: dict[str, Any] = {
            "units": one.stored_unit(recipe.length_unit),
            "long_name": one.title,
        }
        if one.words:
            facts["flag_values"] = np.arange(len(one.words), dtype=np.uint8)
            facts["flag_meanings"] = " ".join(one.words)
        variables[name] = (tuple(scales), channel(name), facts)
    return xarray.Dataset(
        variables,
        {
            name: (name, values, {"units": unit, "long_name": title})
            for name, (values, unit, title) in scales.items()
        },
        {k: v for k, v in attributes.items() if k not in OF_THE_FILE},
    )
