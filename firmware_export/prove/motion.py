"""Where a recipe's contacts truly are: sums of products of sines, cosines and travels.

Owns the exact positions.  The links are multiplied out as `contacts.closed` does it for the tables,
but anew and with intervals for coefficients: what is proved must not rest on what is proved
about.  The numbers of the recipe are the doubles that were read from it.
"""

from dataclasses import dataclass

import numpy as np

from firmware_export.prove.intervals import Interval, cosine, sine, stack
from lutgen.parts import Joint, parents_first
from lutgen.recipe import Recipe
from lutgen.vector import Floats

# A factor: ("c" | "s" | "t", parameter, rate): cosine or sine of rate x parameter, or the parameter
# itself.  A monomial is a sorted tuple of them.
Factor = tuple[str, int, float]
Monomial = tuple[Factor, ...]
Sum = dict[Monomial, Interval]


def _plus(one: Sum, other: Sum) -> Sum:
    result = dict(one)
    for monomial, value in other.items():
        result[monomial] = result[monomial] + value if monomial in result else value
    return result


def _times(one: Sum, other: Sum) -> Sum:
    """Multiply matrices (3, 3) by matrices or vectors; zeros are dropped."""
    result: Sum = {}
    for left, a in one.items():
        for right, b in other.items():
            parts = [a[:, j, None] * b[None, j] for j in range(3)]
            if b.low.ndim == 1:
                parts = [a[:, j] * b[j] for j in range(3)]
            value = parts[0] + parts[1] + parts[2]
            if not value.most.max() > 1e-300:
                continue
            for monomial, sign in _reduced(tuple(sorted((*left, *right)))).items():
                result = _plus(result, {monomial: value * sign})
    return result


def _reduced(monomial: Monomial) -> dict[Monomial, float]:
    """Replace squares of sines by 1 - cosines squared."""
    for at, factor in enumerate(monomial[:-1]):
        if factor[0] == "s" and monomial[at + 1] == factor:
            rest = monomial[:at] + monomial[at + 2 :]
            cosines = (("c", *factor[1:]),) * 2
            result = _reduced(rest)
            for one, sign in _reduced(tuple(sorted((*rest, *cosines)))).items():
                result[one] = result.get(one, 0.0) - sign
            return result
    return {monomial: 1.0}


def _axis_turn(axis: Floats, cos_: Interval, sin_: Interval) -> tuple[Interval, Interval, Interval]:
    """Return 1's share, cos's and sin's of a rotation about a unit axis by u + offset."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    along = Interval.of(axis[:, None]) * axis[None, :]
    across = Interval.of(np.eye(3)) - along
    return along, across * cos_ + skew * sin_, skew * cos_ - across * sin_


def _joint_turn(joint: Joint, parameter: int) -> Sum:
    offset = Interval.of(joint.offset)
    axis = np.array(joint.axis)
    along, with_cos, with_sin = _axis_turn(axis, cosine(offset), sine(offset))
    if joint.scale == 0.0:
        return {(): along + with_cos}
    sign = 1.0 if joint.scale > 0.0 else -1.0
    rate = abs(joint.scale)
    return {
        (): along,
        (("c", parameter, rate),): with_cos,
        (("s", parameter, rate),): with_sin * sign,
    }


def _fixed_turn(rpy: tuple[float, float, float]) -> Interval:
    """Return Rz Ry Rx (3, 3)."""
    (cr, cp, cy), (sr, sp, sy) = (
        [wave(Interval.of(angle)) for angle in rpy] for wave in (cosine, sine)
    )
    rows = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return stack([stack(list(row)) for row in rows])


def contacts_of(recipe: Recipe, order: tuple[int, ...]) -> list[Sum]:
    """Return the contacts of these numbers relative to the com, vectors (3,) each."""
    parents, _ = parents_first({link.name: link.parent for link in recipe.links})
    links = {link.name: link for link in recipe.links}
    column = {parameter.name: at for at, parameter in enumerate(recipe.parameters)}
    turn: dict[str, Sum] = {}
    origin: dict[str, Sum] = {}
    moment: Sum = {}
    total = Interval.of(0.0)
    for name in parents:
        link, joint = links[name], links[name].joint
        here: Sum = {(): _fixed_turn(link.rpy)}
        there: Sum = {(): Interval.of(np.array(link.origin))}
        if link.parent is not None:
            there = _plus(origin[link.parent], _times(turn[link.parent], there))
            here = _times(turn[link.parent], here)
        if joint is not None and joint.kind == "revolute":
            here = _times(here, _joint_turn(joint, column[joint.parameter]))
        elif joint is not None:
            axis = Interval.of(np.array(joint.axis))
            travel = ("t", column[joint.parameter], 1.0)
            shift: Sum = {(): axis * joint.offset, (travel,): axis * joint.scale}
            there = _plus(there, _times(here, shift))
        turn[name], origin[name] = here, there
        if link.mass != 0.0:
            centre: Sum = {(): Interval.of(np.array(link.com))}
            share = _plus(there, _times(here, centre))
            moment = _plus(moment, {m: v * link.mass for m, v in share.items()})
            total = total + link.mass
    com: Sum = {}
    if total.low > 0.0:
        inverse = Interval(1.0 / total.high, 1.0 / total.low).widened(1e-16 / total.low)
        com = {m: -(v * inverse) for m, v in moment.items()}
    result = []
    for at in order:
        contact = recipe.contacts[at]
        place: Sum = {(): Interval.of(np.array(contact.position))}
        there = _plus(origin[contact.link], _times(turn[contact.link], place))
        result.append(_plus(there, com))
    return result


@dataclass(frozen=True, eq=False)
class Waves:
    """Sines, cosines and travels over cells of postures, each computed once.

    `box` holds the parameters, intervals (k, n).
    """

    box: Interval
    known: dict[Factor, Interval]

    @classmethod
    def over(cls, box: Interval) -> "Waves":
        """Return what is known of cells: nothing yet."""
        return cls(box, {})

    def factor(self, factor: Factor) -> Interval:
        """Return a factor over the cells (n,)."""
        if factor not in self.known:
            kind, parameter, rate = factor
            x = self.box[parameter]
            if kind != "t":
                x = (cosine if kind == "c" else sine)(x * rate)
            self.known[factor] = x
        return self.known[factor]

    def monomial(self, monomial: Monomial) -> Interval:
        """Return a product of factors over the cells (n,)."""
        result = Interval.of(np.ones(self.box.low.shape[1]))
        for factor in monomial:
            result = result * self.factor(factor)
        return result

    def value(self, positions: Sum) -> Interval:
        """Return a vector (3, n) over the cells."""
        zero = np.zeros((3, self.box.low.shape[1]))
        result = Interval.of(zero)
        for monomial, weight in positions.items():
            result = result + weight[:, None] * self.monomial(monomial)[None, :]
        return result

    def slope(self, positions: Sum, parameter: int) -> Interval:
        """Return the derivative (3, n) along a parameter over the cells."""
        result = Interval.of(np.zeros((3, self.box.low.shape[1])))
        for monomial, weight in positions.items():
            for at, (kind, own, rate) in enumerate(monomial):
                if own != parameter:
                    continue
                rest = monomial[:at] + monomial[at + 1 :]
                turned = {"c": "s", "s": "c"}.get(kind)
                part = self.monomial(rest if turned is None else (*rest, (turned, own, rate)))
                sign = {"c": -rate, "s": rate, "t": 1.0}[kind]
                result = result + (weight * sign)[:, None] * part[None, :]
        return result
