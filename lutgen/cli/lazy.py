"""The rooms that commands use, each imported at its first use.

So `lutgen --help`, and the help of a command, wait for none of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

    import firmware_export as exports
    from firmware_export import control as onboard
    from firmware_export import device as devices
    from firmware_export import emit as folders
    from lutgen import analysis
    from lutgen import channels as evaluation
    from lutgen import chart as charts
    from lutgen import mapping as maps
    from lutgen import plot as figures
    from lutgen import propose as proposals
    from lutgen import recipe as robots
    from lutgen import search as searches
    from lutgen.grid import Axis
    from lutgen.vector import Floats
else:

    class Room:
        """A module that is not imported yet."""

        def __init__(self, name: str) -> None:
            self._name = name

        def __getattr__(self, name: str) -> Any:
            return getattr(import_module(self._name), name)

    np, exports = Room("numpy"), Room("firmware_export")
    onboard, devices, folders = (
        Room(f"firmware_export.{name}") for name in ("control", "device", "emit")
    )
    analysis, evaluation, charts, maps = (
        Room(f"lutgen.{name}") for name in ("analysis", "channels", "chart", "mapping")
    )
    figures, proposals, robots, searches = (
        Room(f"lutgen.{name}") for name in ("plot", "propose", "recipe", "search")
    )
    Axis = Floats = Any
