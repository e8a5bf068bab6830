"""Codec `contacts`: where contacts are, everything else computed when a posture is made.

The facade that the chooser and the emitter use; the parts are `closed` (the algebra of links) and
`terms` (their tables), `pieces` and `series` (the same of robots given by code), `three` and `many`
(what is asked of robots on three points and of others, and the guard), and `room` (of their pose).
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from firmware_export.contacts.closed import closed_form
from firmware_export.contacts.layout import pose_words, swept_words
from firmware_export.contacts.many import Many, many_of, order_of
from firmware_export.contacts.many import refusal as many_refusal
from firmware_export.contacts.off import most_off
from firmware_export.contacts.room import LIMITS, Room, room_of
from firmware_export.contacts.series import Series, ordered, series_of
from firmware_export.contacts.terms import Terms, terms_of
from firmware_export.contacts.three import Three, three_of
from firmware_export.host import Host
from firmware_export.protocol import CBody, CodecInfo, Export, describe
from firmware_export.protocol import Tables as AnyTables
from firmware_export.truth import Cells, Model, least_edge_of, rounds
from lutgen.errors import InputError
from lutgen.recipe import robot_size_of

# Their numbers in runtime/blob.c.
POINTS, RAILS, SEARCH = 1, 5, 6
# Steps of the integer form from the com to the furthest contact.
STEPS = 16000.0
# Words of a pose: head, floats, integers (runtime/three.c).
POSE = (1 + 20 + 8, 1 + 8)
# Of a robot given by code: errors asked for, in parts of the size, on three points and on more: of
# three the walls of one facet turn a little, of more other facets are found.  And how many times
# that contacts may be off, in single precision and with the margin of what was seen.
ERRORS = {True: (3e-3, 3e-4, 3e-5, 3e-6), False: (1e-5, 3e-6, 1e-6)}
MOST_OFF = 4.0
# What the room of a pose counts, in order: see smap_room_t in runtime/smap_region.h.
CAPACITIES = ("FACETS", "EDGES", "RESTS", "CORNERS", "GAPS", "ARCS")
# What is said of a guard that a certificate made larger.
NEEDED = "; as much as points needed where contacts all but lie on one plane"


@dataclass(frozen=True)
class Spec:
    """The only size there is; of a robot given by code its error, in parts of the robot's size."""

    error: float = 0.0

    @property
    def label(self) -> str:
        """Short text for tables."""
        return f"contacts {self.error:g}" if self.error else "contacts"

    @classmethod
    def of_label(cls, label: str) -> "Spec":
        """Return the size with a label.

        Examples
        --------
        >>> Spec.of_label("contacts 1e-05"), Spec.of_label("contacts")
        (Spec(error=1e-05), Spec(error=0.0))
        """
        return cls(*map(float, label.split()[1:]))


@dataclass(frozen=True, eq=False)
class Tables(AnyTables):
    """What is stored: positions, and what three points or many contacts need beside them.

    `reach` is how far (length) a contact can be from the com, `room` what a pose of
    many contacts needs.
    """

    spec: Spec
    channels: tuple[str, ...]
    terms: Terms | Series
    three: Three | None
    many: Many | None
    room: tuple[int, ...]
    params: int
    reach: float
    guard: float
    guard_text: str

    @property
    def bytes(self) -> int:
        """Bytes of all tables."""
        return c_body(self).bytes


@lru_cache(maxsize=4)
def _tables(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    three = many = None
    random = np.random.default_rng(3).random((2000, model.k))
    corners = np.random.default_rng(4).integers(0, 2, (500, model.k)).astype(np.float64)
    seen = model.postures(model.at(np.concatenate([random, corners]))).centres
    reach = float(np.sqrt((seen**2).sum(axis=2)).max()) + float(model.radius.max(initial=0.0))
    terms, off = _positions(model, spec)
    if model.is_tripod:
        error = terms.error if isinstance(terms, Terms) else 0.0
        three = three_of(model, error, off)
        guard, text = three.guard, three.text
    else:
        many = many_of(model, off)
        guard, text = math.asin(min(many.guard, 1.0)), many.text
    tables = Tables(
        *(spec, channels, terms, three, many, LIMITS, model.k, 1.02 * reach, guard, text)
    )
    if many is None:
        return tables

    def host(room: Room) -> Host:
        one = replace(tables, room=room)
        export = Export("room", model.recipe, model, "contacts", "float", channels, one)
        return Host(describe(export, c_body(one)))

    return replace(tables, room=room_of(model, host))


def drawn_tables(model: Model) -> Tables:
    """Return tables by which the runtime for many contacts makes any pose, of three points too."""
    order, turning = order_of(model)
    terms = terms_of(model.recipe, model.radius, order, turning)
    return Tables(Spec(), (), terms, None, many_of(model), LIMITS, model.k, 1.0, 0.0, "")


def _order(model: Model) -> tuple[tuple[int, ...], bool]:
    """Return the order of the contacts in the tables, and whether axes of discs are asked for."""
    return (rounds(model), False) if model.is_tripod else order_of(model)


def _positions(model: Model, spec: Spec) -> tuple[Terms | Series, float]:
    """Return the tables of positions, and how far (length) series are off, rounding and all."""
    order, turning = _order(model)
    if not spec.error:
        return terms_of(model.recipe, model.radius, order, turning), 0.0
    series = series_of(model, spec.error * robot_size_of(model.recipe))
    return ordered(series, order), off_of(model, spec)


@lru_cache(maxsize=16)
def off_of(model: Model, spec: Spec) -> float:
    """Return how far (length) the contacts of a robot given by code are off in C, at most.

    Raises
    ------
    InputError
        Where there are no such series, or they are further off than asked for.
    """
    error = spec.error * robot_size_of(model.recipe)
    order, _ = _order(model)
    terms = ordered(series_of(model, error), order)
    body = CBody(POINTS if model.is_tripod else SEARCH, terms.arrays(0, (0.0,) * 3, ()), len(order))
    blank = Tables(spec, (), terms, None, None, (), model.k, 1.0, 0.0, "")
    export = Export("off", model.recipe, model, "contacts", "float", (), blank)
    off = most_off(model, describe(export, body), order, terms.knots)
    if off > MOST_OFF * error:
        raise InputError(
            f"its positions cannot be held to {error:.3g} by polynomials (got {off:.3g}: they jump "
            "or have kinks along no axis); use --codec grid"
        )
    return off


def refusal(model: Model, arithmetic: str) -> str | None:
    """Return why the codec cannot be used, or None."""
    if arithmetic != "float":
        return "codec contacts needs floating point (square roots and divisions); use --codec grid"
    try:
        problem = None if model.is_tripod else many_refusal(model)
        if problem is None and model.recipe.python is not None:
            off_of(model, sizes(model)[0])
        elif problem is None:
            closed_form(model.recipe)
            terms_of(model.recipe, model.radius, _order(model)[0])
    except InputError as error:
        return str(error)
    return problem


def sizes(model: Model) -> list[Spec]:
    """Return the smallest size there is."""
    if model.recipe.python is None:
        return [Spec()]
    return [Spec(ERRORS[model.is_tripod][0])]


def grow(model: Model, spec: Spec) -> list[Spec]:
    """Return the next smaller error of a robot given by code, where it can be had."""
    finer = [Spec(error) for error in ERRORS[model.is_tripod] if error < spec.error]
    try:
        return finer[:1] if finer and off_of(model, finer[0]) else []
    except InputError:
        return []


def encode(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Return the tables."""
    return _tables(model, channels, spec)


def c_body(tables: Tables, integer: bool = False) -> CBody:
    """Return the tables for the emitter."""
    terms, three, many = tables.terms, tables.three, tables.many
    macros = [
        ("SMAP_MAX_ENTRIES", terms.entries),
        ("SMAP_MAX_COORDINATES", terms.width),
        *((switch, 1) for switch in terms.switches),
    ]
    if three is not None:
        thresholds = (three.lowest, three.steepest, three.rest_width)
        arrays = terms.arrays(three.code, thresholds, ())
        return CBody(POINTS, arrays, 3, tuple(macros), POSE, tables.reach / STEPS)
    assert many is not None
    contacts = len(many.order)
    rails = len(many.first) - 1
    most = zip(CAPACITIES, tables.room, strict=True)
    macros += [
        ("SMAP_MANY_CONTACTS", contacts),
        ("SMAP_MANY_RAILS", rails),
        ("SMAP_MANY_AXLES", int(terms.axes > 0)),
        ("SMAP_MANY_KNOWN", 1),
        *((f"SMAP_MANY_{name}", number) for name, number in most),
    ]
    arrays = terms.arrays(0, (0.0, 0.0, 0.0), many.arrays(tables.room))
    return CBody(
        *(
            RAILS if rails else SEARCH,
            arrays,
            contacts,
            tuple(macros),
            pose_words(dict(macros)),
            tables.reach / STEPS,
        ),
        swept=swept_words(dict(macros)),
    )


def guarded(tables: Tables, guard: float) -> Tables | None:
    """Return tables of many contacts with a larger guard (rad); None of three points."""
    if tables.many is None:
        return None
    text = f"{tables.many.text.removesuffix(NEEDED)}{NEEDED}"
    many = tables.many.guarded(math.sin(guard), text)
    return replace(tables, many=many, guard=guard, guard_text=text)


def cells(model: Model, tables: Tables) -> Cells:
    """Return where the ends of the axes are, and where series are cut."""
    rim = np.array([-model.chart_limit, model.chart_limit])
    cuts = [one[1:-1] for one in tables.terms.knots] or [np.zeros(0)] * model.k
    span = model.upper - model.lower
    ends = [
        np.concatenate([[0.0], (one - low) / width, [1.0]])
        for one, low, width in zip(cuts, model.lower, span, strict=True)
    ]
    return Cells(tuple(np.unique(np.clip(one, 0.0, 1.0)) for one in ends), rim, rim)


INFO = CodecInfo(
    name="contacts",
    families={"float": "points"},
    look=("#0072B2", "o"),
    refusal=refusal,
    sizes=lambda model, channels, arithmetic: sizes(model),
    grow=grow,
    encode=encode,
    c_body=c_body,
    read_label=Spec.of_label,
    cells=cells,
    guarded=guarded,
    # For three points given by code, `grid` has a smaller runtime; it needs such a bound.
    exact=lambda model: model.recipe.python is None or least_edge_of(model) <= 0.0,
)
