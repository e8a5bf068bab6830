"""Proofs that an export on three contact points is never falsely safe.

In reading order: `intervals`, `motion`, `blob`, `rounding`, `stored`, `cells`, `search`,
`statement`.
"""

from firmware_export.prove.statement import Statement, record, state, stored_guard

__all__ = ["Statement", "record", "state", "stored_guard"]
