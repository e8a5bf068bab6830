"""What one cell of postures proves: the guard that it needs, and that what is answered stands.

The three contacts P_i, seen from the com, span a cone; E_i = P_i x P_(i+1) are its inward edge
normals, m_i = E_i / |E_i|.  The C has the points P_i + d_i, from them normals M_i, and answers the
least asin(M_i . g), less the guard.

*One edge.*  M_i is normal to both stored points but for the rounding c of the vector product, so
M_i . P_i = (c . P_i - E* . d_i) / |E*| with E* the stored product, and the same with P_(i+1).  What
of M_i lies in the plane of P_i and P_(i+1) is known from these two products: its length is the sine
of the angle V between both planes.  asin(M . g) is g's distance from a great circle: it changes by
no more than its pole turns.

*Only the arc counts.*  Let w be a direction on the arc from P_i to P_(i+1), a combination of both
with weights >= 0: then only products M_i . P above 0 count.  Where g is inside the true cone and
edge i the nearest, the foot of g on it lies on that arc, so asin(M_i . g) <= asin(m_i . g) +
asin(M_i . w).  And the directions with all M_i . g > sin V are a convex set that holds no direction
of the true boundary: it lies inside the true cone if one of its directions, the *witness*, does.
So V may be taken of the arcs; cells without a witness are halved.

*Where the facet is low.*  |E_i| is at least the side's length times the height of the com over the
facet, and the C answers only where that is above its lowest height.
"""

from typing import Any

from flint import arb

from proofs.prove.balls import ABOUT, INFINITE, ONE, ZERO, Jet, cross, most, norm, root, vector
from proofs.prove.held import Map, Points, Tables
from proofs.prove.motion import Postures
from proofs.prove.rounding import ARCSINE, LAST, READ, U

# Each edge, from corner to corner.
NEXT = ((0, 1), (1, 2), (2, 0))
# An edge normal whose square is a number of single precision, far from the ends of these.
SMALLEST = arb("1e-14")


def examine(
    stored: Points | Tables, map_: Map, rules: tuple[float, float, float], box: Any
) -> tuple[arb, arb, str]:
    """Return the guard (rad) that floats need on a cell, how far planes turn, and why neither.

    `rules` is what stands by the recipe: least -n_z (-2: any), least width, radius of the com's
    ball; `box` holds (low, high) of each parameter.
    """
    cell = _Cell(stored, box)
    height, sign, refused, reason = _stands(cell, map_, *rules)
    if refused:
        return ZERO, ZERO, ""
    sine, away = (INFINITE, ZERO) if reason else _turned(cell, height, sign)
    if not (sine < 1 and away > rules[2]):
        reason = reason or "a tip-over axis comes too near to the centre of mass"
        return INFINITE, INFINITE, reason
    ball, turn = (rules[2] / away).asin(), sine.asin()
    guard = turn + _rest(sine, (height / cell.reach).lower(), ball)
    return (guard + ball).upper(), (turn + ball).upper(), ""


class _Cell:
    """Points over a cell: the true ones `p`, how far stored ones are off `d`, these `seen`."""

    def __init__(self, stored: Points | Tables, box: Any) -> None:
        here = Postures(box)
        self.half = here.half
        truth, off = stored.compared(here)
        # The stored points without rounding; what they are off, and what rounding adds.
        self.stored, self.off = (truth + off).reshape(3, 3), off.reshape(3, 3)
        self.errors = stored.errors.reshape(3, 3)
        self.p = self.over(truth).reshape(3, 3)
        self.d = self.over(off).reshape(3, 3) + self.errors * ABOUT
        self.seen = self.p + self.d
        self.true = [cross(self.p[i], self.p[j]) for i, j in NEXT]
        self.held = [cross(self.seen[i], self.seen[j]) for i, j in NEXT]
        self.sides = [norm(self.p[i] - self.p[j]) for i, j in NEXT]
        self.rounded = [self._product_error(i, j) for i, j in NEXT]
        # How far the stored normals are from the true ones.
        self.moved = [
            (norm(cross(self.p[i], self.d[j]) + cross(self.d[i], self.seen[j])) + more).upper()
            for (i, j), more in zip(NEXT, self.rounded, strict=True)
        ]
        self.reach = max(norm(one).upper() for one in self.p)

    def over(self, jets: Any) -> Any:
        """Return the ranges of functions over the cell."""
        return vector(one.over(self.half) for one in jets.ravel())

    def _product_error(self, i: int, j: int) -> arb:
        """Return how far rounding puts a vector product off."""
        a, b = (vector(map(most, self.seen[n])) for n in (i, j))
        sums = vector(a[m] * b[n] + a[n] * b[m] for m, n in ((1, 2), (2, 0), (0, 1)))
        return (arb("2.01") * U * norm(sums)).upper()

    def products(self, i: int, j: int) -> list[arb]:
        """Return - E* . d of the edge from i to j, of its two ends."""
        normal = cross(self.stored[i], self.stored[j])
        wide = vector(map(most, self.over(normal)))
        near, far = (norm(self.over(self.stored[n])).upper() for n in (i, j))
        mine, other = (norm(self.errors[n]).upper() for n in (i, j))
        found = []
        for at, this in ((i, mine), (j, other)):
            # What rounding adds: to the points of the normal, to d, to the product itself.
            more = near * other + far * mine + mine * other
            more = more * (norm(self.over(self.off[at])) + this) + wide @ self.errors[at]
            more += self.rounded[i] * norm(self.p[at])
            product: Jet = normal @ self.off[at]
            found.append(ABOUT * more.upper() - product.over(self.half))
        return found


def _stands(
    cell: _Cell, map_: Map, steepest: float, width: float, ball: float
) -> tuple[arb, int, bool, str]:
    """Return the least height of postures that may be answered as standing, and its sign.

    Then whether the C refuses all of the cell, and why an answer may be wrong, empty where it is
    right.
    """
    lowest, held_steepest, held_width = map(arb, map_.limits)
    low_by, wide_by = lowest * (1 - 8 * U), held_width * (1 - 16 * U)
    normal = sum(cell.true)
    volume, size = cell.true[0] @ cell.p[2], norm(normal)
    wrong = sum(cell.moved, ZERO) + 16 * U * max(norm(one).upper() for one in cell.held)
    moved = max(norm(one).upper() for one in cell.d)
    least, most_ = (max(getattr(one, end)() for one in cell.sides) for end in ("lower", "upper"))
    # The C takes for wide |normal| >= width x longest side, but for what is off.
    asks_wide, low_size = held_width > 0, size.lower()
    if asks_wide:
        low_size = max(low_size, (wide_by * (least - 2 * moved) - wrong).lower())
    off = (norm(cell.true[0]) + wrong) * (moved + 4 * U * (cell.reach + moved))
    off = (off + cell.moved[0] * cell.reach).upper()
    # The volume where the C finds it high enough; then it has the sign of the true one.
    said = (low_by * (low_size - wrong) - off).lower()
    sign = 1 if volume > 0 else -1 if map_.either and volume < 0 else 0
    reason, high = "", (max(said, abs(volume).lower()) / size.upper()).lower()
    if lowest > 0 and low_size > 0:
        high = max(high, (low_by * (1 - wrong / low_size) - off / low_size).lower())
    known = sign and (not map_.either or said > 0 or sign * volume > off)
    if not (known and high > ball):
        reason = "the facet's height is not known to be above 0"
    down = -sign * normal[2] if sign else ABOUT * most(normal[2])
    # A normal that is off by a small part of its length turns by hardly more than that part.
    share = wrong / low_size if low_size > 0 else INFINITE
    asks_steep, tilt = held_steepest > -1, INFINITE
    if share < 0.1:
        tilt = arb("1.02") * share + 8 * U
    if not (
        steepest <= -1.0
        or down > steepest * size
        or (asks_steep and held_steepest - tilt > steepest)
    ):
        reason = reason or "the facet may be steeper than the recipe's `upright`"
    seen_width = wide_by * (1 - 2 * moved / least) - wrong / least
    if not (width <= 0.0 or size > width * most_ or (asks_wide and seen_width > width)):
        reason = reason or "the facet may be narrower than the recipe's rest_width"
    top = most(volume) if map_.either else volume
    refused = (
        top + off < low_by * (size - wrong)
        or (asks_steep and down < (held_steepest - tilt) * size)
        or (asks_wide and size + wrong < wide_by * (least - 2 * moved))
    )
    return high, sign, bool(refused and not map_.integer), reason


def _turned(cell: _Cell, height: arb, sign: int) -> tuple[arb, arb]:
    """Return the greatest sine of an arc above its stored plane, and the least distance of an axis.

    The sine is infinite where no witness is found; `sign` is that of inward normals.
    """
    # The witness, times that sign.
    down = vector(sign * x.mid() for x in sum(one / norm(one) for one in cell.p))
    length, sine, away, clear = norm(down), ZERO, INFINITE, INFINITE
    for i, j in NEXT:
        true, held, rounded, moved = cell.true[i], cell.held[i], cell.rounded[i], cell.moved[i]
        plane = max(norm(true).lower(), (cell.sides[i] * height).lower())
        least = max((norm(held) - rounded).lower(), (plane - moved).lower())
        # Normals that are not nearly opposite, of a length that singles hold.
        if not (least > SMALLEST and moved < plane and true @ down > 0):
            return INFINITE, ZERO
        # The most of |a Q - b P| for a and b from 0 to what the products allow.
        a, b = (max((sign * one / least).upper(), ZERO) for one in cell.products(i, j))
        x, y = a * norm(cell.p[j]).upper(), b * norm(cell.p[i]).upper()
        both = root(x * x + y * y - 2 * a * b * (cell.p[i] @ cell.p[j]).lower())
        sine = max(sine, (max(x, y, both.upper()) / plane).upper())
        away = min(away, (plane / cell.sides[i].upper()).lower())
        clearance = (held @ down - rounded * length) / ((norm(held) + rounded) * length)
        clear = min(clear, clearance.lower())
    return (sine if clear > sine else INFINITE), away


def _rest(sine: arb, share: arb, ball: arb) -> arb:
    """Return what the rest of a read adds to planes that turn by asin(sine).

    asin turns an error of its argument into one that is larger by one over the cosine.  The
    greatest clearance that is read is no steeper than this allows: a cap within the cone is within
    the directions in which the facet is no further than the reach, of which its height is a share.
    """
    top = root(1 - min(share, ONE) ** 2).upper() + 2 * ball
    highest = min((top + sine + READ).upper(), ONE)
    slope = root(1 - highest * highest).lower()
    # asin never changes by more than sqrt(2 x) over x, times 1 + x.
    rest = ((2 * READ).sqrt() * arb("1.001")).upper()
    rest = min((READ / slope).upper(), rest) if slope > 0 else rest
    rest = max(rest, (min((sine + READ).upper(), ONE).asin() - sine.asin()).upper())
    return rest + ARCSINE + LAST
