"""Charts of the sphere of gravity directions: direction <-> (face, u, v).

Face coordinates are gnomonic, u = g[a] / |g[c]| and v = g[b] / |g[c]| without any
change of sign, with (c, a, b) of the face table below.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.errors import InputError

# m/s^2.
STANDARD_GRAVITY = 9.80665

# Normal axis c, its sign, and the axes a (u) and b (v) of the faces -z, +x, -x, +y, -y, +z.
FACE_NORMAL = np.array([2, 0, 0, 1, 1, 2])
FACE_SIGN = np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0])
FACE_U = np.array([0, 1, 1, 0, 0, 0])
FACE_V = np.array([1, 2, 2, 2, 2, 1])

# A node of the rim that went through a square root comes back within a few 1e-16 of it.
_RIM = 1e-12


@dataclass(frozen=True)
class Chart:
    """A chart: which directions a map covers and where its nodes are.

    ``"cone"`` is the one face around -z, a square in (u, v) whose sides are `max_tilt` (rad) away
    from straight down, and with one node straight down alone; ``"sphere"`` is six faces, every
    direction, with two nodes or more per side.
    """

    kind: str
    nodes: int
    max_tilt: float = math.pi / 4

    @property
    def faces(self) -> int:
        """Number of faces: 1 or 6."""
        return 1 if self.kind == "cone" else 6

    @property
    def shape(self) -> tuple[int, int, int]:
        """Nodes along face, v and u."""
        return self.faces, self.nodes, self.nodes

    @property
    def limit(self) -> float:
        """Largest |u| and |v| of a face; 0 for a single node."""
        if self.nodes == 1:
            return 0.0
        return math.tan(self.max_tilt) if self.kind == "cone" else 1.0

    @property
    def coords(self) -> NDArray[np.float64]:
        """Values of u (and of v) at the nodes, (nodes,), antisymmetric to the last bit."""
        evenly = np.linspace(-self.limit, self.limit, self.nodes)
        return np.asarray((evenly - evenly[::-1]) / 2.0)

    def directions(self) -> NDArray[np.float64]:
        """Return the gravity directions (faces, nodes, nodes, 3), unit, by face, v and u."""
        v, u = np.meshgrid(self.coords, self.coords, indexing="ij")
        middle, across, up = self.basis().transpose(1, 0, 2)[:, :, None, None]
        directions = middle + u[..., None] * across + v[..., None] * up
        return np.asarray(directions / np.sqrt(1.0 + u * u + v * v)[None, :, :, None])

    def basis(self) -> NDArray[np.float64]:
        """Return the frames (faces, 3, 3): the middle of each face, its u axis, its v axis.

        The direction at (u, v) is middle + u * (u axis) + v * (v axis), not normalised.
        """
        result = np.zeros((self.faces, 3, 3))
        for face in range(self.faces):
            result[face, 0, FACE_NORMAL[face]] = FACE_SIGN[face]
            result[face, 1, FACE_U[face]] = 1.0
            result[face, 2, FACE_V[face]] = 1.0
        return result

    def solid_angle(self) -> NDArray[np.float64]:
        """Return the solid angle (faces, nodes, nodes) of each node's cell, sr; 1 for a lone node.

        It goes up to half way to the neighbours, and is cut at the face's rim.
        """
        if self.nodes == 1:
            return np.ones(self.shape)
        coords = self.coords
        bounds = np.concatenate([coords[:1], (coords[:-1] + coords[1:]) / 2.0, coords[-1:]])
        v, u = np.meshgrid(bounds, bounds, indexing="ij")
        # The corner function of the solid angle of a rectangle seen from distance 1.
        corner = np.arctan(u * v / np.sqrt(1.0 + u * u + v * v))
        cells = np.diff(np.diff(corner, axis=0), axis=1)
        return np.ascontiguousarray(np.broadcast_to(cells, self.shape))

    def locate(
        self, gravity_dir: ArrayLike
    ) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """Find the face of each direction (m, 3), of any length above 0, and the place on it.

        Returns the face (m,) that the largest component points to, of equal ones the lower number,
        so that a seam belongs to one face; its coordinates u and v (m,), NaN for the cone where
        gravity has no component along -z; and True if the chart covers the direction (m,).
        """
        down = unit_directions(gravity_dir)
        if down.ndim != 2:
            raise InputError(
                f"gravity_dir must have shape (m, 3) (got {down.shape}); pass rows of x, y, z."
            )
        along = down[:, FACE_NORMAL[: self.faces]] * FACE_SIGN[: self.faces]
        row, face = np.arange(len(down)), along.argmax(axis=1)
        depth = np.where(along[row, face] > 0.0, along[row, face], np.nan)
        # A direction just below the horizon may overflow to infinity: not inside.
        with np.errstate(over="ignore"):
            u, v = down[row, FACE_U[face]] / depth, down[row, FACE_V[face]] / depth
        rim = self.limit * (1.0 + _RIM) if self.nodes > 1 else _RIM
        inside = (np.abs(u) <= rim) & (np.abs(v) <= rim)
        u = np.where(inside, np.clip(u, -self.limit, self.limit), u)
        v = np.where(inside, np.clip(v, -self.limit, self.limit), v)
        return face, u, v, inside


def unit_directions(vectors: ArrayLike) -> NDArray[np.float64]:
    """Return directions (..., 3), of any length above 0 that a float has, with length 1."""
    raw = np.asarray(vectors, dtype=np.float64)
    if raw.ndim == 0 or raw.shape[-1] != 3:
        raise InputError(
            f"a direction needs 3 components (got an array of shape {raw.shape}); pass x, y, z."
        )
    # Along columns NumPy is four times as fast as along rows of three.
    columns = np.moveaxis(raw, -1, 0).copy()
    size = np.abs(columns).max(axis=0)
    good = (size > 0.0) & (size < np.inf)
    if not good.all():
        raise InputError(
            f"a direction must be finite and longer than 0 (got {raw[~good][0].tolist()}); "
            "leave out readings without a direction."
        )
    # Two steps: dividing by the largest component first keeps the squares in range.
    columns /= size
    columns /= np.sqrt((columns * columns).sum(axis=0))
    return np.ascontiguousarray(np.moveaxis(columns, 0, -1))


def gravity_from_up(up_dir: ArrayLike) -> NDArray[np.float64]:
    """Turn what an accelerometer at rest reads (..., 3) into unit vectors pointing down.

    On level ground it reads along +z.  While the robot accelerates it holds the inertial forces
    too, and the result is then the direction that decides if it tips.

    Examples
    --------
    >>> gravity_from_up([0.0, 0.0, 9.81]).tolist()
    [0.0, 0.0, -1.0]
    """
    down: NDArray[np.float64] = 0.0 - unit_directions(up_dir)
    return down


def gravito_inertial(gravity_dir: ArrayLike, acceleration: ArrayLike) -> NDArray[np.float64]:
    """Return the unit vector along 9.80665 g - a, for a robot that accelerates: what tips it.

    `gravity_dir` (3,) points down, `acceleration` (3,) is that of the com in m/s^2, body frame.

    Examples
    --------
    Braking from forward motion tips the robot over its nose:

    >>> gravito_inertial([0.0, 0.0, -1.0], [-9.80665, 0.0, 0.0]).round(3).tolist()
    [0.707, 0.0, -0.707]
    """
    pull = np.asarray(acceleration, dtype=np.float64)
    if pull.shape != (3,) or not np.isfinite(pull).all():
        raise InputError(
            f"an acceleration needs three finite numbers in m/s^2 (got {pull.tolist()}); "
            "give x, y, z in the body frame"
        )
    felt = STANDARD_GRAVITY * unit_directions(gravity_dir) - pull
    if not np.linalg.norm(felt) > 1e-9 * STANDARD_GRAVITY:
        raise InputError(
            f"the robot is in free fall (got the acceleration {pull.tolist()} m/s^2); nothing "
            "presses it on the ground then"
        )
    return unit_directions(felt)
