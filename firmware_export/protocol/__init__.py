"""What every codec hands to those who choose, certify and write exports.

In reading order: `axis`, `array`, `exported`, `info`.
"""

from firmware_export.protocol.array import CArray, CBody, literal
from firmware_export.protocol.axis import axis_numbers
from firmware_export.protocol.exported import CHANNELS, Export
from firmware_export.protocol.info import CodecInfo, Foresight, Spec, Tables

__all__ = [
    "CHANNELS",
    "CArray",
    "CBody",
    "CodecInfo",
    "Export",
    "Foresight",
    "Spec",
    "Tables",
    "axis_numbers",
    "literal",
]
