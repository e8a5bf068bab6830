"""How far an export is from the truth, and that it is never falsely safe.

In reading order: `answers`, `jumps`, `search`, `certifier`, `tested`.
"""

from firmware_export.certify.answers import Measured, Reader, Truth, device, truth
from firmware_export.certify.certifier import (
    POINTS,
    SEED,
    Certificate,
    Effort,
    bounded,
    certify,
    judged_by,
    span_of,
    statistics,
)
from firmware_export.certify.jumps import find_jumps
from firmware_export.certify.tested import put_to_test

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
