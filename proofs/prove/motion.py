"""Where the contacts of a recipe truly are: polynomials of sines, cosines and travels.

The links are multiplied out anew with balls for coefficients: what is proved must not rest on
what it is proved about.  The numbers of the recipe are the doubles that were read from it.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from flint import arb

from lutgen.parts import Joint
from lutgen.recipe import Recipe
from proofs.prove.balls import ONE, ZERO, Jet, vector

# A factor: ("c" | "s" | "t", parameter, rate): cosine or sine of rate times parameter, or the
# parameter itself.  A monomial is a sorted tuple of them.
Factor = tuple[str, int, float]
Monomial = tuple[Factor, ...]


class Polynomial(dict[Monomial, arb]):
    """A coefficient for each monomial."""

    def __add__(self, other: "Polynomial") -> "Polynomial":
        return Polynomial({m: self.get(m, ZERO) + other.get(m, ZERO) for m in {**self, **other}})

    def __sub__(self, other: "Polynomial") -> "Polynomial":
        return self + Polynomial({m: -x for m, x in other.items()})

    def __mul__(self, other: "Polynomial") -> "Polynomial":
        out = Polynomial()
        for a, x in self.items():
            for b, y in other.items():
                for monomial, z in reduced(tuple(sorted(a + b))).items():
                    out[monomial] = out.get(monomial, ZERO) + x * y * z
        return out


def reduced(factors: Monomial) -> Polynomial:
    """Write a product of factors with no square of a sine: s s = 1 - c c."""
    for one in factors:
        if one[0] == "s" and factors.count(one) > 1:
            rest = list(factors)
            rest.remove(one)
            rest.remove(one)
            squared = tuple(sorted([*rest, *[("c", *one[1:])] * 2]))
            return reduced(tuple(rest)) - reduced(squared)
    return Polynomial({factors: ONE})


def still(numbers: Any) -> Any:
    """Return numbers as an array of polynomials."""
    return np.vectorize(lambda x: Polynomial({(): arb(float(x))}), otypes=[object])(numbers)


def turn(axis: Any, cosine: Polynomial, sine: Polynomial) -> Any:
    """Return the rotation about a unit axis by an angle of this cosine and sine (Rodrigues)."""
    x, y, z = axis
    along = np.outer(still(axis), still(axis))
    skew = still([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return along + (still(np.eye(3)) - along) * cosine + skew * sine


def _fixed(axis: Any, angle: float) -> Any:
    """Return the rotation by an angle that does not move."""
    return turn(axis, Polynomial({(): arb(angle).cos()}), Polynomial({(): arb(angle).sin()}))


def _joint_turn(joint: Joint, parameter: int) -> Any:
    """Return the rotation of a revolute joint: by scale times parameter + offset."""
    rate, sign = abs(joint.scale), 1 if joint.scale > 0.0 else -1
    if not rate:
        return _fixed(joint.axis, joint.offset)
    c, s = arb(joint.offset).cos(), arb(joint.offset).sin()
    cosine, sine = (("c", parameter, rate),), (("s", parameter, rate),)
    return turn(
        joint.axis,
        Polynomial({cosine: c, sine: -sign * s}),
        Polynomial({cosine: s, sine: sign * c}),
    )


def contacts_of(recipe: Recipe, order: Sequence[int]) -> list[Polynomial]:
    """Return x, y, z of the contacts of these numbers, one after the other, from the com."""
    column = {parameter.name: at for at, parameter in enumerate(recipe.parameters)}
    found: dict[str | None, Any] = {None: (still(np.eye(3)), still(np.zeros(3)))}
    total, moment = ZERO, still(np.zeros(3))
    waiting = list(recipe.links)
    while waiting:
        link = waiting.pop(0)
        if link.parent not in found:
            waiting.append(link)
            continue
        rotation, place = found[link.parent]
        place = place + rotation @ still(link.origin)
        for axis, angle in zip(np.eye(3)[::-1], link.rpy[::-1], strict=True):
            rotation = rotation @ _fixed(axis, angle)
        joint = link.joint
        if joint is not None and joint.kind == "revolute":
            rotation = rotation @ _joint_turn(joint, column[joint.parameter])
        elif joint is not None:
            travel = (("t", column[joint.parameter], 1.0),)
            way = Polynomial({(): arb(joint.offset), travel: arb(joint.scale)})
            place = place + rotation @ still(joint.axis) * way
        found[link.name] = rotation, place
        total += arb(link.mass)
        centre = place + rotation @ still(link.com)
        moment = moment + centre * Polynomial({(): arb(link.mass)})
    com = moment * Polynomial({(): 1 / total if total > 0 else ZERO})
    result: list[Polynomial] = []
    for at in order:
        rotation, place = found[recipe.contacts[at].link]
        result += list(place + rotation @ still(recipe.contacts[at].position) - com)
    return result


class Postures:
    """A cell of postures: its box (low, high), every factor and monomial over it computed once."""

    def __init__(self, box: Sequence[tuple[float, float]]) -> None:
        self.box = box
        self.middle = [(arb(low) + arb(high)) / 2 for low, high in box]
        self.whole = [arb(low).union(arb(high)) for low, high in box]
        self.half = vector(((arb(high) - arb(low)) / 2).upper() for low, high in box)
        self._known: dict[Monomial, Jet] = {(): self.constant(ONE)}

    def constant(self, value: arb) -> Jet:
        """Return a number as a function."""
        return Jet(value, value, vector([ZERO] * len(self.middle)))

    def linear(self, at: int, begin: arb, rate: arb) -> Jet:
        """Return (parameter - begin) rate."""
        slopes = vector(rate if at == axis else ZERO for axis in range(len(self.middle)))
        return Jet((self.middle[at] - begin) * rate, (self.whole[at] - begin) * rate, slopes)

    def _factor(self, factor: Factor) -> Jet:
        kind, at, rate = factor
        x = self.linear(at, ZERO, arb(rate))
        if kind == "c":
            return Jet(x.middle.cos(), x.whole.cos(), x.slopes * -x.whole.sin())
        if kind == "s":
            return Jet(x.middle.sin(), x.whole.sin(), x.slopes * x.whole.cos())
        return x

    def _monomial(self, monomial: Monomial) -> Jet:
        if monomial not in self._known:
            self._known[monomial] = self._monomial(monomial[:-1]) * self._factor(monomial[-1])
        return self._known[monomial]

    def values(self, polynomials: Sequence[Polynomial]) -> Any:
        """Return polynomials as functions over the cell."""
        return vector(
            sum((self._monomial(m).scaled(x) for m, x in one.items()), self.constant(ZERO))
            for one in polynomials
        )
