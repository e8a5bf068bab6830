"""Codec `poly`: the three contacts of a robot as Chebyshev polynomials of its parameters.

Facade of poly_series, poly_bound and poly_fit.  For robots that stand on three points:
they have one facet, and its corners are smooth in the parameters.  |SD_g|, height and tip angle
follow from the corners exactly for every direction.  Polynomials of parameters and gravity could
stand for the components of D_g - s themselves, but these are quotients in gravity: for paper_two
that takes sixteen times the bytes (`python -m benchmarks.export_bytes` measures both).
"""

import math

from firmware_export.poly.bound import carries_everywhere
from firmware_export.poly.fit import (
    MOST_PARAMETERS,
    Spec,
    Tables,
    encode,
    exponents,
    grow,
    start,
)
from firmware_export.poly.series import expand
from firmware_export.protocol import CArray, CBody, CodecInfo, literal
from firmware_export.truth import Model
from lutgen.channels import acceptance_of

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
    series = expand(model) if model.k <= MOST_PARAMETERS else None
    if series is None:
        return (
            "poly found no short polynomials for the contacts; the robot has too many parameters "
            "or does not move smoothly with them; choose contacts or grid"
        )
    accept = acceptance_of(model.recipe)
    # Where nobody asks how far the robot rolls, a stage is as good as a rest.
    width = accept.rest_width if math.isfinite(accept.rock_angle) else 0.0
    if not carries_everywhere(series, accept.steepest, width):
        return (
            "poly needs a support facet that is accepted in every posture of the box, and wide "
            "enough; narrow the parameters' limits, widen `upright`, lower `rest_width`, or choose "
            "contacts or grid"
        )
    return None


def c_body(tables: Tables) -> CBody:
    """Return the struct and its tables."""
    rows = [
        " ".join([name, *(f"T{n}" for n in a)])
        for name, degrees in zip(tables.contacts, tables.spec.degrees, strict=True)
        for a in exponents(degrees)
    ]
    arrays = (
        CArray(
            "shape",
            "uint8_t",
            tables.shape,
            "per contact: highest degree in each parameter, number of terms",
            tables.shape.shape[1],
        ),
        CArray(
            "codes",
            "int16_t",
            tables.codes,
            "Chebyshev coefficients of x, y, z, in units of `unit`: contact, T_n in each parameter",
            3,
            rows,
        ),
    )
    fields = (
        ("shape", "@shape"),
        ("codes", "@codes"),
        ("unit", literal(tables.unit, "float")),
        ("params", str(tables.shape.shape[1] - 1)),
    )
    return CBody("smap_poly_t", fields, arrays)


INFO = CodecInfo(
    name="poly",
    enum="SMAP_CODEC_POLY",
    switches={"float": "SMAP_POLY"},
    structs=("smap_poly_t",),
    look=("#009E73", "^"),
    refusal=refusal,
    sizes=start,
    grow=grow,
    encode=encode,
    c_body=c_body,
    read_label=Spec.of_label,
)
