"""Every node of a map is in exactly one block, and a block is a run of rows."""

import math
from types import SimpleNamespace
from typing import cast

from hypothesis import given
from hypothesis import strategies as st

from lutgen.grid import Grid
from lutgen.mapping.head import BLOCK_NODES, BLOCK_POSTURES, Plan, plan
from lutgen.recipe import Recipe


def planned(shape: tuple[int, ...], block_nodes: int = BLOCK_NODES) -> Plan:
    """Plan a map of any shape (parameters..., face, v, u)."""
    grid = SimpleNamespace(shape=shape[:-3], size=math.prod(shape[:-3]))
    stand_in = SimpleNamespace(grid=cast(Grid, grid), chart=SimpleNamespace(shape=shape[-3:]))
    return plan(cast(Recipe, stand_in), block_nodes)


SHAPES = st.builds(
    lambda parameters, face, side: (*parameters, face, side, side),
    st.lists(st.integers(1, 6), max_size=4),
    st.sampled_from((1, 6)),
    st.integers(1, 9),
)


@given(SHAPES, st.integers(1, 3000))
def test_blocks_cover_every_row_once_in_order_and_keep_to_the_limit(
    shape: tuple[int, ...], block_nodes: int
) -> None:
    layout = planned(shape, block_nodes)
    posture, row = math.prod(shape[-3:-1]), 0
    for number, block in enumerate(map(layout.block, range(layout.count))):
        assert (block.number, block.first) == (number, row)
        row = block.last
        assert 0 < (block.last - block.first) * shape[-1] <= max(block_nodes, shape[-1])
        # Whole postures, or a part of a single one.
        whole = block.first % posture == block.last % posture == 0
        assert whole or block.first // posture == (block.last - 1) // posture
    assert row * shape[-1] == math.prod(shape) == layout.nodes


def test_a_block_fills_at_least_half_of_what_it_may_hold() -> None:
    # Blocks of one row each would keep to the limit too, and be slow.
    for shape in ((50, 50, 1, 33, 33), (1000, 6, 65, 65), (3, 6, 1021, 1021)):
        assert planned(shape).rows * shape[-1] > BLOCK_NODES / 2
    assert planned((300, 300, 1, 1, 1)).rows > BLOCK_POSTURES / 2
    assert planned((4, 3, 1, 7, 7)).count == 1
