"""The channels of a map: what each is called, in which unit it comes and which end of it is good.

The formula of each is in `lutgen.channels.exact`, and for robots under forces in
`lutgen.channels.loads`.  A new channel is a row of `QUANTITIES` and its formula.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from lutgen.errors import InputError
from lutgen.parts import to_display, to_internal

__all__ = ["CHANNELS", "EXPORTABLE", "QUANTITIES", "RANKED", "UNLOADED", "Quantity", "wanted"]


@dataclass(frozen=True)
class Quantity:
    """A channel.

    Attributes
    ----------
    name : str
        As recipes, maps and commands write it.
    unit : str
        ``"rad"``, ``"1"``, or ``"length"`` for the recipe's length unit.
    title : str
        In the map file (`long_name`).
    label, symbol : str
        In figures: on an axis, and in a legend.
    better : str, optional
        ``"minimum"`` or ``"maximum"``, the end that is good; None for an index.
    under_load : bool
        Whether it is defined under forces and for a com that is known to a ball only.
    exported : int, optional
        Its place in the answer of the C runtime; None where C does not answer it.
    in_c : str
        What the C header says of it.
    words : tuple of str
        What its values 0, 1, 2... mean, the worst last; empty where they are numbers.  Of a
        channel with words a map holds bytes, and nothing is ever interpolated.
    """

    name: str
    unit: str
    title: str
    label: str
    symbol: str
    better: str | None
    under_load: bool = True
    exported: int | None = None
    in_c: str = ""
    words: tuple[str, ...] = ()

    @property
    def stored_type(self) -> str:
        """How a map file holds its values: ``"uint8"`` where they are words, or ``"float32"``."""
        return "uint8" if self.words else "float32"

    def stored_unit(self, length_unit: str) -> str:
        """Return the unit of its values: rad, the recipe's length unit, or 1."""
        return length_unit if self.unit == "length" else self.unit

    def shown_unit(self, length_unit: str) -> str:
        """Return the unit in which people read it: deg for angles."""
        return "deg" if self.unit == "rad" else self.stored_unit(length_unit)

    def shown(self, values: Any) -> Any:
        """Turn a number or an array into the unit in which people read it."""
        return to_display(values, self.shown_unit(""))

    def stored(self, values: Any) -> Any:
        """Turn what people wrote into rad or length; the inverse of `shown`."""
        return to_internal(values, self.shown_unit(""))

    def word(self, value: float) -> str | None:
        """Return the word of a value, None for one that is no number."""
        return self.words[int(value)] if math.isfinite(value) else None

    @property
    def json(self) -> str:
        """Its key in reports, which name deg but no length unit."""
        return f"{self.name}_deg" if self.unit == "rad" else self.name

    @property
    def sign(self) -> float:
        """1 where less is better and -1 where more is: what a search makes small."""
        return -1.0 if self.better == "maximum" else 1.0


# In the order of the rows that the kernels fill.  Their machine code knows how many there are, so
# this file counts as one of theirs: `lutgen.jit` finds its own name in it.
QUANTITIES = {
    one.name: one
    for one in (
        Quantity(
            name="sdg",
            unit="length",
            title="stability factor |SD_g|",
            label=r"stability factor $|SD_g|$",
            symbol=r"$|SD_g|$",
            better="minimum",
            exported=0,
            in_c="stability factor |SD_g|, 0 at its most stable",
        ),
        Quantity(
            name="height",
            unit="length",
            title="height |OC| of the com above the support facet's plane",
            label=r"height $|OC|$",
            symbol=r"$|OC|$",
            better="minimum",
            exported=2,
            in_c="|OC|, height of the centre of mass over its support",
        ),
        Quantity(
            name="tip_angle",
            unit="rad",
            title="signed angular distance to tip-over",
            label="tip-over angle",
            symbol="tip-over angle",
            better="maximum",
            exported=1,
            in_c="angle until the robot tips, guard subtracted",
        ),
        Quantity(
            name="margin",
            unit="length",
            title="static stability margin",
            label="static stability margin",
            symbol="static stability margin",
            better="maximum",
        ),
        Quantity(
            name="energy_margin",
            unit="length",
            title="normalised energy stability margin",
            label="energy stability margin",
            symbol="energy stability margin",
            better="maximum",
            under_load=False,
        ),
        Quantity(
            name="least_share",
            unit="1",
            title="least share of the weight on a contact or a group of them",
            label="least share of the weight",
            symbol="least share",
            better="maximum",
        ),
        Quantity(
            name="facet",
            unit="1",
            title="index of the support facet",
            label="support facet",
            symbol="support facet",
            better=None,
        ),
        Quantity(
            name="status",
            unit="1",
            title="whether the robot stands, rocks between rests, or tips over",
            label="status",
            symbol="status",
            better=None,
            words=("stands", "rocks", "tips"),
        ),
    )
}
CHANNELS = tuple(QUANTITIES)
# What can be drawn and sought: channels of which one end is good.
RANKED = tuple(name for name, one in QUANTITIES.items() if one.better)
# Channels that robots under forces or with an uncertain com do not have.
UNLOADED = tuple(name for name, one in QUANTITIES.items() if not one.under_load)
# In the order of smap_reading_t.
EXPORTABLE = tuple(
    one.name
    for one in sorted(QUANTITIES.values(), key=lambda one: (one.exported is None, one.exported))
    if one.exported is not None
)


def wanted(names: Iterable[str]) -> tuple[bool, ...]:
    """Return for each of `CHANNELS` whether it is among the names; refuse an unknown name.

    Examples
    --------
    >>> wanted(["sdg", "tip_angle"])
    (True, False, True, False, False, False, False, False)
    """
    asked = tuple(names)
    for name in asked:
        if name not in QUANTITIES:
            raise InputError(f"unknown channel {name!r}; choose from {', '.join(CHANNELS)}")
    return tuple(name in asked for name in CHANNELS)
