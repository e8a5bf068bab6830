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


@dataclass(frozen=True)
class Quantity:
    """A channel.

    `unit` is ``"rad"``, ``"1"``, or ``"length"`` for the recipe's length unit.  Its `title` is for
    map files (`long_name`), its `label` for axes of figures; `better` is the end that is good.
    `under_load` is True if it is defined under forces and for a com that is known to a ball only;
    `exported` is its place in the answer of the C runtime, and `in_c` what the C header says of it.
    `words` are what its values mean, the worst last, where they are no numbers: a map then holds
    bytes, and nothing is ever interpolated.
    """

    name: str
    unit: str
    better: str | None
    label: str
    title: str
    under_load: bool = True
    exported: int | None = None
    in_c: str = ""
    words: tuple[str, ...] = ()

    @property
    def symbol(self) -> str:
        """Return the name for legends: the formula of its label, if that has one."""
        return self.label[max(self.label.find("$"), 0) :]

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
            "sdg",
            "length",
            "minimum",
            r"stability factor $|SD_g|$",
            "stability factor |SD_g|",
            exported=0,
            in_c="stability factor |SD_g|, 0 at its most stable",
        ),
        Quantity(
            "height",
            "length",
            "minimum",
            r"height $|OC|$",
            "height |OC| of the com above the support facet's plane",
            exported=2,
            in_c="|OC|, height of the centre of mass over its support",
        ),
        Quantity(
            "tip_angle",
            "rad",
            "maximum",
            "tip-over angle",
            "signed angular distance to tip-over",
            exported=1,
            in_c="angle until the robot tips, guard subtracted",
        ),
        Quantity(
            "margin", "length", "maximum", "static stability margin", "static stability margin"
        ),
        Quantity(
            "energy_margin",
            "length",
            "maximum",
            "energy stability margin",
            "normalised energy stability margin",
            under_load=False,
        ),
        Quantity(
            "least_share",
            "1",
            "maximum",
            "least share of the weight",
            "least share of the weight on a contact or a group of them",
        ),
        Quantity("facet", "1", None, "support facet", "index of the support facet"),
        Quantity(
            "status",
            "1",
            None,
            "status",
            "whether the robot stands, rocks between rests, or tips over",
            words=("stands", "rocks", "tips"),
        ),
    )
}
CHANNELS = tuple(QUANTITIES)
# Channels that can be drawn and searched: one end of them is good.
RANKED = tuple(name for name, one in QUANTITIES.items() if one.better)
# Channels that robots under forces or with an uncertain com do not have.
UNLOADED = tuple(name for name, one in QUANTITIES.items() if not one.under_load)
# In the order of smap_reading_t.
EXPORTABLE = tuple(
    one.name for one in sorted(QUANTITIES.values(), key=lambda one: one.exported or 0) if one.in_c
)


def wanted(names: Iterable[str]) -> tuple[bool, ...]:
    """Return for each of `CHANNELS` if it is among the names; refuse an unknown name."""
    chosen = tuple(names)
    for name in chosen:
        if name not in QUANTITIES:
            raise InputError(f"unknown channel {name!r}; choose from {', '.join(CHANNELS)}")
    return tuple(name in chosen for name in CHANNELS)
