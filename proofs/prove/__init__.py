"""Proofs that exports on three points are never falsely safe: balls, motion, held, cell, search."""
