"""The exported C on emulated microcontrollers: built, run, counted (docs/measured/targets.md)."""
