"""The hash of answers: FNV-1a, 32 bits, over status and all bits of the reading of each query."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

START = 2166136261
PRIME = 16777619


def fnv1a(data: bytes, start: int = START) -> int:
    """Return the FNV-1a hash of bytes, going on from `start`.

    Examples
    --------
    >>> hex(fnv1a(b"")), hex(fnv1a(b"a")), hex(fnv1a(b"foobar"))
    ('0x811c9dc5', '0xe40c292c', '0xbf9cf968')
    """
    value = start
    for byte in data:
        value = ((value ^ byte) * PRIME) & 0xFFFFFFFF
    return value


def answer_bytes(status: NDArray[Any], reading: NDArray[Any]) -> bytes:
    """Return answers as the target's memory holds them: status, then the struct, each query.

    Parameters
    ----------
    status : (m,) int8
    reading : (m, 3) float32 or int32
        Of `Host.read`, or of `read_i`: those become 16 bits each.
    """
    if reading.dtype == np.float32:
        words = np.ascontiguousarray(reading, "<f4").view(np.uint8)
    else:
        words = np.ascontiguousarray(reading & 0xFFFF, "<u2").view(np.uint8)
    rows = np.concatenate(
        [np.asarray(status, np.int8).view(np.uint8)[:, None], words.reshape(len(status), -1)],
        axis=1,
    )
    return rows.tobytes()
