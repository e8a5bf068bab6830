"""The codec `contacts`, which stores where the contacts are: in closed form, or as polynomials.

In reading order: `closed`, `terms`, `pieces`, `series`, `three`, `many`, `codec`.
"""

from firmware_export.contacts.codec import INFO, drawn_tables
