"""The codec `contacts`, which stores where the contacts are: in closed form, or as polynomials.

In reading order: `closed`, `terms`, `pieces`, `series`, `off`, `shown`, `three`, `many`,
`room`, `codec`.
"""

from firmware_export.contacts.codec import INFO, drawn_tables
