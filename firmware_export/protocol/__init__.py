"""What every codec hands to those who choose, certify and write exports.

In reading order: `array`, `exported`, `descriptor`, `info`.
"""

from firmware_export.protocol.array import CTYPES, CArray, CBody, literal
from firmware_export.protocol.descriptor import Descriptor, describe, members, restored, stored
from firmware_export.protocol.exported import Export
from firmware_export.protocol.info import CodecInfo, Foresight, Tables

__all__ = [
    "CTYPES",
    "CArray",
    "CBody",
    "CodecInfo",
    "Descriptor",
    "Export",
    "Foresight",
    "Tables",
    "describe",
    "literal",
    "members",
    "restored",
    "stored",
]
