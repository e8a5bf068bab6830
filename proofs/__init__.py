"""Proofs of the C runtime: ``python -m proofs.run``.  See docs/c-runtime.md."""
