"""Our sweep into memory: `lutgen.channels.scan.scan`, called as `Scanner` calls it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lutgen.channels.plain import CHANNELS, Setting, wanted_channels
from lutgen.channels.scan import nodes_of, scan
from lutgen.chart import Chart
from lutgen.mapping.blocks import BLOCK_NODES
from lutgen.support.region import acceptance


class MemorySweep:
    """One sweep over postures (m, n, 8), repeatable, without forward kinematics and files.

    `store` float32 holds at least 6 * m * directions items, of which `large` makes one contiguous
    output; `reused` computes block after block into one buffer of a block's size, as a sweep into
    a file does.
    """

    def __init__(
        self,
        primitives: NDArray[np.float64],
        chart: Chart,
        channels: Sequence[str],
        store: NDArray[np.float32],
        limit_angles: tuple[float | None, float | None] = (None, None),
    ) -> None:
        self.primitives = primitives
        self.rows = chart.faces * chart.nodes
        self.directions = self.rows * chart.nodes
        self._nodes = nodes_of(chart)
        self._setting = Setting(acceptance(*limit_angles), wanted_channels(channels))
        size = len(CHANNELS) * len(primitives) * self.directions
        self._out = store[:size].reshape(len(CHANNELS), -1)
        self._per_block = max(BLOCK_NODES // self.directions, 1)
        # One item more than the block, as the sweep has for the checksum.
        self._block = np.full(
            (len(CHANNELS), self._per_block * self.directions + 1), np.nan, np.float32
        )

    def _scan(self, primitives: NDArray[np.float64], out: NDArray[np.float32]) -> None:
        scan(primitives, self._setting, self._nodes, (0, self.rows), out)

    def large(self) -> None:
        """Compute everything in one call into the large output."""
        self._scan(self.primitives, self._out)

    def reused(self) -> None:
        """Compute block after block into one buffer."""
        for begin in range(0, len(self.primitives), self._per_block):
            self._scan(self.primitives[begin : begin + self._per_block], self._block)

    def values(self, channel: str, postures: int) -> NDArray[np.float32]:
        """Return a channel of the first postures, (postures, directions), computed anew."""
        self.large()
        row = self._out[CHANNELS.index(channel), : postures * self.directions]
        return row.reshape(postures, self.directions).copy()
