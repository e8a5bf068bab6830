"""Codec `grid` where a robot's standing region jumps: a tree that tells whether it stands.

In reading order: `fold`, `outline`, `middles`, `points`, `halves`, `grow`, `planes`, `directory`,
`prune`, `prove`, `tree`, `codec`.
"""

from firmware_export.verdict.codec import INFO

__all__ = ["INFO"]
