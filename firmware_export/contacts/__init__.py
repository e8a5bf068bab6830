"""Codec `contacts`: positions in closed form; the rest is geometry.

In reading order: `closed`, `terms`, `three`, `many`, `layout`, `codec`.
"""

from firmware_export.contacts.codec import INFO

__all__ = ["INFO"]
