"""Codec `contacts`: where contacts are, everything else computed when a posture is made.

The room of a pose of many contacts is the most rests, corners, gaps and arcs that it can hold.
Postures are counted, and a margin is added.  A posture that needs more loses gaps or rests, and
without room for an arc of the boundary the pose fails: all of that is safe.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple, Self

import numpy as np

from firmware_export.contacts.many import Many, many_of, order_of
from firmware_export.contacts.many import refusal as many_refusal
from firmware_export.contacts.series import Series, most_off, series_of
from firmware_export.contacts.terms import Terms, terms_of
from firmware_export.contacts.three import Three, three_of
from firmware_export.host import Host
from firmware_export.model import Cells, Model, rounds
from firmware_export.protocol import CArray, CBody, Channels, Codec, Export, describe
from firmware_export.protocol import Tables as AnyTables
from lutgen.errors import InputError
from lutgen.recipe import robot_size_of

MARGIN = 1.1
# The ends of gaps are numbered with 8 bits, and corners come before them.
MOST_PLACES = 100


class Room(NamedTuple):
    """The most of each, in the order of the enum in runtime/smap_region.h."""

    rests: int
    corners: int
    gaps: int
    arcs: int
    facets: int


# The room of the host, and the least that an array of C can have.
LIMITS, LEAST = Room(60, 154, 50, 254, 250), Room(1, 3, 1, 3, 1)


def room_of(model: Model, host: Host) -> Room:
    """Return the room that a pose needs; `host` reads with LIMITS."""
    rng = np.random.default_rng(5)
    any_posture = rng.random((3500, model.k))
    even = rng.integers(0, 5, (1000, model.k)) / 4.0
    equal = np.repeat(rng.random((500, 1)), model.k, axis=1)
    params = model.at(np.concatenate([any_posture, even, equal])).astype(np.float32)
    most = np.maximum(host.room(params), LEAST)
    return Room(*(min(math.ceil(MARGIN * n), most) for n, most in zip(most, LIMITS, strict=True)))


def pose_words(room: Room, contacts: int, discs: int) -> tuple[int, int, int]:
    """Return the words of 32 bits of poses beside an address; NAME.c asserts that they suffice.

    With both forms, with integers alone, and of the region that on-board control keeps beside
    (runtime/smap_pose.h, smap_region.h, smap_reading_i.h).  Addresses have up to 8 bytes.
    """
    vectors = 2 * room.corners + 2 * room.gaps + min(4 * room.gaps, MOST_PLACES)
    layout = 6 + 4 * room.rests + 4 * room.gaps + 5 * room.arcs
    region = 4 * (1 + 7 * room.rests + 3 * vectors)
    floats = 4 * contacts + 3 * max(discs, 1) + 3 * room.rests
    work = 24 + 4 * floats + (contacts if discs else 1) + 7 * room.corners + room.rests + 8
    whole = 6 + 14 * room.rests + 6 * vectors
    both = 4 + layout + 3 + region + 4 + max(work, whole + 2)
    return -(-both // 4), -(-(4 + layout + whole + 4) // 4), -(-(layout + 3 + region + 4) // 4)


# Their numbers in runtime/smap_map.h.
POINTS, RAILS, SEARCH = 1, 5, 6
# Steps of the integer form from the com to the furthest contact.
STEPS = 16000.0
# Corners of a facet that the search keeps.
MOST_SIDES = 12
# Words of a pose: head, floats, integers (runtime/smap_three.h).
POSE = (1 + 20 + 8, 1 + 8)
# For a robot given by code: errors requested, in parts of the size, on three points and on more: of
# three the walls of one facet turn a little, of more other facets are found.  And how many times
# that contacts may be off, in single precision and with the margin of what was seen.
ERRORS = {True: (3e-3, 3e-4, 3e-5, 3e-6), False: (1e-5, 3e-6, 1e-6)}
MOST_OFF = 4.0
# The words for a guard that a certificate made larger.
NEEDED = "; as much as points needed where contacts all but lie on one plane"


@dataclass(frozen=True)
class Spec:
    """The only size there is; of a robot given by code its error, in parts of the robot's size."""

    error: float = 0.0

    @property
    def label(self) -> str:
        """Short text for tables."""
        return f"contacts {self.error:g}" if self.error else "contacts"


@dataclass(frozen=True, eq=False)
class Tables(AnyTables):
    """Stored numbers: positions, and the extras of three points or of many contacts.

    `reach` is how far (length) a contact can be from the com, `room` what a pose of
    many contacts needs.
    """

    spec: Spec
    terms: Terms | Series
    three: Three | None
    many: Many | None
    room: Room
    reach: float
    guard: float
    guard_text: str

    def body(self, integer: bool = False) -> CBody:
        """Return the tables for the emitter."""
        terms, three, many, step = self.terms, self.three, self.many, self.reach / STEPS
        macros = [("SMAP_MAX_ENTRIES", terms.entries), ("SMAP_MAX_COORDINATES", terms.width)]
        macros += [("SMAP_SERIES", 1)] * isinstance(terms, Series)
        if three is not None:
            thresholds = (three.lowest, three.steepest, three.rest_width)
            arrays = self._arrays(three.code, thresholds, ())
            return CBody(POINTS, arrays, 3, tuple(macros), POSE, step)
        assert many is not None
        contacts, tracks = len(many.order), len(many.first) - 1
        both, whole, swept = pose_words(self.room, contacts, terms.axes)
        macros += [
            ("SMAP_MAX_CONTACTS", contacts),
            ("SMAP_RAILS", tracks) if tracks else ("SMAP_DISCS", terms.axes),
            ("SMAP_PIVOTS", many.first[0]),
            *((f"SMAP_MAX_{name.upper()}", most) for name, most in self.room._asdict().items()),
            ("SMAP_MAX_SIDES", min(contacts, MOST_SIDES)),
        ]
        codec = RAILS if tracks else SEARCH
        arrays = self._arrays(0, (0.0, 0.0, 0.0), many.arrays(self.room))
        return CBody(codec, arrays, contacts, tuple(macros), (both, whole), step, swept=swept)

    def _arrays(
        self, order: int, limits: Sequence[float], many: Sequence[CArray]
    ) -> tuple[CArray, ...]:
        """Return the codec's part of a blob; `many` is what the codec for many contacts adds."""
        sizes, terms, flags = self.terms.head()
        more = sum(array.bytes for array in many)
        return (
            CArray("sizes", "uint8_t", sizes, "angles, travels, products, axes", False),
            CArray("terms", "uint16_t", [terms], "terms", False),
            CArray("flags", "uint8_t", [flags, order], "flags, order of the contacts", False),
            CArray("limits", "float", limits, "lowest, steepest, least width of a facet", False),
            CArray("more", "uint16_t", [more], "bytes of what is for many contacts", False),
            *many,
            *self.terms.arrays(),
        )

    def guarded(self, guard: float) -> Self | None:
        """Return tables of many contacts with a larger guard (rad); None for three points.

        The guard of three points follows from a bound: with another nothing would be proved.
        """
        if self.many is None:
            return None
        text = f"{self.many.text.removesuffix(NEEDED)}{NEEDED}"
        many = self.many._replace(guard=math.sin(guard), text=text)
        return replace(self, many=many, guard=guard, guard_text=text)

    def cells(self, model: Model) -> Cells:
        """Return where the ends of the axes are, and where series are cut."""
        cuts = [one[1:-1] for one in self.terms.knots] or [np.zeros(0)] * model.k
        axes = zip(cuts, model.lower, model.upper - model.lower, strict=True)
        ends = [np.concatenate([[0.0], (one - low) / width, [1.0]]) for one, low, width in axes]
        return tuple(np.unique(np.clip(one, 0.0, 1.0)) for one in ends)


@lru_cache(maxsize=4)
def _tables(model: Model, spec: Spec) -> Tables:
    three = many = None
    random = np.random.default_rng(3).random((2000, model.k))
    corners = np.random.default_rng(4).integers(0, 2, (500, model.k)).astype(np.float64)
    seen = model.postures(model.at(np.concatenate([random, corners]))).centres
    reach = float(np.sqrt((seen**2).sum(axis=2)).max()) + float(model.radius.max(initial=0.0))
    order, turning = _order(model)
    terms: Terms | Series
    if spec.error:
        terms = series_of(model, order, spec.error * robot_size_of(model.recipe))
        off, error = off_of(model, spec, terms), 0.0
    else:
        terms, off = terms_of(model.recipe, model.radius, order, turning), 0.0
        error = terms.error
    if model.is_tripod:
        three = three_of(model, error, off)
        guard, text = three.guard, three.text
    else:
        many = many_of(model, off)
        guard, text = math.asin(min(many.guard, 1.0)), many.text
    tables = Tables(spec, terms, three, many, LIMITS, 1.02 * reach, guard, text)
    if many is None:
        return tables
    return replace(tables, room=room_of(model, _host(model, tables)))


def _host(model: Model, tables: Tables) -> Host:
    """Return tables that are queried before they are an export."""
    channels = ("tip_angle",)
    return Host(describe(Export("", model.recipe, model, "contacts", "float", channels, tables)))


def drawn_tables(model: Model) -> Tables:
    """Return tables by which the runtime for many contacts makes any pose, of three points too."""
    order, turning = order_of(model)
    terms = terms_of(model.recipe, model.radius, order, turning)
    return Tables(Spec(), terms, None, many_of(model), LIMITS, 1.0, 0.0, "")


def _order(model: Model) -> tuple[tuple[int, ...], bool]:
    """Return the order of the contacts in the tables, and True if axes of discs are needed."""
    return (rounds(model), False) if model.is_tripod else order_of(model)


def off_of(model: Model, spec: Spec, terms: Series) -> float:
    """Return how far (length) series are off in C, at most; refuse more than was requested."""
    error = spec.error * robot_size_of(model.recipe)
    order, _ = _order(model)
    many = Many(order, (0,), (0.0, 1.0), (), (), 0.0, "")
    blank = Tables(spec, terms, None, many, LIMITS, 1.0, 0.0, "")
    off = most_off(model, _host(model, blank), order, terms.knots)
    if off > MOST_OFF * error:
        raise InputError(
            f"its positions cannot be held to {error:.3g} by polynomials (got {off:.3g}: they jump "
            "or have kinks along no axis); use --codec grid"
        )
    return off


class Contacts(Codec):
    """The codec; it has one size, and of a robot given by code one for each error."""

    name = "contacts"

    def refusal(self, model: Model, arithmetic: str) -> str | None:
        """Return why the codec cannot be used, or None."""
        if arithmetic != "float":
            return (
                "codec contacts needs floating point (square roots and divisions); use --codec grid"
            )
        problem = None if model.is_tripod else many_refusal(model)
        try:
            if problem is None:
                _tables(model, self.sizes(model)[0])
        except InputError as error:
            return str(error)
        return problem

    def sizes(self, model: Model, channels: Channels = (), most: int | None = None) -> list[Spec]:
        """Return the sizes there are."""
        if model.recipe.python is None:
            return [Spec()]
        return [Spec(error) for error in ERRORS[model.is_tripod]]

    def encode(self, model: Model, channels: Channels, spec: Spec) -> Tables:
        """Return the tables: every channel is computed from the same."""
        return _tables(model, spec)


INFO = Contacts()
