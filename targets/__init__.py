"""The exported C on emulated microcontrollers: built, run, compared, counted (docs/targets.md)."""
