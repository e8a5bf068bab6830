"""Codec `contacts`: the positions of the contacts, from which the runtime finds everything.

In reading order: `modes`, `fit`, `guard`, `codec`.
"""

from firmware_export.contacts.codec import INFO

__all__ = ["INFO"]
