"""How far an export is from the truth, and that it is never falsely safe.

In reading order: `answers`, `jumps`, `search`, `certifier`.
"""

from firmware_export.certify.answers import Measured, Reader, Truth, device, truth
from firmware_export.certify.certifier import POINTS, SEED, Certificate, Effort, certify, statistics
from firmware_export.certify.jumps import find_jumps

__all__ = [
    "POINTS",
    "SEED",
    "Certificate",
    "Effort",
    "Measured",
    "Reader",
    "Truth",
    "certify",
    "device",
    "find_jumps",
    "statistics",
    "truth",
]
