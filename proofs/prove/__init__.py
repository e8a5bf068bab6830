"""Proofs that an export on three contact points is never falsely safe, in ball arithmetic (Arb).

In reading order: `balls`, `motion`, `held`, `cell`, `search`.
"""
