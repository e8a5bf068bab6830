"""How far an export is from the truth, and that it is never falsely safe.

In reading order: `answers`, `jumps`, `attack`, `certificate`.
"""
