"""How far an export is from the exact model, and that it is never falsely safe.

In reading order: `answers`, `attack`, `certificate`.
"""
