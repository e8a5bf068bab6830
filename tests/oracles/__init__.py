"""Slow, plain second implementations that the tests hold lutgen to.

Written from the definitions in `docs/reference/conventions.md` with NumPy alone.  Nothing
in this package imports lutgen, and nothing in lutgen imports this package.
"""
