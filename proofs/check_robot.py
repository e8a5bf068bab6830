"""What a proof is checked with: where a robot's contacts are, and what a map's bytes say of them.

Part of `check_proof`, and like it shares no code with lutgen.  Positions are polynomials in sines,
cosines and travels whose coefficients are balls of Arb.
"""

import struct
from collections.abc import Sequence
from typing import Any

from flint import arb, ctx

ctx.prec = 80
U = arb(2) ** -24  # half a unit of single precision
# Largest errors of sines and cosines, of all floats: proofs/exhaustive.c.
SINE_NEAR, SINE = arb("8.4e-8"), arb("9.4e-8")


def plus(p: dict[Any, Any], q: dict[Any, Any], sign: int = 1) -> dict[Any, Any]:
    """Add polynomials: monomial (sorted factors) -> coefficient."""
    return {m: p.get(m, arb(0)) + sign * q.get(m, arb(0)) for m in {**p, **q}}


def monomials(factors: tuple[Any, ...]) -> dict[Any, Any]:
    """Write a product of factors with no square of a sine: s s = 1 - c c."""
    for f in factors:
        if f[0] == "s" and factors.count(f) > 1:
            rest = list(factors)
            rest.remove(f)
            rest.remove(f)
            c = ("c", *f[1:])
            return plus(monomials(tuple(rest)), monomials(tuple(sorted([*rest, c, c]))), -1)
    return {factors: arb(1)}


def times(p: dict[Any, Any], q: dict[Any, Any]) -> dict[Any, Any]:
    """Multiply polynomials."""
    out: dict[Any, Any] = {}
    for a, x in p.items():
        for b, y in q.items():
            out = plus(out, {m: x * y * z for m, z in monomials(tuple(sorted(a + b))).items()})
    return out


def apply(rows: list[Any], v: list[Any]) -> list[Any]:
    """Multiply a matrix by a vector of polynomials."""
    return [plus(plus(times(r[0], v[0]), times(r[1], v[1])), times(r[2], v[2])) for r in rows]


def matmul(a: list[Any], b: list[Any]) -> list[Any]:
    """Multiply matrices of polynomials."""
    columns = [apply(a, [row[j] for row in b]) for j in range(3)]
    return [[columns[j][i] for j in range(3)] for i in range(3)]


def still(numbers: Sequence[Any]) -> list[Any]:
    """Return numbers as polynomials."""
    return [{(): arb(x)} for x in numbers]


def turn(axis: Sequence[Any], c: dict[Any, Any], s: dict[Any, Any]) -> list[Any]:
    """Return the rotation about a unit axis by an angle of this cosine and sine (Rodrigues)."""
    x, y, z = map(arb, axis)
    skew = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    a = (x, y, z)
    out = []
    for i in range(3):
        row = []
        for j in range(3):
            along, one = a[i] * a[j], int(i == j)
            cosine = {m: v * (one - along) for m, v in c.items()}
            sine = {m: v * skew[i][j] for m, v in s.items()}
            row.append(plus(plus({(): along}, cosine), sine))
        out.append(row)
    return out


def positions(proof: dict[Any, Any]) -> list[Any]:
    """Return the contacts relative to the centre of mass: three polynomials each."""
    rotation: dict[str, Any] = {}
    place: dict[str, Any] = {}
    total, moment = arb(0), still([0, 0, 0])
    waiting = list(proof["links"])
    while waiting:
        link = waiting.pop(0)
        if link["parent"] is not None and link["parent"] not in rotation:
            waiting.append(link)
            continue
        r, p = [still(row) for row in ((1, 0, 0), (0, 1, 0), (0, 0, 1))], still([0, 0, 0])
        if link["parent"] is not None:
            r, p = rotation[link["parent"]], place[link["parent"]]
        p = [plus(a, b) for a, b in zip(p, apply(r, still(link["origin"])), strict=True)]
        for axis, angle in zip(((0, 0, 1), (0, 1, 0), (1, 0, 0)), link["rpy"][::-1], strict=True):
            r = matmul(r, turn(axis, {(): arb(angle).cos()}, {(): arb(angle).sin()}))
        joint = link["joint"]
        if joint and joint["kind"] == "revolute":
            c, s = arb(joint["offset"]).cos(), arb(joint["offset"]).sin()
            k, rate = joint["parameter"], abs(joint["scale"])
            sign = 1 if joint["scale"] > 0 else -1
            fc, fs = (("c", k, rate),), (("s", k, rate),)
            both = ({fc: c, fs: -sign * s}, {fc: s, fs: sign * c}) if rate else ({(): c}, {(): s})
            r = matmul(r, turn(joint["axis"], *both))
        elif joint:
            way = {(): arb(joint["offset"]), (("t", joint["parameter"], 1.0),): arb(joint["scale"])}
            p = [
                plus(a, times(way, b))
                for a, b in zip(p, apply(r, still(joint["axis"])), strict=True)
            ]
        rotation[link["name"]], place[link["name"]] = r, p
        total += arb(link["mass"])
        centre = [plus(a, b) for a, b in zip(p, apply(r, still(link["com"])), strict=True)]
        moment = [
            plus(a, times(b, {(): arb(link["mass"])})) for a, b in zip(moment, centre, strict=True)
        ]
    com = [times(m, {(): -1 / total}) for m in moment] if total > 0 else still([0, 0, 0])
    out = []
    for one in proof["contacts"]:
        far = apply(rotation[one["link"]], still(one["position"]))
        out.append(
            [plus(plus(a, b), c) for a, b, c in zip(place[one["link"]], far, com, strict=True)]
        )
    return out


class Map:
    """What the bytes of a map say of three contacts, and how far single precision is off."""

    def __init__(self, blob: bytes, factors: set[Any]) -> None:
        if blob[9] != 1:
            raise SystemExit(
                "not checked: its positions are not in closed form (polynomials or tables)"
            )
        self.guard, _, self.guard_i = struct.unpack_from("<ffH", blob, 20)
        axes = [struct.unpack_from("<fff", blob, 32 + 14 * i) for i in range(blob[10])]
        at = 32 + 14 * blob[10]
        angles, travels, products, discs, terms, flags, code = struct.unpack_from(
            "<4BH2B", blob, at
        )
        self.limits = struct.unpack_from("<3f", blob, at + 8)
        if discs or flags & 0b10100 or any(low > high or slack < 0 for low, high, slack in axes):
            raise SystemExit(
                "not checked: round contacts, joints that turn round, or a robot by code"
            )
        self.order, self.either = [code >> 2 * i & 3 for i in range(3)], bool(code & 128)
        at += 22
        weights = struct.unpack_from(f"<{terms}f", blob, at)
        at += 4 * terms
        rates = struct.unpack_from(f"<{angles}f", blob, at) if flags & 2 else [1.0] * angles
        rest = list(blob[at + (4 * angles if flags & 2 else 0) :])
        reach = [max(abs(low), abs(high)) + slack for low, high, slack in axes]
        hair = [8 * U * r for r in reach]
        lag = [
            4 * U * (high - low) + 2 * U * r for (low, high, _), r in zip(axes, reach, strict=True)
        ]
        self.box = [
            (arb(low) - s - e, arb(high) + s + e)
            for (low, high, s), e in zip(axes, hair, strict=True)
        ]
        entries: list[tuple[Any, ...]] = [((), arb(1), arb(0))]  # monomial, size, error
        for k, rate in zip(rest[:angles], rates, strict=True):
            near = [
                f[2]
                for f in factors
                if f[0] != "t" and f[1] == k and abs(f[2] - rate) < 1e-6 * rate
            ]
            own = near[0] if near else rate
            limit = arb("1.0501") if flags & 8 else arb(16)
            if not arb(own) * (arb(reach[k]) + hair[k]) < limit:
                raise SystemExit("not checked: an angle is further than sines were tried")
            off = (
                (SINE_NEAR if flags & 8 else SINE)
                + own * lag[k]
                + abs(arb(own) - arb(rate)) * reach[k]
                + (U * own * reach[k] if rate != 1 else 0)
            )
            entries += [((("s", k, own),), arb(1), off), ((("c", k, own),), arb(1), off)]
        entries += [
            ((("t", k, 1.0),), arb(reach[k]), lag[k]) for k in rest[angles : angles + travels]
        ]
        rest = rest[angles + travels :]
        for i in range(products):
            (m, x, a), (n, y, b) = entries[rest[2 * i]], entries[rest[2 * i + 1]]
            off = x * b + a * y + a * b
            entries.append((tuple(sorted(m + n)), x * y, off + U * (x * y + off)))
        count = 12 if flags & 1 else 9
        counts, which = (
            rest[2 * products :][:count],
            iter(zip(weights, rest[2 * products + count :], strict=True)),
        )
        sums, errors = [], []
        for terms in counts:
            total: dict[Any, Any] = {}
            size = error = arb(0)
            for term in range(terms):
                w, e = next(which)
                m, x, a = entries[e]
                total = plus(total, {m: arb(w)})
                size, error = size + abs(w) * x, error + abs(w) * (a + U * (x + a))
                error += U * (size + error) if term else 0
            sums.append(total)
            errors.append((size, error))
        if count == 12:
            errors = [
                (x + y, a + b + U * (x + y + a + b))
                for (x, a), (y, b) in ((errors[3 + i], errors[i % 3]) for i in range(9))
            ]
            sums = [plus(sums[3 + i], sums[i % 3]) for i in range(9)]
        self.sums, self.errors = sums, [e + arb(10) ** -40 for _, e in errors]
