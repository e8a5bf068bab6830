"""Codecs that store where the contacts are: in closed form, or as polynomials.

In reading order: `closed`, `terms`, `lines`, `pieces`, `series`, `off`, `shown`, `three`, `many`,
`room`, `layout`, `codec`, `shorten`, `poly`.
"""

from firmware_export.contacts.codec import INFO, c_body, drawn_tables
from firmware_export.contacts.poly import INFO as POLY

__all__ = ["INFO", "POLY", "c_body", "drawn_tables"]
