"""Proofs that an export on three contact points is never falsely safe.

In reading order: `intervals`, `motion`, `blob`, `rounding`, `stored`, `cells`, `search`,
`statement`.
"""

from firmware_export.prove.rounding import ARCSINE, FURTHEST, NEAREST, SINE, SINE_NEAR
from firmware_export.prove.statement import Statement, record, state, stored_guard

__all__ = [
    "ARCSINE",
    "FURTHEST",
    "NEAREST",
    "SINE",
    "SINE_NEAR",
    "Statement",
    "record",
    "state",
    "stored_guard",
]
