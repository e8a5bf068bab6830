"""Static equilibrium on uneven ground: each contact has a normal and a friction of its own.

The verdict and the region of centres of mass that hold are those of Bretl and Lall, "Testing
Static Equilibrium for Legged Robots", IEEE T-RO 24(4), 2008.  A file describes the feet.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from lutgen.analysis.balance import BOX, MISSING, SAME, Balance, margin_in
from lutgen.chart import unit_directions
from lutgen.errors import InputError, reject
from lutgen.recipe import read_tables, read_text
from lutgen.recipe.load import NOTHING, Fault, refuse
from lutgen.recipe.model import unit
from lutgen.recipe.schema import Direction, LengthUnit, NotNegative, Place, Table, Text, key
from lutgen.vector import Floats

# Sides of the pyramids, of a verdict until those inside and outside the cones agree.
SIDES, MOST = 64, 256
# The largest number that is taken: squares and products of such are finite.
LARGEST = 1e100
# More friction than this is a wall, and no ground; the programmes lose their accuracy beyond.
ROUGHEST = 1e6
DOWN = [0.0, 0.0, -1.0]


@dataclass(frozen=True, eq=False)
class Footing:
    """Named contacts on uneven ground and the weight that they are to hold.

    As `equilibrium` takes them: `points` and `normals` (n, 3), `friction` (n,), `com` and
    `gravity_dir` (3,); lengths in `length_unit`.  `title` is for people.
    """

    title: str
    length_unit: str
    names: tuple[str, ...]
    points: Floats
    normals: Floats
    friction: Floats
    com: Floats
    gravity_dir: Floats

    def equilibrium(self) -> "Equilibrium":
        """Return the balance of the weight on the feet."""
        return equilibrium(self.points, self.normals, self.friction, self.com, self.gravity_dir)


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Balance of a weight on contacts, and where else the weight may be.

    `holds` is None where pyramids of 256 sides inside and outside the cones do not agree: friction
    is within 1e-4 of what is just enough.  `forces` (n, 3) are one admissible set as shares of the
    weight, in the frame of the input: the one with the least largest normal force among pyramids of
    64 sides; None unless it holds.  `region` (k, 2) has the corners of the com positions that hold,
    counter-clockwise seen from above: a polygon, the two ends of a line, a point, or none.  It is
    an inner approximation, by pyramids of 64 sides and to 1e-4 of its diameter, along the
    horizontal unit `axes` (2, 3): the part of the frame's x across gravity (of y where gravity is
    within 6 deg of x), and the one to the left of it.  It `is_open` if it reaches the end of the
    search, 100 sizes from the contacts' middle.  `margin` is the least horizontal distance from the
    com to its boundary, a length: negative outside, 0 on a line or point, -inf without a region,
    inf without a boundary within the search.  A com at the very limit may hold with a margin just
    below 0.
    """

    holds: bool | None
    forces: Floats | None
    region: Floats
    axes: Floats
    is_open: bool
    margin: float


def equilibrium(
    points: ArrayLike,
    normals: ArrayLike,
    friction: ArrayLike,
    com: ArrayLike,
    gravity_dir: ArrayLike = (0.0, 0.0, -1.0),
) -> Equilibrium:
    """Return the balance of a weight on contacts on uneven ground.

    It holds if and only if forces f_i in the friction cones carry the weight: sum f_i = -g and
    sum (p_i - com) x f_i = 0 (Bretl and Lall, Eqs 1 to 3), to within 1e-7 of the weight and of
    weight x size; at the limit it holds.  The size is the largest distance of a contact from their
    middle; of one contact alone, that of the com from it.

    `points` (n, 3) are where the robot touches the ground, `normals` (n, 3) lead out of the ground,
    of any length > 0; `friction`, 0 to 1e6, is of all contacts or (n,) of each; `com` (3,) is the
    centre of mass and `gravity_dir` (3,) down, of any length > 0.

    Examples
    --------
    Two feet on the walls of a ditch, 45 deg steep, 2 wide:

    >>> walls = [[1, 0, 1], [-1, 0, 1]]
    >>> found = equilibrium([[-1, 0, 0], [1, 0, 0]], walls, 0.5, [0.3, 0, 1])
    >>> found.holds, round(float(found.region[:, 0].max()), 6)
    (True, 0.8)
    """
    arrays = [np.asarray(one, np.float64) for one in (points, normals, friction, com, gravity_dir)]
    places, outward, mu, middle, down = arrays
    n, shapes = len(np.atleast_1d(places)), [one.shape for one in arrays]
    right = n > 0 and shapes == [(n, 3), (n, 3), mu.shape, (3,), (3,)] and mu.shape in ((), (n,))
    finite = all((np.abs(one) < LARGEST).all() for one in arrays)
    if not (right and finite and ((mu >= 0.0) & (mu <= ROUGHEST)).all()):
        what = f"a contact and a com need x, y, z, and each a friction from 0 to {ROUGHEST:g}"
        got = f"the shapes {shapes} and friction {mu.tolist()}"
        reject("footing", what, got, "give finite numbers as a file of feet has them", InputError)
    # Sideways, left and up, as rows.
    frame = _level_frame(np.asarray(unit_directions(down)))
    origin = places.mean(axis=0)
    size = float(np.linalg.norm(places - origin, axis=1).max())
    away = float(np.linalg.norm(middle - origin))
    # Contacts that rounding alone keeps apart are one.
    size = size if size > 1e-9 * away else away
    size = size or 1.0
    scene = (
        (places - origin) @ frame.T / size,
        unit_directions(outward) @ frame.T,
        np.broadcast_to(mu, (len(places),)),
    )
    place = (frame[:2] @ (middle - origin)) / size
    holds, forces = _verdict(scene, place)
    region = Balance.of(*scene, SIDES).region()
    margin = margin_in(region, place) * size
    if holds and (np.abs(place) > BOX).any():
        # Held outside the search: what the region ends at is not its boundary.
        margin = np.inf
    if holds is False:
        # Both are rounded; of two answers the verdict is the safe one.
        margin = min(margin, 0.0)
    return Equilibrium(
        holds,
        None if forces is None else forces @ frame,
        region * size + frame[:2] @ origin,
        frame[:2],
        bool((np.abs(region) > BOX * (1.0 - SAME)).any()),
        margin,
    )


def _level_frame(down: Floats) -> Floats:
    """Return the axes (3, 3) of `Equilibrium.axes`, and up."""
    # cos 6 deg: beyond it too little of x is level to name a heading.
    ahead = np.array([1.0, 0.0, 0.0] if abs(down[0]) < 0.9945 else [0.0, 1.0, 0.0])
    ahead = ahead - (ahead @ down) * down
    ahead /= np.linalg.norm(ahead)
    # Zero has no sign.
    return np.array([ahead, np.cross(-down, ahead), -down]) + 0.0


def _verdict(
    scene: tuple[Floats, Floats, Floats], com: Floats
) -> tuple[bool | None, Floats | None]:
    """Return True and the forces (n, 3) if a com (2,) holds; False or None (undecided) if not.

    Pyramids inside the cones say yes, those around them no.
    """
    for sides in (SIDES, MOST):
        balance = Balance.of(*scene, sides)
        missing, strengths, _ = balance.missing(com)
        if missing <= MISSING:
            return True, balance.gentlest(strengths)
        if Balance.of(*scene, sides, outside=True).missing(com)[0] > MISSING:
            return False, None
    return None, None


class Foot(Table):
    """A point contact on ground of its own slope."""

    name: Text | None = key("A name of its own.", "left", None)
    position: Place = key("Where it touches the ground.", [0.2, 0.1, 0])
    normal: Direction | None = key("The ground's, upwards; else against gravity.", [0, 0, 1], None)
    friction: NotNegative | None = key("Its coefficient, if not that of all.", 0.5, None)


class Feet(Table):
    """Contents of a file of `lutgen stance`."""

    title: Text | None = key("Its name in figures, if not the file's.", "stair", None)
    length_unit: LengthUnit = key("The unit of all lengths.", "m", "m")
    com: Place = key("The centre of mass.", [0, 0, 0.5])
    gravity: Direction = key("Gravity, pointing down.", [0, 0, -1], DOWN)
    friction: NotNegative | None = key("Coefficient of all feet that have none.", 0.5, None)
    foot: list[Foot] = key("At least one.", [], [])


def read_footing(path: str) -> Footing:
    """Read the feet and the centre of mass; a file with any fault raises RecipeError."""
    feet = read_tables(read_text(path), path, Feet)
    names = [foot.name or f"P{place}" for place, foot in enumerate(feet.foot, 1)]
    friction = [feet.friction if foot.friction is None else foot.friction for foot in feet.foot]
    refuse(path, _faults(names, None in friction))
    down = unit(feet.gravity)
    # Zero has no sign, not even turned round.
    up = [0.0 - part for part in down]
    return Footing(
        feet.title or Path(path).stem,
        feet.length_unit,
        tuple(names),
        points=np.array([foot.position for foot in feet.foot]),
        normals=np.array([unit(foot.normal) if foot.normal else up for foot in feet.foot]),
        friction=np.array(friction),
        com=np.array(feet.com),
        gravity_dir=np.array(down),
    )


def _faults(names: list[str], smooth: bool) -> Iterator[Fault]:
    """Yield what is wrong with feet of these names, one of which is `smooth`: without friction."""
    if not names:
        yield Fault("foot", "is missing", NOTHING, "add a [[foot]] for each contact")
    if smooth:
        yield Fault("friction", "is missing", NOTHING, "write for example friction = 0.5")
    for place, name in enumerate(names, 1):
        # The name that it would have may be taken.
        if name in names[: place - 1]:
            yield Fault(f"foot[{place}].name", "is given twice", name, "choose another name")
