"""Codec `contacts`: the positions of the contacts, from which the runtime finds everything.

In reading order: `modes`, `fit`, `guard`, `planes`, `facets`, `read`, `codec`.
"""

from firmware_export.contacts.codec import INFO

__all__ = ["INFO"]
