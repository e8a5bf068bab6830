"""How far an export is from the truth, and that it is never falsely safe.

In reading order: `answers`, `jumps`, `certificate`, `search`, `certifier`.
"""

from firmware_export.certify.answers import Measured, Reader, Truth, device, truth
from firmware_export.certify.certificate import Certificate
from firmware_export.certify.certifier import POINTS, SEED, certify, statistics
from firmware_export.certify.jumps import find_jumps

__all__ = [
    "POINTS",
    "SEED",
    "Certificate",
    "Measured",
    "Reader",
    "Truth",
    "certify",
    "device",
    "find_jumps",
    "statistics",
    "truth",
]
