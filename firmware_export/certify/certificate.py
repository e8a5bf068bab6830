"""The certificate of an export as data: what was measured, and what is refused because of it."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lutgen.errors import ExportError

__all__ = ["Certificate"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Certificate:
    """What was measured on an export.

    Parameters
    ----------
    points : int
        Points compared, those of the two searches not counted; `standing` of them stand.
    channels : dict
        Per channel ``max`` (absent where |SD_g| jumps: then ``largest_seen``), ``p99``, ``rms`` in
        the channel's unit over all points, ``p99_uniform`` and ``rms_uniform`` over the uniform
        half; also ``range`` and the same in percent of it, ``..._percent``.
    false_safe : int
        Points of the sample and of the search that are called safe and tip.
    false_tip : float
        Share of the standing points of the uniform half that are called tipping.
    jumps : bool
        Whether |SD_g| jumps, so that its error has no bound; see `find_jumps`.
    beyond : float, optional
        Share of the standing uniform points whose |SD_g| error is beyond the bound asked for.
    nearest : float
        rad by which the search failed to find a false safe: the least by which the answer to a
        point that tips was below 0.
    searched : int
        Points that the searches tried.
    witness : tuple, optional
        Parameters, gravity, answered and true tip angle of a false safe.
    """

    points: int
    standing: int
    channels: dict[str, dict[str, float]]
    false_safe: int
    false_tip: float
    jumps: bool
    beyond: float | None
    nearest: float
    searched: int
    seed: int
    text: tuple[str, ...] = ()
    witness: tuple[Floats, Floats, float, float] | None = field(default=None, compare=False)

    def as_dict(self) -> dict[str, Any]:
        """Return what the header and the report print; plain numbers and texts."""
        return {
            "points": self.points,
            "standing": self.standing,
            "channels": self.channels,
            "false_safe": self.false_safe,
            "false_tip": self.false_tip,
            "jumps": self.jumps,
            "beyond": self.beyond,
            "nearest_false_safe_rad": self.nearest,
            "searched": self.searched,
            "seed": self.seed,
            "text": list(self.text),
        }

    @property
    def bounded(self) -> tuple[str, ...]:
        """The channels that a bound is for: lengths, or the tip angle where there is no other."""
        return tuple(name for name in self.channels if name != "tip_angle") or ("tip_angle",)

    def error_of(self, channel: str, relative: bool) -> float:
        """Return the largest error of a channel, or p99 where |SD_g| jumps.

        In percent of its range, or in its unit.
        """
        name = "p99" if self.jumps and channel != "tip_angle" else "max"
        return self.channels[channel][f"{name}_percent" if relative else name]

    def error(self, relative: bool) -> float:
        """Return what is compared with a bound."""
        return max(self.error_of(channel, relative) for channel in self.bounded)

    def refuse_false_safe(self, label: str) -> None:
        """Raise ExportError if a point is called safe where the robot tips."""
        if not self.false_safe:
            return
        where = ""
        if self.witness is not None:
            params, gravity, said, true = self.witness
            where = (
                f", for one at parameters {np.round(params, 7).tolist()} and gravity "
                f"{np.round(gravity, 7).tolist()}: {said:.3g} rad for {true:.3g}"
            )
        raise ExportError(
            f"{label}: the certificate found the robot called safe where it tips (got "
            f"{self.false_safe} points{where}); nothing was written: this is a fault of the "
            "codec's guard, choose another with --codec and report it."
        )
