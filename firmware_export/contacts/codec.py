"""Codec `contacts`: tables of the contacts' positions, everything else computed when it is read.

The facade that the chooser and the emitter use; the parts are `modes` (what depends on what), `fit`
(codes) and `guard` (the bound).
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.contacts.fit import Codes, encode_codes
from firmware_export.contacts.guard import Geometry, contacts_guard
from firmware_export.contacts.modes import DENSE, Separation, separate
from firmware_export.protocol import CArray, CBody, CodecInfo, literal
from firmware_export.protocol import Tables as AnyTables
from firmware_export.truth import Cells, Model
from lutgen.channels import acceptance_of
from lutgen.errors import InputError

MOST_NODES = 255
# The runtime keeps the contacts that touch a plane in the bits of a uint32_t.
MOST_CONTACTS = 32
TOLERANCE = 1e-6
"""Lengths that differ by less than this part of the robot's size are equal to the runtime.

Ten times its rounding.  Contacts on one plane by design have equal codes and stay on one plane.
"""


@dataclass(frozen=True)
class Spec:
    """Nodes per parameter (2 for one that nothing depends on) and bits of the modes' codes."""

    nodes: tuple[int, ...]
    bits: int

    @property
    def label(self) -> str:
        """Short text for tables."""
        return f"contacts i{self.bits} {'+'.join(map(str, self.nodes)) or 'rigid'}"

    @classmethod
    def of_label(cls, label: str) -> "Spec":
        """Return the size with a label.

        Examples
        --------
        >>> Spec.of_label("contacts i8 4+4")
        Spec(nodes=(4, 4), bits=8)
        """
        _, bits, counts = label.split()
        nodes = () if counts == "rigid" else tuple(map(int, counts.split("+")))
        return cls(nodes, int(bits[1:]))


@dataclass(frozen=True, eq=False)
class Tables(AnyTables):
    """What is stored, and the numbers beside it in the descriptor."""

    spec: Spec
    channels: tuple[str, ...]
    codes: Codes
    guard: float
    guard_text: str
    steepest: float
    lowest: float
    rest_width: float
    tolerance: float
    many: bool

    @property
    def bytes(self) -> int:
        """Bytes of all tables."""
        return self.codes.bytes

    @property
    def guard_grows(self) -> bool:
        """Whether the guard leaves narrow facets to the certificate, see `contacts_guard`."""
        return self.many


class _Probe(NamedTuple):
    """What is found out about a model once."""

    separation: Separation
    geometry: Geometry


@lru_cache(maxsize=4)
def _probe(model: Model) -> _Probe:
    separation = separate(model)
    return _Probe(separation, Geometry(model, separation))


def refusal(model: Model, arithmetic: str) -> str | None:
    """Return why the codec cannot be used, or None."""
    if arithmetic != "float":
        return "codec contacts needs floating point (square roots and divisions); use --codec grid"
    if len(model.kind) > MOST_CONTACTS:
        return (
            f"codec contacts holds up to {MOST_CONTACTS} contacts (got {len(model.kind)}); "
            "use --codec grid"
        )
    try:
        _probe(model)
    except InputError as error:
        return str(error)
    return None


def start(model: Model, channels: tuple[str, ...], arithmetic: str) -> list[Spec]:
    """Return the smallest sensible tables, once with codes of 8 bits and once of 16."""
    nodes = tuple(_fewest(modes) for modes in _probe(model).separation.modes)
    return [Spec(nodes, bits) for bits in ((8, 16) if any(n > 2 for n in nodes) else (16,))]


def _fewest(modes: NDArray[np.float64]) -> int:
    """Return the nodes at which the modes are about a twentieth of their range off; 2 at least.

    The best piecewise linear function is off by curvature x spacing^2 / 16.
    """
    if not len(modes):
        return 2
    curvature = float(np.abs(np.diff(modes, 2, axis=1)).max()) * (DENSE - 1) ** 2
    return max(3, min(MOST_NODES, 1 + math.floor(math.sqrt(curvature / 16.0 / 0.05))))


def grow(model: Model, spec: Spec) -> list[Spec]:
    """Return the next larger tables: a quarter more nodes along one parameter, or all of them."""
    larger = tuple(
        nodes if nodes == 2 else min(MOST_NODES, nodes + max(1, nodes // 4)) for nodes in spec.nodes
    )
    found = [
        Spec((*spec.nodes[:p], larger[p], *spec.nodes[p + 1 :]), spec.bits)
        for p in range(len(larger))
        if larger[p] != spec.nodes[p]
    ]
    if len(found) > 1:
        found.append(Spec(larger, spec.bits))
    return found


def encode(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Fit the tables of one specification."""
    probe = _probe(model)
    many = not model.is_tripod
    try:
        codes = encode_codes(
            probe.separation, spec.nodes, spec.bits, model.radius, model.kind, many
        )
    except OverflowError as error:
        raise InputError(
            f"{model.recipe.source}: the contacts need {error} functions of the parameters, the "
            "runtime has room for 64; use --codec grid"
        ) from error
    tolerance = TOLERANCE * probe.geometry.size
    guard = contacts_guard(model, probe.geometry, codes, tolerance)
    accept = acceptance_of(model.recipe, guard.tighter)
    upright, asked = model.recipe.upright < math.pi, model.recipe.rock_angle < math.pi
    return Tables(
        spec=spec,
        channels=channels,
        codes=codes,
        guard=guard.angle,
        guard_text=guard.text,
        steepest=(accept if upright else acceptance_of(model.recipe)).steepest,
        lowest=guard.lowest,
        # Where nobody asks how far the robot rolls, a stage is as good as a rest.
        rest_width=accept.rest_width + guard.wider if asked else 0.0,
        tolerance=tolerance,
        many=many,
    )


def c_body(tables: Tables) -> CBody:
    """Return the tables for the emitter."""
    codes = tables.codes
    wide = codes.modes.dtype == np.int16
    rows = (
        ("shape", "uint8_t", codes.shape, "per parameter: modes, nodes of each"),
        (
            *("modes", "int16_t" if wide else "int8_t", codes.modes),
            "modes: functions of one parameter, node by node",
        ),
        ("products", "uint8_t", codes.products, "pairs of entries"),
        ("entries", "uint8_t", codes.entries, "per term: coordinates to go on (2 bits), entry"),
        ("weights", "int16_t", codes.weights, "per term: its weight"),
        ("radii", "int16_t", codes.radii, "per contact: its radius"),
        ("hinges", "uint8_t", codes.hinges, "per contact: its axis"),
    )
    arrays = tuple(CArray(*row) for row in rows if row[2].size)
    place = {name: "0" for name, *_ in rows} | {one.name: f"@{one.name}" for one in arrays}
    numbers = {
        "length": codes.length,
        "unit": codes.unit,
        "steepest": tables.steepest,
        "lowest": tables.lowest,
        "rest_width": tables.rest_width,
        "tolerance": tables.tolerance,
    }
    fields = (
        ("shape", place["shape"]),
        ("codes8", "0" if wide else place["modes"]),
        ("codes16", place["modes"] if wide else "0"),
        *((name, place[name]) for name in ("products", "entries", "weights", "radii", "hinges")),
        *((name, literal(value, "float")) for name, value in numbers.items()),
        ("contacts", str(len(codes.position_error))),
        ("axes", str(codes.axes)),
        ("product_count", str(len(codes.products))),
        ("terms", str(len(codes.entries))),
    )
    modes = sum(int(row[0]) for row in codes.shape)
    config = (
        ("SMAP_CONTACTS_MANY", int(tables.many)),
        ("SMAP_MODES", 16 if wide else 8),
        ("SMAP_PRODUCTS", int(len(codes.products) > 0)),
        ("SMAP_MAX_CONTACTS", len(codes.position_error)),
        ("SMAP_MAX_HINGES", max(codes.axes, 1)),
        ("SMAP_MAX_ENTRIES", 1 + modes + len(codes.products)),
    )
    return CBody("smap_contacts_t", fields, arrays, config)


def cells(model: Model, tables: Tables) -> Cells:
    """Return the knots of the tables: nodes of the parameters, and the rim of the chart."""
    rim = np.array([-model.chart_limit, model.chart_limit])
    return Cells(tuple(np.linspace(0.0, 1.0, max(n, 2)) for n in tables.spec.nodes), rim, rim)


INFO = CodecInfo(
    name="contacts",
    enum="SMAP_CODEC_CONTACTS",
    switches={"float": "SMAP_CONTACTS"},
    structs=("smap_contacts_t",),
    look=("#0072B2", "o"),
    refusal=refusal,
    sizes=start,
    grow=grow,
    encode=encode,
    c_body=c_body,
    read_label=Spec.of_label,
    options=(
        ("SMAP_MODES=8", "SMAP_MODES=16"),
        ("", "SMAP_PRODUCTS"),
        ("", "SMAP_CONTACTS_MANY"),
    ),
    cells=cells,
    encodings=80,
    # All axes may grow at once, those of other codecs only one by one.
    patience=2,
    gain=0.9,
)
