"""Every node of a map is in exactly one block, and a block is a run of rows."""

import math
from types import SimpleNamespace
from typing import cast

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lutgen.mapping.blocks import BLOCK_NODES, Plan, plan
from lutgen.recipe.recipe import Recipe


def planned(shape: tuple[int, ...], block_nodes: int = BLOCK_NODES) -> Plan:
    """Plan a map of any shape (parameters..., face, v, u)."""
    stand_in = SimpleNamespace(
        grid=SimpleNamespace(shape=shape[:-3]), chart=SimpleNamespace(shape=shape[-3:])
    )
    return plan(cast(Recipe, stand_in), block_nodes)


SHAPES = st.builds(
    lambda parameters, face, side: (*parameters, face, side, side),
    st.lists(st.integers(1, 6), max_size=4),
    st.sampled_from((1, 6)),
    st.integers(1, 9),
)


@given(SHAPES, st.integers(1, 3000))
def test_blocks_cover_every_node_exactly_once_and_in_order(
    shape: tuple[int, ...], block_nodes: int
) -> None:
    layout = planned(shape, block_nodes)
    row = 0
    for number, block in enumerate(layout.blocks()):
        assert block.number == number
        assert block.first_row == row < block.last_row
        row = block.last_row
    assert row * shape[-1] == math.prod(shape) == layout.nodes
    assert number + 1 == layout.count


@given(SHAPES, st.integers(1, 3000))
def test_a_blocks_rows_are_the_nodes_of_its_chunk(shape: tuple[int, ...], block_nodes: int) -> None:
    layout = planned(shape, block_nodes)
    numbers = np.arange(layout.nodes).reshape(shape)
    for block in layout.blocks():
        chunk = numbers[
            tuple(slice(o, o + c) for o, c in zip(block.offset, layout.chunk, strict=True))
        ]
        rows = np.arange(block.first_row * shape[-1], block.last_row * shape[-1])
        np.testing.assert_array_equal(chunk.ravel(), rows)


@given(SHAPES, st.integers(1, 3000))
def test_a_chunk_keeps_to_the_limit_and_never_cuts_a_row(
    shape: tuple[int, ...], block_nodes: int
) -> None:
    layout = planned(shape, block_nodes)
    assert layout.chunk[-1] == shape[-1]
    assert layout.chunk_nodes <= max(block_nodes, shape[-1])


def test_a_chunk_fills_at_least_half_of_what_it_may_hold() -> None:
    # A chunk of one row each would keep to the limit too, and be slow.
    assert planned((50, 50, 1, 33, 33)).chunk_nodes > BLOCK_NODES / 2
    assert planned((1000, 6, 65, 65)).chunk_nodes > BLOCK_NODES / 2


def test_a_map_that_fits_is_one_block_of_its_own_size() -> None:
    layout = planned((4, 3, 1, 7, 7))
    assert layout.chunk == layout.shape
    assert [(b.first_row, b.last_row) for b in layout.blocks()] == [(0, 84)]
