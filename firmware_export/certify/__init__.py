"""How far an export is from the truth, and that it is never falsely safe.

In reading order: `answers`, `jumps`, `attack`, `certificate`.
"""

from firmware_export.certify.answers import (
    Measured,
    Reader,
    Truth,
    device,
    span_of,
    statistics,
    truth,
)
from firmware_export.certify.certificate import (
    POINTS,
    SEED,
    Certificate,
    Effort,
    bounded,
    certify,
    judged_by,
    put_to_test,
)
from firmware_export.certify.jumps import find_jumps

__all__ = [
    "POINTS",
    "SEED",
    "Certificate",
    "Effort",
    "Measured",
    "Reader",
    "Truth",
    "bounded",
    "certify",
    "device",
    "find_jumps",
    "judged_by",
    "put_to_test",
    "span_of",
    "statistics",
    "truth",
]
