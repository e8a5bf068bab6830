"""What every codec hands to those who choose, certify and write exports.

In reading order: `array`, `exported`, `blob`, `info`.
"""

from firmware_export.protocol.array import CTYPES, CArray, CBody, literal
from firmware_export.protocol.blob import VERSION, Blob, describe, restored, stored, turns
from firmware_export.protocol.exported import Export
from firmware_export.protocol.info import CodecInfo, Foresight, Tables

__all__ = [
    "CTYPES",
    "VERSION",
    "Blob",
    "CArray",
    "CBody",
    "CodecInfo",
    "Export",
    "Foresight",
    "Tables",
    "describe",
    "literal",
    "restored",
    "stored",
    "turns",
]
