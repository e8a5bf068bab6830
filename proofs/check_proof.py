"""Check NAME_proof.json of `lutgen prove` in ball arithmetic: python -m proofs.check_proof DIR.

Shares no code with lutgen.  Taken from the proof: the robot's links, how the box of parameters is
cut into cells, and the claim.  Taken from NAME.c: the bytes of the map.  Positions, their errors
and the bound of every cell are computed anew with Arb; a cell that does not show enough is halved.
It knows maps whose positions are in closed form; exits 0 where the guard is enough, 1 where not.
The argument is told in docs/guide/prove.md.
"""

import hashlib
import itertools
import json
import re
import sys
from pathlib import Path
from typing import Any

from flint import arb

from proofs.check_robot import Map, U, plus, positions

ARCSINE = arb("1.7e-7")  # of all floats, see proofs/exhaustive.c
DEPTH = 12  # how often a cell of the proof may be halved once more
NEXT = ((0, 1), (1, 2), (2, 0))


class Fn:
    """A function over a cell: in its middle, over all of it, and its derivatives over all of it."""

    __slots__ = ("g", "m", "v")

    def __init__(self, m: Any, v: Any, g: list[Any]) -> None:
        self.m, self.v, self.g = m, v, g

    def __add__(self, o: "Fn") -> "Fn":
        return Fn(self.m + o.m, self.v + o.v, [a + b for a, b in zip(self.g, o.g, strict=True)])

    def __sub__(self, o: "Fn") -> "Fn":
        return Fn(self.m - o.m, self.v - o.v, [a - b for a, b in zip(self.g, o.g, strict=True)])

    def __mul__(self, o: "Fn") -> "Fn":
        g = [a * o.v + self.v * b for a, b in zip(self.g, o.g, strict=True)]
        return Fn(self.m * o.m, self.v * o.v, g)

    def over(self, way: list[Any]) -> Any:
        """Return its range: the mean value form, and what came directly."""
        moved = self.m
        for a, w in zip(self.g, way, strict=True):
            moved = moved + a * w
        return moved.intersection(self.v)


def cells_of(poly_list: list[Any], box: list[Any]) -> list[Any]:
    """Return polynomials as functions over a cell; `box`: (low, high) of each parameter."""
    k = len(box)
    middle = [(low + high) / 2 for low, high in box]
    whole = [low.union(high) for low, high in box]
    known: dict[Any, Any] = {(): Fn(arb(1), arb(1), [arb(0)] * k)}

    def factor(f: tuple[Any, ...]) -> Fn:
        kind, at, rate = f
        m, v = middle[at] * rate, whole[at] * rate
        g = [arb(0)] * k
        if kind == "t":
            g[at] = arb(1)
            return Fn(m, v, g)
        g[at] = rate * (v.cos() if kind == "s" else -v.sin())
        return Fn(m.cos(), v.cos(), g) if kind == "c" else Fn(m.sin(), v.sin(), g)

    def monomial(m: tuple[Any, ...]) -> Fn:
        if m not in known:
            known[m] = monomial(m[:-1]) * factor(m[-1])
        one: Fn = known[m]
        return one

    out = []
    for poly in poly_list:
        total = Fn(arb(0), arb(0), [arb(0)] * k)
        for m, x in poly.items():
            one = monomial(m)
            total = total + Fn(x * one.m, x * one.v, [x * g for g in one.g])
        out.append(total)
    return out


def cross(a: list[Any], b: list[Any]) -> list[Any]:
    """Return a vector product."""
    return [a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def dot(a: list[Any], b: list[Any]) -> Any:
    """Return a scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm(a: list[Any]) -> Any:
    """Return a length: no less than 0, whatever the balls say."""
    square = dot(a, a)
    low = max(square.lower(), arb(0))
    return low.sqrt().union(square.upper().sqrt())


def most(x: Any) -> Any:
    """Return the largest absolute value."""
    return abs(x).upper()


def turned(
    truth: list[Any], off: list[Any], errors: list[Any], way: list[Any], height: Any
) -> tuple[Any, ...]:
    """Return the greatest sine of a plane's turn, and the least distance of an axis.

    `truth` and `off`: nine functions each, the true contacts and what the stored ones are off;
    `height`: what the facet is below the centre of mass at least.
    """
    p = [[f.over(way) for f in truth[3 * i : 3 * i + 3]] for i in range(3)]
    d = [
        [
            f.over(way) + (arb(0) if e is None else arb(0, 1) * e)
            for f, e in zip(off[3 * i : 3 * i + 3], errors[3 * i : 3 * i + 3], strict=True)
        ]
        for i in range(3)
    ]
    r = [norm(errors[3 * i : 3 * i + 3]).upper() for i in range(3)]
    seen = [[a + b for a, b in zip(x, y, strict=True)] for x, y in zip(p, d, strict=True)]
    witness = [
        sum(
            (x.mid() / norm([y.mid() for y in q]).mid() for q, x in ((q, q[c]) for q in p)), arb(0)
        ).mid()
        for c in range(3)
    ]
    arc = whole = arb(0)
    near, shown, clear = arb("inf"), True, arb("inf")
    for i, j in NEXT:
        true, held = cross(p[i], p[j]), cross(seen[i], seen[j])
        rounded = (
            arb("2.01")
            * U
            * norm(
                [
                    most(seen[i][a]) * most(seen[j][b]) + most(seen[i][b]) * most(seen[j][a])
                    for a, b in ((1, 2), (2, 0), (0, 1))
                ]
            ).upper()
        )
        side = norm([a - b for a, b in zip(p[i], p[j], strict=True)])
        plane = max(norm(true).lower(), (side * height).lower())
        moved = (
            norm([a + b for a, b in zip(cross(p[i], d[j]), cross(d[i], seen[j]), strict=True)])
            + rounded
        )
        least = max((norm(held) - rounded).lower(), (plane - moved).lower())
        if not (least > 1e-14 and moved < plane):
            return arb("inf"), arb(0)
        q = [
            [t + o for t, o in zip(truth[3 * n : 3 * n + 3], off[3 * n : 3 * n + 3], strict=True)]
            for n in (i, j)
        ]
        ends = []
        for at in (i, j):
            own = off[3 * at : 3 * at + 3]
            real = [f.over(way) for f in own]
            normal = cross(q[0], q[1])
            wide = [f.over(way) for f in normal]
            far, close = (norm([f.over(way) for f in x]).upper() for x in q)
            extra = (far * r[j] + close * r[i] + r[i] * r[j]) * (norm(real) + r[at])
            extra += sum(
                (most(a) * e for a, e in zip(wide, errors[3 * at : 3 * at + 3], strict=True)),
                arb(0),
            )
            extra += rounded * norm(p[at])
            ends.append((-dot(normal, own).over(way) + arb(0, 1) * extra.upper()) / least)
        a, b, between = ends[0], ends[1], dot(p[i], p[j])
        turns = []
        for x, y, along in (
            (max(a.upper(), arb(0)), max(b.upper(), arb(0)), -between.lower()),
            (most(a), most(b), most(between)),
        ):
            x, y = x * norm(p[j]).upper(), y * norm(p[i]).upper()
            both = x * x + y * y + 2 * (x / norm(p[j]).upper()) * (y / norm(p[i]).upper()) * along
            turns.append(
                max(x.upper(), y.upper(), max(both.upper(), arb(0)).sqrt().upper()) / plane
            )
        arc, whole = max(arc, turns[0].upper()), max(whole, turns[1].upper())
        near = min(near, (plane / side.upper()).lower())
        shown = shown and bool(dot(true, witness) > 0)
        clear = min(
            clear,
            (
                (dot(held, witness) - rounded * norm(witness))
                / ((norm(held) + rounded) * norm(witness))
            ).lower(),
        )
    return (min(arc, whole) if shown and clear > arc else whole), near


def facet(p: list[Any], d: list[Any], rules: dict[Any, Any], held: Map) -> tuple[Any, ...]:
    """Return whether what is answered as standing stands, height, reach and edge normals."""
    edges = [cross(p[i], p[j]) for i, j in NEXT]
    normal = [sum((e[c] for e in edges), arb(0)) for c in range(3)]
    reach = max(norm(x).upper() for x in p)
    sides = [norm([a - b for a, b in zip(p[i], p[j], strict=True)]) for i, j in NEXT]
    moved = max(norm(x).upper() for x in d)
    lowest, steepest, width = map(arb, held.limits)
    wrong = 24 * U * reach * (reach + moved)
    for i, j in NEXT:
        seen = [a + b for a, b in zip(p[j], d[j], strict=True)]
        wrong += norm(
            [a + b for a, b in zip(cross(p[i], d[j]), cross(d[i], seen), strict=True)]
        ).upper()
    size, volume = norm(normal), dot(edges[0], p[2])
    low = size.lower()
    longest = max(s.lower() for s in sides)
    if held.limits[2] > 0:
        low = max(low, (width * (1 - 16 * U) * (longest - 2 * moved) - wrong).lower())
    off = wrong * reach + (norm(edges[0]) + wrong) * (moved + 4 * U * reach)
    said = (lowest * (1 - 8 * U) * (1 - wrong / low) - off / low).lower() if low > 0 else arb(-1)
    sure = bool(volume > off) or (held.either and bool(volume < -off))
    height = max(said, (abs(volume).lower() / size.upper()).lower() if sure else arb(-1))
    sign = 1 if volume > off else -1 if volume < -off else 0
    tilt = arb("1.02") * wrong / low + 8 * U if low > 0 and wrong / low < 0.1 else arb("inf")
    upright = (
        rules["steepest"] <= -1
        or bool(sign and -sign * normal[2] > rules["steepest"] * size)
        or (held.limits[1] > -1 and bool(steepest - tilt > rules["steepest"]))
    )
    wide = (
        rules["width"] <= 0
        or bool(size > rules["width"] * max(s.upper() for s in sides))
        or (
            held.limits[2] > 0
            and bool(
                width * (1 - 16 * U) * (1 - 2 * moved / longest) - wrong / longest > rules["width"]
            )
        )
    )
    return bool(height > rules["ball"]) and upright and wide, height, reach, edges


def refused(p: list[Any], held: Map) -> bool:
    """Whether nothing is answered of a cell: a facet the wrong way round, too low or too steep."""
    edges = [cross(p[i], p[j]) for i, j in NEXT]
    volume, reach = dot(edges[0], p[2]), max(norm(x).upper() for x in p)
    normal = [sum((e[c] for e in edges), arb(0)) for c in range(3)]
    size, hair = norm(normal), arb("1e-3") * reach**3
    if (abs(volume) if held.either else volume) + hair < arb(held.limits[0]) * size:
        return True
    sign = -1 if volume > hair else 1 if volume < -hair else 0
    down = sign * normal[2] if sign else abs(normal[2])
    return held.limits[1] > -1 and bool(down < arb(held.limits[1] - 1e-3) * size)


def need(truth: list[Any], off: list[Any], held: Map, rules: dict[Any, Any], box: list[Any]) -> Any:
    """Return the guard (rad) that a cell needs and the planes' turn; infinite where unknown."""
    fs = cells_of([*truth, *off], box)
    way = [arb(0, 1) * ((high - low) / 2).upper() for low, high in box]
    p = [[f.over(way) for f in fs[3 * i : 3 * i + 3]] for i in range(3)]
    d = [
        [
            f.over(way) + arb(0, 1) * e.upper()
            for f, e in zip(fs[9 + 3 * i : 12 + 3 * i], held.errors[3 * i : 3 * i + 3], strict=True)
        ]
        for i in range(3)
    ]
    stands, height, reach, edges = facet(p, d, rules, held)
    if not stands:
        return (arb(0), arb(0)) if refused(p, held) else (arb("inf"), arb("inf"))
    sine, near = turned(fs[:9], fs[9:], held.errors, way, height)
    ball = arb(rules["ball"])
    if not sine < 1 or not near > ball:
        return arb("inf"), arb("inf")
    ball = (ball / near).asin()
    lengths, mean = [norm(e) for e in edges], arb(3)
    for i, j in NEXT:
        product = dot(edges[i], edges[j]).upper()
        size = (
            (lengths[i] * lengths[j]).lower() if product > 0 else (lengths[i] * lengths[j]).upper()
        )
        mean += 2 * min((product / size).upper(), arb(1)) if size > 0 else 2
    share = min((height / reach).lower(), arb(1))
    top = min(max(mean.upper(), arb(0)).sqrt().upper() / 3, (1 - share * share).sqrt().upper())
    read = 16 * U
    high = min((top + 2 * ball + sine + read).upper(), arb(1))
    slope = max((1 - high * high).lower(), arb(0)).sqrt().lower()
    rest = (2 * read).sqrt() * arb("1.001")
    rest = min((read / slope).upper(), rest.upper()) if slope > 0 else rest
    turn_ = sine.asin()
    rest = max(rest, (min((sine + read).upper(), arb(1)).asin() - turn_).upper())
    return turn_ + rest + ARCSINE + 2 * U * arb.pi() / 2 + ball, turn_ + ball


def main(folder: Path) -> int:
    """Check the proof in a folder; 0 where it holds, 1 where not."""
    (path,) = folder.glob("*_proof.json")
    proof = json.loads(path.read_text(encoding="utf-8"))
    source = (folder / f"{proof['name']}.c").read_bytes()
    if hashlib.sha256(source).hexdigest() != proof["source_sha256"]:
        print(f"NOT proved: {proof['name']}.c is not the file that the proof is about")
        return 1
    text = re.sub(r"/\*.*?\*/", "", source.decode(), flags=re.S)
    numbers = re.search(r"smap_blob\[\d+\] = \{(.*?)\}", text, re.S)
    assert numbers
    blob = bytes(int(x) for x in numbers[1].replace("\n", "").split(",") if x.strip())
    every = positions(proof)
    held = Map(blob, {f for one in every for poly in one for m in poly for f in m})
    truth = [poly for at in held.order for poly in every[at]]
    off = [plus(s, t, -1) for s, t in zip(held.sums, truth, strict=True)]
    cuts = [[arb(x) for x in row] for row in proof["cuts"]]
    if not all(
        row[0] <= low and row[-1] >= high for row, (low, high) in zip(cuts, held.box, strict=True)
    ):
        print("NOT proved: the cells do not cover what the map reads")
        return 1
    guard, most_turn, looked = arb(held.guard), (arb(held.guard_i) - arb("1.7496")) / 32767, 0
    boxes: list[Any] = [[]]
    for row in cuts:
        boxes = [[*b, pair] for b in boxes for pair in itertools.pairwise(row)]
    trail = iter(proof["trail"])
    for first in boxes:
        todo = [(first, 0, True)]
        while todo:
            box, depth, told = todo.pop()
            axis = next(trail) if told else "."
            if axis == ".":
                looked += 1
                found, turn_ = need(truth, off, held, proof["rules"], box)
                if found <= guard and turn_ <= most_turn:
                    continue
                if depth == DEPTH or not box:
                    print(f"NOT proved: a cell needs {found} rad, the guard is {guard}")
                    return 1
                axis, told = str(depth % len(box)), False
                depth += 1
            at = int(axis, 36)
            low, high = box[at]
            middle = ((low + high) / 2).mid()
            todo += [
                ([*box[:at], half, *box[at + 1 :]], depth, told)
                for half in ((middle, high), (low, middle))
            ]
    if next(trail, None) is not None:
        print("NOT proved: the trail goes on after the last cell")
        return 1
    print(f"proved: {looked} cells, guard {held.guard * 57.29577951308232:.6g} deg")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
