"""Sizes of the codec `grid`: bits of a code and nodes per axis of each table.

Owns which axes a table has (found by probing), the smallest sensible sizes, and how a size grows.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from firmware_export.truth import Model

GROUPS = ("tip", "sdg", "height")
CHANNEL = {"tip": "tip_angle", "sdg": "sdg", "height": "height"}
LARGEST = 65
# Places looked at per axis when asking whether a value depends on it.
PROBES = 9
SEED = 20


@dataclass(frozen=True)
class Spec:
    """A size.

    Parameters
    ----------
    bits : int
        8 or 16.
    nodes : tuple of (str, tuple of int)
        Per table its name and the nodes of each parameter, of v and of u; 1 for an axis on
        which nothing depends.
    """

    bits: int
    nodes: tuple[tuple[str, tuple[int, ...]], ...]

    @property
    def label(self) -> str:
        """Short text, such as ``grid u8 tip 7x7x13x13 sdg 5x5x9x9``."""
        parts = [f"{name} {'x'.join(map(str, nodes))}" for name, nodes in self.nodes]
        return f"grid u{self.bits} {' '.join(parts)}"

    @classmethod
    def of_label(cls, label: str) -> "Spec":
        """Return the size with a label.

        Examples
        --------
        >>> Spec.of_label("grid u8 tip 17x17 sdg 9x9").nodes
        (('tip', (17, 17)), ('sdg', (9, 9)))
        """
        _, bits, *words = label.split()
        tables = zip(words[::2], words[1::2], strict=True)
        nodes = tuple((name, tuple(map(int, shape.split("x")))) for name, shape in tables)
        return cls(int(bits[1:]), nodes)

    @property
    def bytes(self) -> int:
        """Bytes of the codes, known before anything is encoded."""
        values = sum((2 if name == "sdg" else 1) * math.prod(shape) for name, shape in self.nodes)
        return values * self.bits // 8


@lru_cache(maxsize=8)
def active_axes(model: Model, name: str) -> tuple[bool, ...]:
    """Tell for each parameter, for v and for u whether a table's value depends on it.

    Compares the exact value at places that differ along one axis only.
    """
    rng = np.random.default_rng(SEED)
    axes = model.k + 2
    if name == "tip":
        return (True,) * axes
    result = []
    for axis in range(axes):
        base = rng.random((12, axes))
        place = np.repeat(base[:, None], PROBES, axis=1)
        place[:, :, axis] = np.linspace(0.0, 1.0, PROBES)
        params = model.at(place[..., : model.k].reshape(12 * PROBES, model.k))
        face = rng.integers(model.faces, size=12)[:, None]
        u, v = ((2.0 * place[..., at] - 1.0) * model.chart_limit for at in (-1, -2))
        gravity = model.uv_to_gravity(face, u, v).reshape(-1, 1, 3)
        exact = model.exact(params, gravity)
        value = exact.height_beyond if name == "height" else exact.along
        known = value.reshape(12, PROBES)
        with np.errstate(invalid="ignore"):
            spread = np.abs(known - known[:, :1])
        size = np.nanmax(np.abs(known), initial=1e-300)
        result.append(bool(np.nanmax(spread, initial=0.0) > 1e-9 * size))
    return tuple(result)


def start(model: Model, channels: tuple[str, ...], arithmetic: str) -> list[Spec]:
    """Return the smallest sensible size for each bit width."""
    nodes = []
    for name in GROUPS:
        if CHANNEL[name] in channels or name == "tip":
            active = active_axes(model, name)
            count = [3] * model.k + [5, 5]
            shape = tuple(n if on else 1 for n, on in zip(count, active, strict=True))
            nodes.append((name, shape))
    return [Spec(bits, tuple(nodes)) for bits in (8, 16)]


def grow(model: Model, spec: Spec) -> list[Spec]:
    """Return the next larger sizes: one axis of one table each, v and u together."""
    result = []
    for at, (name, shape) in enumerate(spec.nodes):
        for axis in range(model.k + 1):
            if shape[axis] == 1 or shape[axis] >= LARGEST:
                continue
            # v and u are alike: an odd number keeps a knot in the middle.
            more = shape[axis] + (2 if axis == model.k or shape[axis] >= 9 else 1)
            larger = list(shape)
            larger[axis] = more
            if axis == model.k:
                larger[axis + 1] = more if shape[axis + 1] > 1 else 1
            nodes = list(spec.nodes)
            nodes[at] = (name, tuple(larger))
            result.append(replace(spec, nodes=tuple(nodes)))
    return result
