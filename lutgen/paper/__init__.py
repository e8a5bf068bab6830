"""The published method: its equations as printed, and what is wrong with them."""
