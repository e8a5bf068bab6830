"""Codec `contacts`: positions in closed form, everything else computed when a posture is made.

The facade that the chooser and the emitter use; the parts are `closed` (the algebra), `terms` (the tables)
and `three` (robots on three points: what is asked, and the guard).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from firmware_export.contacts.closed import closed_form
from firmware_export.contacts.terms import Terms, terms_of
from firmware_export.contacts.three import Three, three_of
from firmware_export.protocol import CBody, CodecInfo
from firmware_export.protocol import Tables as AnyTables
from firmware_export.truth import Cells, Model
from lutgen.errors import InputError

POINTS = 1
# Steps of the integer form from the com to the furthest contact.
STEPS = 16000.0
# Words of a pose: head, floats, integers (runtime/three.c).
POSE = (1 + 20 + 8, 1 + 8)


@dataclass(frozen=True)
class Spec:
    """The only size there is."""

    @property
    def label(self) -> str:
        """Short text for tables."""
        return "contacts"

    @classmethod
    def of_label(cls, label: str) -> "Spec":
        """Return the size with a label."""
        return cls()


@dataclass(frozen=True, eq=False)
class Tables(AnyTables):
    """What is stored."""

    spec: Spec
    channels: tuple[str, ...]
    terms: Terms
    three: Three
    params: int
    reach: float
    guard: float
    guard_text: str

    @property
    def bytes(self) -> int:
        """Bytes of all tables."""
        return c_body(self).bytes


@lru_cache(maxsize=4)
def _tables(model: Model, channels: tuple[str, ...]) -> Tables:
    terms = terms_of(model.recipe, model.radius, range(3))
    three = three_of(model, terms.error)
    terms = terms_of(model.recipe, model.radius, three.order)
    random = np.random.default_rng(3).random((2000, model.k))
    corners = np.random.default_rng(4).integers(0, 2, (500, model.k)).astype(np.float64)
    seen = model.postures(model.at(np.concatenate([random, corners]))).centres
    reach = 1.02 * float(np.sqrt((seen**2).sum(axis=2)).max())
    return Tables(Spec(), channels, terms, three, model.k, reach, three.guard, three.text)


def refusal(model: Model, arithmetic: str) -> str | None:
    """Return why the codec cannot be used, or None."""
    if arithmetic != "float":
        return "codec contacts needs floating point (square roots and divisions); use --codec grid"
    if not model.is_tripod:
        return "more than three contacts, or round ones, are not read in this way yet"
    try:
        closed_form(model.recipe)
        terms_of(model.recipe, model.radius, range(len(model.kind)))
    except InputError as error:
        return str(error)
    return None


def encode(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Return the tables."""
    return _tables(model, channels)


def c_body(tables: Tables, integer: bool = False) -> CBody:
    """Return the tables for the emitter."""
    terms, three = tables.terms, tables.three
    macros = (
        ("SMAP_POINTS", 1),
        ("SMAP_FLOATS", 1),
        ("SMAP_INTEGERS", 1),
        ("SMAP_MAX_ENTRIES", terms.entries),
        ("SMAP_MAX_COORDINATES", len(terms.coordinates)),
    )
    thresholds = (three.lowest, three.steepest, three.rest_width)
    arrays = terms.arrays(three.code, thresholds, ())
    return CBody(POINTS, arrays, 3, macros, POSE, tables.reach / STEPS)


def cells(model: Model, tables: Tables) -> Cells:
    """Return where the ends of the axes are: there are no knots between them."""
    rim = np.array([-model.chart_limit, model.chart_limit])
    return Cells((np.array([0.0, 1.0]),) * model.k, rim, rim)


INFO = CodecInfo(
    name="contacts",
    switches={"float": "SMAP_POINTS"},
    look=("#0072B2", "o"),
    refusal=refusal,
    sizes=lambda model, channels, arithmetic: [Spec()],
    grow=lambda model, spec: [],
    encode=encode,
    c_body=c_body,
    read_label=Spec.of_label,
    cells=cells,
    exact=True,
)
