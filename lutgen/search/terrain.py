"""The path: points in the world, the robot's heading, and gravity relative to the ground.

The world frame has z up; the frame of the ground under the robot has z along the ground's normal,
upward, and x ahead, so that yaw of x is the robot's heading.  Convention "plane" of
`channels.resting` takes gravity in that frame.  Paths come from CSV files as other programs write
them; logs of robots are read by the same rows.
"""

import csv
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import StringIO

import numpy as np
from numpy.typing import ArrayLike

from lutgen import bounds
from lutgen.chart import unit_directions
from lutgen.errors import InputError, reject
from lutgen.recipe.load import utf8
from lutgen.vector import Floats

# The paper prints no interval; its sin(x)/x has no value at 0.
SPAN = (1e-6, 4.0 * math.pi)
# Points are equal when they are nearer than this share of the path's length, and a direction is
# vertical when its horizontal part is this small.
EQUAL = 1e-12
# Numbers whose products still are numbers.
LARGEST = 1e100
COLUMNS = ("x", "y", "z", "heading", "nx", "ny", "nz")


@dataclass(frozen=True, eq=False)
class Path:
    """Where a robot drives, p points in order.

    `position` (p, 3) is in the length unit, world frame, z up; `heading` (p,) is the yaw of the
    robot's x axis in the world, rad, counter-clockwise from world x; `gravity` (p, 3) are unit
    vectors, down, in the frame of the ground under the robot: x ahead, z its normal.
    """

    position: Floats
    heading: Floats
    gravity: Floats

    @property
    def distance(self) -> Floats:
        """Length of the path from its first point to each point, (p,)."""
        steps = np.linalg.norm(np.diff(self.position, axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(steps)])


def paper_path(points: int = 100, span: tuple[float, float] = SPAN) -> Path:
    """Return the paper's rough terrain, Eqs 30-33: x = s, y = 0.8 sin(s)/s, z = 15 sin(s)^2/s.

    The points, at least 2, are evenly spaced in s over the `span`; they have no unit, and the
    heading is 0 throughout.  The robot pitches by atan(dz/ds), its roll is 0.

    Examples
    --------
    >>> path = paper_path(3)
    >>> (path.position.round(3) + 0.0).tolist()
    [[0.0, 0.8, 0.0], [6.283, 0.0, 0.0], [12.566, 0.0, 0.0]]
    >>> path.gravity[0].round(3)  # it begins with a climb of 86 deg
    array([-0.998,  0.   , -0.067])
    """
    s = np.linspace(*span, points)
    # NumPy's sinc has pi inside, and the value 1 at 0.
    sinc = np.sinc(s / np.pi)
    position = np.column_stack([s, 0.8 * sinc, 15.0 * np.sin(s) * sinc])
    pitch = np.arctan(15.0 * sinc * (2.0 * np.cos(s) - sinc))
    level = np.zeros(points)
    gravity = np.column_stack([-np.sin(pitch), level, -np.cos(pitch)])
    return Path(position, level, gravity)


def along(
    position: ArrayLike, heading: ArrayLike | None = None, normal: ArrayLike | None = None
) -> Path:
    """Return the path through points (p, 3), at least 2, none twice in a row, world frame, z up.

    `heading` (p,) is the robot's yaw, rad; by default it looks along the path, and on a vertical
    piece as on the piece before it.  `normal` (p, 3) are the ground's normals, world frame, upward
    (z >= 0), any length > 0; by default the ground is level across the path, and slopes along it as
    the path does: by central differences of second order in the path's length, one-sided at both
    ends.

    `InputError` for normals that point down, and a path that turns back on itself where its
    direction is needed.

    Examples
    --------
    Up a slope of 45 deg along x, looking across it with the hill to the right: gravity pulls to the
    left.

    >>> path = along([[0, 0, 0], [1, 0, 1]], heading=[np.pi / 2, np.pi / 2])
    >>> path.gravity[0].round(3) + 0.0
    array([ 0.   ,  0.707, -0.707])
    """
    points = np.array(position, dtype=np.float64)
    yaw = None if heading is None else np.array(heading, dtype=np.float64)
    if normal is not None:
        up = unit_directions(normal)
        below = np.flatnonzero(up[:, 2] < 0.0)
        if len(below):
            what = f"the ground's normal at point {below[0]} points down"
            reject("path", what, up[below[0]].tolist(), "turn it round", InputError)
    if normal is None or yaw is None:
        tangent = _tangents(points)
        travel = _directions(tangent)
        if normal is None:
            up = _level_across(tangent, travel)
        if yaw is None:
            yaw = np.arctan2(travel[:, 1], travel[:, 0])
    return Path(points, yaw, _gravity(up, yaw))


def turned(path: Path, turn: ArrayLike) -> Path:
    """Return the path with the robot turned about the ground's normal.

    `turn`, one or (p,), is in rad, to the left; the heading becomes the yaw of the turned robot,
    which on a slope changes by a little more or less.
    """
    angle = np.broadcast_to(np.asarray(turn, dtype=np.float64), path.heading.shape)
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = path.gravity.T
    gravity = np.column_stack([cos * x + sin * y, cos * y - sin * x, z])
    # The horizontal parts of both x axes, (1, 0, 0) and (cos, sin, 0): their angle
    # about the vertical.
    yaw = np.arctan2(-z * sin, cos - x * (cos * x + sin * y))
    return Path(path.position, path.heading + yaw, gravity)


def _tangents(position: Floats) -> Floats:
    """Return the path's direction at each point, (p, 3), unit."""
    chord = np.diff(position, axis=0)
    step = np.linalg.norm(chord, axis=1, keepdims=True)
    chord /= step
    # Second order also where steps differ: the tangent of the circle through three points.
    inner = (step[1:] * chord[:-1] + step[:-1] * chord[1:]) / (step[1:] + step[:-1])
    slope = np.vstack([chord[:1], inner, chord[-1:]])
    length = np.linalg.norm(slope, axis=1)
    still = np.flatnonzero(length <= EQUAL)
    if len(still):
        what = f"it turns back on itself at point {still[0]}, so it has no direction there"
        way_out = "give headings and the ground's normals"
        reject("path", what, position[still[0]].tolist(), way_out, InputError)
    return np.asarray(slope / length[:, None])


def _directions(tangent: Floats) -> Floats:
    """Return the horizontal directions of travel, (p, 2), unit; on walls the one before holds."""
    flat = tangent[:, :2]
    length = np.linalg.norm(flat, axis=1)
    known = length > EQUAL * np.linalg.norm(tangent, axis=1)
    if not known.any():
        return np.tile([1.0, 0.0], (len(tangent), 1))
    last = np.maximum.accumulate(np.where(known, np.arange(len(tangent)), -1))
    # A path that begins on a wall looks as it does above it.
    last[last < 0] = known.argmax()
    return np.asarray((flat / np.where(known, length, 1.0)[:, None])[last])


def _level_across(tangent: Floats, travel: Floats) -> Floats:
    """Return the upward normals of ground that slopes along the path and is level across it."""
    along_it = (tangent[:, :2] * travel).sum(axis=1)
    slope = np.arctan2(tangent[:, 2], np.maximum(along_it, 0.0))
    return np.column_stack([-np.sin(slope)[:, None] * travel, np.cos(slope)])


def _gravity(normal: Floats, heading: Floats) -> Floats:
    """Return gravity in the frame of the ground: z its normal, x ahead, at this yaw.

    x is the direction in the ground whose horizontal part points along the heading.
    """
    ahead = np.column_stack([np.cos(heading), np.sin(heading), np.zeros(len(heading))])
    into = (normal * ahead).sum(axis=1)
    # Times the normal's z component, so that x points straight up or down on a wall ahead.
    x = normal[:, 2:] * ahead
    x[:, 2] -= into
    length = np.linalg.norm(x, axis=1, keepdims=True)
    # Along a wall, x is horizontal.
    x = np.where(length > EQUAL, x / np.where(length > EQUAL, length, 1.0), ahead)
    y = np.cross(normal, x)
    return unit_directions(-np.column_stack([x[:, 2], y[:, 2], normal[:, 2]]))


def read_path(file: str | os.PathLike[str]) -> Path:
    """Read a path from a CSV file: UTF-8, comma separated.

    The first line names the columns in any order: x, y, z, and if wanted heading (deg) and the
    ground's normal nx, ny, nz; see `along`.  Anything else is refused with line and column.
    """

    def columns(names: list[str]) -> tuple[Sequence[str], Sequence[str]]:
        normal = COLUMNS[4:] if any(name in names for name in COLUMNS[4:]) else ()
        return (*COLUMNS[:3], *normal), COLUMNS

    rows, lines = read_rows(file, columns)
    point = np.column_stack([rows[name] for name in ("x", "y", "z")])
    steps = np.linalg.norm(np.diff(point, axis=0), axis=1)
    same = np.flatnonzero(steps <= EQUAL * steps.sum())
    if len(same):
        at = int(same[0]) + 1
        what = f"line {lines[at]} repeats the point before it"
        reject(os.fspath(file), what, point[at].tolist(), "leave it out", InputError)
    heading = np.radians(rows["heading"]) if "heading" in rows else None
    normal = np.column_stack([rows[n] for n in ("nx", "ny", "nz")]) if "nx" in rows else None
    try:
        return along(point, heading, normal)
    except InputError as error:
        raise InputError(f"{os.fspath(file)}: {error}") from error


def read_rows(
    file: str | os.PathLike[str],
    columns: Callable[[list[str]], tuple[Sequence[str], Sequence[str]]],
    what: str = "a path needs at least 2 points",
    least: int = 2,
) -> tuple[dict[str, Floats], list[int]]:
    """Return the columns of a CSV file by name, each (p,), and the line of each row.

    It is UTF-8, comma separated, the names of the columns in the first line, finite numbers in all
    others; as large as a terrain may be.  Anything else is refused with line and column.
    `columns` says, of the names in a file, which it needs and which it may have; `what` is the
    sentence for a file of fewer than `least` rows.
    """
    source = os.fspath(file)
    text = utf8(bounds.read(source, bounds.TERRAIN_BYTES, InputError), source, InputError)
    reader = csv.reader(StringIO(text, newline=""))
    rows: list[list[float]] = []
    lines: list[int] = []
    try:
        names = [name.strip() for name in next(reader, [])]
        _check_columns(source, names, *columns(names))
        for cells in reader:
            if cells:
                bounds.check(len(rows) + 1, bounds.POINTS, source, "cut the path into parts")
                rows.append(_read_row(f"{source}: line {reader.line_num}", names, cells))
                lines.append(reader.line_num)
    except csv.Error as error:
        reject(source, f"line {reader.line_num} is no CSV", error, "save it again", InputError)
    if len(rows) < least:
        reject(source, what, len(rows), "add lines", InputError)
    return dict(zip(names, np.array(rows).T, strict=True)), lines


def _check_columns(
    source: str, names: Sequence[str], wanted: Sequence[str], known: Sequence[str]
) -> None:
    """Refuse columns of a file of which one is missing, unknown or there twice."""
    got = ",".join(names) or "nothing"
    for name in wanted:
        if name not in names:
            way_out = f"begin with {','.join(wanted)}"
            reject(source, f"line 1 names no column {name}", got, way_out, InputError)
    for name in names:
        if name not in known:
            what = f"line 1 names the unknown column {name!r}"
            reject(source, what, got, f"leave only columns of {', '.join(known)}", InputError)
    if len(set(names)) < len(names):
        reject(source, "line 1 names a column twice", got, "rename or drop one", InputError)


def _read_row(where: str, names: list[str], cells: list[str]) -> list[float]:
    """Return the numbers of one line."""
    if len(cells) != len(names):
        what = f"must have {len(names)} cells, as the first line has"
        reject(where, what, len(cells), "give one number for each column", InputError)
    numbers = []
    for name, cell in zip(names, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not abs(number) < LARGEST:
            what, way_out = "is no finite number", "write one such as 1.25"
            reject(f"{where}, column {name}", what, repr(cell), way_out, InputError)
        numbers.append(number)
    return numbers
