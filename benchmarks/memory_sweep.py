"""Our sweep into memory: `lutgen.channels.scan.scan`, called as `Scanner` calls it."""

from collections.abc import Sequence

import numba
import numpy as np
from numpy.typing import NDArray

from lutgen.channels.plain import CHANNELS
from lutgen.channels.raster import VECTOR
from lutgen.channels.scan import scan
from lutgen.chart import Chart
from lutgen.mapping.blocks import BLOCK_NODES
from lutgen.mapping.compute import PARTS_PER_THREAD
from lutgen.support.region import limits


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
        v, u = np.meshgrid(chart.coords, chart.coords, indexing="ij")
        coords = np.concatenate([chart.coords, np.full(VECTOR, np.inf)])
        inverse = (1.0 / np.sqrt(1.0 + u * u + v * v)).ravel()
        self._setting = (limits(*limit_angles), chart.basis(), coords, inverse)
        self._wanted = np.array([name in channels for name in CHANNELS])
        size = len(CHANNELS) * len(primitives) * self.directions
        self._out = store[:size].reshape(len(CHANNELS), -1)
        self._per_block = max(BLOCK_NODES // self.directions, 1)
        # One item more than the block, as the sweep has for the checksum.
        self._block = np.full(
            (len(CHANNELS), self._per_block * self.directions + 1), np.nan, np.float32
        )

    def _scan(self, primitives: NDArray[np.float64], out: NDArray[np.float32]) -> None:
        parts = numba.get_num_threads() * PARTS_PER_THREAD
        scan(primitives, *self._setting, 0, self.rows, self._wanted, parts, out)

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
