"""Codec `poly`: the three contacts of a robot as Chebyshev polynomials of its parameters.

Facade of poly_series, poly_bound and poly_fit.  For robots that stand on three points:
they have one facet, and its corners are smooth in the parameters.  |SD_g|, height and tip angle
follow from the corners exactly for every direction.  Polynomials of parameters and gravity could
stand for the components of D_g - s themselves, but these are quotients in gravity: for paper_two
that takes sixteen times the bytes (`python -m benchmarks.export_bytes` measures both).
"""

from firmware_export.contacts.shorten import (
    MOST_PARAMETERS,
    Spec,
    Tables,
    encode,
    grow,
    start,
)
from firmware_export.protocol import CArray, CBody, CodecInfo
from firmware_export.truth import Model, expand, least_edge_of, widened

# Its number in runtime/blob.c; steps of the integer form from the com to the furthest contact;
# words of a pose (runtime/three.c).
POLY, STEPS, POSE = 2, 16000.0, (1 + 20 + 8, 1 + 8)


__all__ = ["INFO", "Spec", "Tables", "c_body", "encode", "grow", "refusal", "start"]


def refusal(model: Model, arithmetic: str) -> str | None:
    """Return why the codec cannot hold this robot, in one sentence, or None."""
    if model.recipe.com_uncertainty > 0.0:
        return "poly holds no com_uncertainty; choose the codec contacts"
    if arithmetic != "float":
        return "poly computes with floats only; choose the codec grid for integers"
    if not model.is_tripod:
        return (
            f"poly needs a robot on three point contacts (got {len(model.kind)} contacts"
            f"{', some of them round' if model.kind.any() else ''}); choose contacts or grid"
        )
    if model.k > MOST_PARAMETERS or expand(widened(model)) is None:
        return (
            "poly found no short polynomials for the contacts; the robot has too many parameters "
            "or does not move smoothly with them; choose contacts or grid"
        )
    if least_edge_of(model) <= 0.0:
        return (
            "poly needs a support facet that is accepted in every posture of the box, and wide "
            "enough; narrow the parameters' limits, widen `upright`, lower `rest_width`, or choose "
            "contacts or grid"
        )
    return None


def c_body(tables: Tables, integer: bool = False) -> CBody:
    """Return the tables for the emitter."""
    arrays = (
        CArray("unit", "float", [tables.unit], "length of one code", False),
        CArray("order", "uint8_t", [0, 0, 0, tables.order], "order of the contacts", False),
        CArray("places", "float", tables.places, "per parameter: middle, 2 / span", False),
        CArray("shape", "uint8_t", tables.shape, "per contact: degree in each parameter, terms"),
        CArray("codes", "int16_t", tables.codes, "Chebyshev coefficients of x, y, z"),
    )
    macros = (("SMAP_POLY", 1), ("SMAP_FLOATS", 1), ("SMAP_INTEGERS", 1))
    return CBody(POLY, arrays, 3, macros, POSE, tables.reach / STEPS)


INFO = CodecInfo(
    name="poly",
    switches={"float": "SMAP_POLY"},
    look=("#009E73", "^"),
    refusal=refusal,
    sizes=start,
    grow=grow,
    encode=encode,
    c_body=c_body,
    read_label=Spec.of_label,
)
