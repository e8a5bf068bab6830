"""Where contacts are: sums of products of sines, cosines and travels, for any tree of joints.

The links of a recipe are multiplied out once, so that the runtime only adds up terms.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from lutgen.errors import InputError
from lutgen.parts import Joint, parents_first
from lutgen.recipe import Recipe, swung_links
from lutgen.vector import Floats, Vector, axis_rotation, rotation

# A factor: ("c" | "s", parameter, rate) is the cosine or sine of rate x parameter, ("t", parameter,
# 1.0) the parameter itself.  A monomial is a sorted tuple of factors; () is 1.
Factor = tuple[str, int, float]
Monomial = tuple[Factor, ...]
# Coefficients smaller than this part of the largest are rounding of the multiplication.
NEGLIGIBLE = 1e-13
MOST_TERMS = 4000


@dataclass(frozen=True, eq=False)
class Sum:
    """A polynomial in factors whose coefficients are arrays of one shape."""

    terms: dict[Monomial, Floats]

    @classmethod
    def constant(cls, value: Floats) -> "Sum":
        """Return what does not move."""
        return cls({(): np.asarray(value, np.float64)})

    def __add__(self, other: "Sum") -> "Sum":
        terms = dict(self.terms)
        for monomial, value in other.terms.items():
            terms[monomial] = terms[monomial] + value if monomial in terms else value
        return Sum(terms)

    def scaled(self, factor: float) -> "Sum":
        """Return a multiple."""
        return Sum({monomial: factor * value for monomial, value in self.terms.items()})

    def __matmul__(self, other: "Sum") -> "Sum":
        """Return the product of matrices, or of a matrix and a vector."""
        terms: dict[Monomial, Floats] = {}
        for left, a in self.terms.items():
            for right, b in other.terms.items():
                value = a @ b
                for monomial, sign in _product(left, right).items():
                    terms[monomial] = terms.get(monomial, 0.0) + sign * value
        size = max(float(np.abs(value).max()) for value in terms.values())
        kept = {m: v for m, v in terms.items() if np.abs(v).max() > NEGLIGIBLE * size or m == ()}
        if len(kept) > MOST_TERMS:
            raise InputError(f"its positions have more than {MOST_TERMS} terms; use --codec grid")
        return Sum(kept)


def _product(left: Monomial, right: Monomial) -> dict[Monomial, float]:
    """Multiply two monomials; of the square of a sine only cosines are left."""
    factors = sorted((*left, *right))
    for at in range(len(factors) - 1):
        factor = factors[at]
        if factor[0] == "s" and factors[at + 1] == factor:
            rest = tuple(factors[:at] + factors[at + 2 :])
            cosine = ("c", factor[1], factor[2])
            result = dict(_product(rest, ()))
            for monomial, sign in _product(rest, (cosine, cosine)).items():
                result[monomial] = result.get(monomial, 0.0) - sign
            return result
    return {tuple(factors): 1.0}


def _turn(joint: Joint, parameter: int) -> Sum:
    """Return the rotation of a revolute joint: A + B cos + C sin of its angle (Rodrigues)."""
    x, y, z = joint.axis
    axis = np.array(joint.axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    along = np.outer(axis, axis)
    rate, sign = abs(joint.scale), math.copysign(1.0, joint.scale)
    c, s = math.cos(joint.offset), math.sin(joint.offset)
    # cos(sign u + o) = cos u cos o - sign sin u sin o, and the sine likewise.
    across = np.eye(3) - along
    return Sum(
        {
            (): along,
            (("c", parameter, rate),): c * across + s * cross,
            (("s", parameter, rate),): sign * (c * cross - s * across),
        }
    )


@dataclass(frozen=True, eq=False)
class Closed:
    """A robot's positions in closed form, in the recipe's frame.

    `centres`, `axes`: a (3,) polynomial for each contact; the axes of discs, None for
    others.  Behind them for each axle that swings its pivot and line, and its com.  `com`: that of
    the whole robot; `shares` of the mass that the axles have.
    """

    centres: tuple[Sum, ...]
    axes: tuple[Sum | None, ...]
    com: Sum
    shares: tuple[float, ...]


@lru_cache(maxsize=4)
def closed_form(recipe: Recipe) -> Closed:
    """Multiply out the links of a recipe; refuse a robot given by code, or with too many terms."""
    if recipe.python is not None:
        raise InputError("the robot is given by code, whose closed form is not known")
    order, _ = parents_first({link.name: link.parent for link in recipe.links})
    links = {link.name: link for link in recipe.links}
    column = {parameter.name: at for at, parameter in enumerate(recipe.parameters)}
    turn: dict[str, Sum] = {}
    origin: dict[str, Sum] = {}
    total = sum(link.mass for link in recipe.links)
    com = Sum.constant(np.array(recipe.com_offset))
    for name in order:
        link, joint = links[name], links[name].joint
        here = Sum.constant(rotation(link.rpy))
        there = Sum.constant(np.array(link.origin))
        if link.parent is not None:
            here = turn[link.parent] @ here
            there = origin[link.parent] + turn[link.parent] @ there
        if joint is not None and joint.kind == "revolute" and joint.scale != 0.0:
            here = here @ _turn(joint, column[joint.parameter])
        elif joint is not None and joint.kind == "revolute":
            here = here @ Sum.constant(axis_rotation(joint.axis, joint.offset))
        elif joint is not None:
            travel = ("t", column[joint.parameter], 1.0)
            axis = np.array(joint.axis)
            there = there + here @ Sum({(): joint.offset * axis, (travel,): joint.scale * axis})
        turn[name], origin[name] = here, there
        if total > 0.0 and link.mass != 0.0:
            share = there + here @ Sum.constant(np.array(link.com))
            com = com + share.scaled(link.mass / total)
    centres: list[Sum] = []
    axes: list[Sum | None] = []
    shares: list[float] = []

    def place(link: str, position: Vector, axis: Vector | None) -> None:
        centres.append(origin[link] + turn[link] @ Sum.constant(np.array(position)))
        axes.append(None if axis is None else turn[link] @ Sum.constant(np.array(axis)))

    for contact in recipe.contacts:
        place(contact.link, contact.position, contact.axis)
    for axle, swung in zip(recipe.axles, swung_links(recipe), strict=True):
        place(axle.link, axle.pivot, axle.axis)
        mass = sum(link.mass for link in swung)
        middle = Sum({}) if mass else centres[-1]
        for link in swung:
            own = origin[link.name] + turn[link.name] @ Sum.constant(np.array(link.com))
            middle = middle + own.scaled(link.mass / (mass or 1.0))
        centres.append(middle)
        axes.append(None)
        shares.append(mass / (total or 1.0))
    return Closed(tuple(centres), tuple(axes), com, tuple(shares))
