"""Our Fletcher-32 against the one that HDF5 writes."""

from io import BytesIO

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from lutgen.mapping import checksum
from lutgen.mapping.checksum import fletcher32

# Sizes in words around the border of our blocks and around the 360 words after which HDF5 folds.
BORDER = checksum._BLOCK
SIZES = (1, 2, 359, 360, 361, BORDER - 1, BORDER, BORDER + 1, 3 * BORDER, 3 * BORDER + 7)


def hdf5_checksum(words: NDArray[np.uint16]) -> int:
    """Let h5py write one chunk with the fletcher32 filter; return its last 4 bytes."""
    with h5py.File(BytesIO(), "w") as file:
        data = file.create_dataset("data", data=words, chunks=words.shape, fletcher32=True)
        file.flush()
        _, raw = data.id.read_direct_chunk((0,))
    assert len(raw) == 2 * len(words) + 4
    return int.from_bytes(raw[-4:], "little")


@pytest.mark.parametrize("size", SIZES)
def test_checksum_of_random_words_is_that_of_hdf5(size: int) -> None:
    words = np.random.default_rng(size).integers(0, 1 << 16, size, np.uint16)
    assert int(fletcher32(words)) == hdf5_checksum(words)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("word", [0x0000, 0xFFFF, 0xFF00, 0x0001, 0x8000])
def test_checksum_of_equal_words_is_that_of_hdf5(size: int, word: int) -> None:
    # 0xFFFF is 0 modulo 65535, but a sum that is not zero never folds to zero.
    words = np.full(size, word, np.uint16)
    assert int(fletcher32(words)) == hdf5_checksum(words)


def test_checksum_of_float32_values_with_nan_is_that_of_hdf5() -> None:
    values = np.random.default_rng(3).normal(size=20_000).astype(np.float32)
    values[::7] = np.nan
    assert int(fletcher32(values.view(np.uint16))) == hdf5_checksum(values.view(np.uint16))


def test_checksum_sees_two_words_change_places() -> None:
    words = np.arange(2 * BORDER, dtype=np.uint16)
    swapped = words.copy()
    swapped[[5, BORDER + 5]] = swapped[[BORDER + 5, 5]]
    assert fletcher32(words) != fletcher32(swapped)


@pytest.mark.parametrize("size", [1, 2, 5, BORDER, 9 * BORDER + 5])
def test_checksum_of_words_whose_sums_fold_is_hdf5s(size: int) -> None:
    words = np.full(size, 0xFFFF, np.uint16)
    assert int(fletcher32(words)) == hdf5_checksum(words)
