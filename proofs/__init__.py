"""Proofs of the C runtime: ``python -m proofs.run``.  See docs/explanation/c-runtime.md."""
