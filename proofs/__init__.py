"""Proofs of the C runtime: ``python -m proofs.run``.  See docs/measured/c-runtime.md."""
