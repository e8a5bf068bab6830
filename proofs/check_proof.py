"""Check NAME_proof.json of `lutgen prove` in ball arithmetic: python -m proofs.check_proof DIR.

Shares no code with lutgen.  Taken from the proof: the robot's links, how the box of parameters is
cut into cells, and the claim.  Taken from NAME.c: the bytes of the map.  Positions, their errors and
the bound of every cell are computed anew with Arb; a cell that does not show enough is halved.
It knows maps whose positions are in closed form; exits 0 where the guard is enough, 1 where not.
"""

import hashlib
import json
import re
import struct
import sys
from pathlib import Path
from typing import Any

from flint import arb, ctx

ctx.prec = 80
U = arb(2) ** -24  # half a unit of single precision
SINE_NEAR, SINE, ARCSINE = arb("8.4e-8"), arb("9.4e-8"), arb("1.7e-7")  # of all floats, see proofs/exhaustive.c
DEPTH = 12  # how often a cell of the proof may be halved once more
NEXT = ((0, 1), (1, 2), (2, 0))


def plus(p: dict, q: dict, sign: int = 1) -> dict:
    """Add polynomials: monomial (sorted factors) -> coefficient."""
    return {m: p.get(m, arb(0)) + sign * q.get(m, arb(0)) for m in {**p, **q}}


def monomials(factors: tuple) -> dict:
    """Write a product of factors with no square of a sine: s s = 1 - c c."""
    for f in factors:
        if f[0] == "s" and factors.count(f) > 1:
            rest = list(factors)
            rest.remove(f), rest.remove(f)
            c = ("c", *f[1:])
            return plus(monomials(tuple(rest)), monomials(tuple(sorted([*rest, c, c]))), -1)
    return {factors: arb(1)}


def times(p: dict, q: dict) -> dict:
    """Multiply polynomials."""
    out: dict = {}
    for a, x in p.items():
        for b, y in q.items():
            out = plus(out, {m: x * y * z for m, z in monomials(tuple(sorted(a + b))).items()})
    return out


def apply(rows: list, v: list) -> list:
    """Multiply a matrix by a vector of polynomials."""
    return [plus(plus(times(r[0], v[0]), times(r[1], v[1])), times(r[2], v[2])) for r in rows]


def matmul(a: list, b: list) -> list:
    """Multiply matrices of polynomials."""
    columns = [apply(a, [row[j] for row in b]) for j in range(3)]
    return [[columns[j][i] for j in range(3)] for i in range(3)]


def still(numbers: list) -> list:
    """Return numbers as polynomials."""
    return [{(): arb(x)} for x in numbers]


def turn(axis: list, c: dict, s: dict) -> list:
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


def positions(proof: dict) -> list:
    """Return the contacts relative to the centre of mass: three polynomials each."""
    rotation, place, total, moment = {}, {}, arb(0), still([0, 0, 0])
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
            p = [plus(a, times(way, b)) for a, b in zip(p, apply(r, still(joint["axis"])), strict=True)]
        rotation[link["name"]], place[link["name"]] = r, p
        total += arb(link["mass"])
        centre = [plus(a, b) for a, b in zip(p, apply(r, still(link["com"])), strict=True)]
        moment = [plus(a, times(b, {(): arb(link["mass"])})) for a, b in zip(moment, centre, strict=True)]
    com = [times(m, {(): -1 / total}) for m in moment] if total > 0 else still([0, 0, 0])
    out = []
    for one in proof["contacts"]:
        far = apply(rotation[one["link"]], still(one["position"]))
        out.append([plus(plus(a, b), c) for a, b, c in zip(place[one["link"]], far, com, strict=True)])
    return out


class Map:
    """What the bytes of a map say of three contacts, and how far single precision is off."""

    def __init__(self, blob: bytes, factors: set) -> None:
        if blob[9] != 1:
            raise SystemExit("not checked: its positions are not in closed form (polynomials or tables)")
        self.guard, _, self.guard_i = struct.unpack_from("<ffH", blob, 20)
        axes = [struct.unpack_from("<fff", blob, 32 + 14 * i) for i in range(blob[10])]
        at = 32 + 14 * blob[10]
        angles, travels, products, discs, terms, flags, code = struct.unpack_from("<4BH2B", blob, at)
        self.limits = struct.unpack_from("<3f", blob, at + 8)
        if discs or flags & 0b10100 or any(low > high or slack < 0 for low, high, slack in axes):
            raise SystemExit("not checked: round contacts, joints that turn round, or a robot by code")
        self.order, self.either = [code >> 2 * i & 3 for i in range(3)], bool(code & 128)
        at += 22
        weights = struct.unpack_from(f"<{terms}f", blob, at)
        at += 4 * terms
        rates = struct.unpack_from(f"<{angles}f", blob, at) if flags & 2 else [1.0] * angles
        rest = list(blob[at + (4 * angles if flags & 2 else 0) :])
        reach = [max(abs(low), abs(high)) + slack for low, high, slack in axes]
        hair = [8 * U * r for r in reach]
        lag = [4 * U * (h - l) + 2 * U * r for (l, h, _), r in zip(axes, reach, strict=True)]
        self.box = [(arb(l) - s - e, arb(h) + s + e) for (l, h, s), e in zip(axes, hair, strict=True)]
        entries: list[tuple] = [((), arb(1), arb(0))]  # monomial, size, error
        for k, rate in zip(rest[:angles], rates, strict=True):
            near = [f[2] for f in factors if f[0] != "t" and f[1] == k and abs(f[2] - rate) < 1e-6 * rate]
            own = near[0] if near else rate
            limit = arb("1.0501") if flags & 8 else arb(16)
            if not arb(own) * (arb(reach[k]) + hair[k]) < limit:
                raise SystemExit("not checked: an angle is further than sines were tried")
            off = (SINE_NEAR if flags & 8 else SINE) + own * lag[k] + abs(arb(own) - arb(rate)) * reach[k] + (U * own * reach[k] if rate != 1 else 0)
            entries += [((("s", k, own),), arb(1), off), ((("c", k, own),), arb(1), off)]
        entries += [((("t", k, 1.0),), arb(reach[k]), lag[k]) for k in rest[angles : angles + travels]]
        rest = rest[angles + travels :]
        for i in range(products):
            (m, x, a), (n, y, b) = entries[rest[2 * i]], entries[rest[2 * i + 1]]
            off = x * b + a * y + a * b
            entries.append((tuple(sorted(m + n)), x * y, off + U * (x * y + off)))
        count = 12 if flags & 1 else 9
        counts, which = rest[2 * products :][:count], iter(zip(weights, rest[2 * products + count :], strict=True))
        sums, errors = [], []
        for terms in counts:
            total: dict = {}
            size = error = arb(0)
            for term in range(terms):
                w, e = next(which)
                m, x, a = entries[e]
                total = plus(total, {m: arb(w)})
                size, error = size + abs(w) * x, error + abs(w) * (a + U * (x + a))
                error += U * (size + error) if term else 0
            sums.append(total), errors.append((size, error))
        if count == 12:
            errors = [(x + y, a + b + U * (x + y + a + b)) for (x, a), (y, b) in
                      ((errors[3 + i], errors[i % 3]) for i in range(9))]
            sums = [plus(sums[3 + i], sums[i % 3]) for i in range(9)]
        self.sums, self.errors = sums, [e + arb(10) ** -40 for _, e in errors]


class Fn:
    """A function over a cell: in its middle, over all of it, and its derivatives over all of it."""

    __slots__ = ("g", "m", "v")

    def __init__(self, m: Any, v: Any, g: list) -> None:
        self.m, self.v, self.g = m, v, g

    def __add__(self, o: "Fn") -> "Fn":
        return Fn(self.m + o.m, self.v + o.v, [a + b for a, b in zip(self.g, o.g, strict=True)])

    def __sub__(self, o: "Fn") -> "Fn":
        return Fn(self.m - o.m, self.v - o.v, [a - b for a, b in zip(self.g, o.g, strict=True)])

    def __mul__(self, o: "Fn") -> "Fn":
        g = [a * o.v + self.v * b for a, b in zip(self.g, o.g, strict=True)]
        return Fn(self.m * o.m, self.v * o.v, g)

    def over(self, way: list) -> Any:
        """Return its range: the mean value form, and what came directly."""
        moved = self.m
        for a, w in zip(self.g, way, strict=True):
            moved = moved + a * w
        return moved.intersection(self.v)


def cells_of(poly_list: list, box: list) -> list:
    """Return polynomials as functions over a cell; `box`: (low, high) of each parameter."""
    k = len(box)
    middle = [(low + high) / 2 for low, high in box]
    whole = [low.union(high) for low, high in box]
    known: dict = {(): Fn(arb(1), arb(1), [arb(0)] * k)}

    def factor(f: tuple) -> Fn:
        kind, at, rate = f
        m, v = middle[at] * rate, whole[at] * rate
        g = [arb(0)] * k
        if kind == "t":
            g[at] = arb(1)
            return Fn(m, v, g)
        g[at] = rate * (v.cos() if kind == "s" else -v.sin())
        return Fn(m.cos(), v.cos(), g) if kind == "c" else Fn(m.sin(), v.sin(), g)

    def monomial(m: tuple) -> Fn:
        if m not in known:
            known[m] = monomial(m[:-1]) * factor(m[-1])
        return known[m]

    out = []
    for poly in poly_list:
        total = Fn(arb(0), arb(0), [arb(0)] * k)
        for m, x in poly.items():
            one = monomial(m)
            total = total + Fn(x * one.m, x * one.v, [x * g for g in one.g])
        out.append(total)
    return out


def cross(a: list, b: list) -> list:
    """Return a vector product."""
    return [a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def dot(a: list, b: list) -> Any:
    """Return a scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm(a: list) -> Any:
    """Return a length: no less than 0, whatever the balls say."""
    square = dot(a, a)
    low = max(square.lower(), arb(0))
    return low.sqrt().union(square.upper().sqrt())


def most(x: Any) -> Any:
    """Return the largest absolute value."""
    return abs(x).upper()


def turned(truth: list, off: list, errors: list, way: list, height: Any) -> tuple:
    """Return the greatest sine of a plane's turn, and the least distance of an axis.

    `truth` and `off`: nine functions each, the true contacts and what the stored ones are off;
    `height`: what the facet is below the centre of mass at least.
    """
    p = [[f.over(way) for f in truth[3 * i : 3 * i + 3]] for i in range(3)]
    d = [[f.over(way) + (arb(0) if e is None else arb(0, 1) * e) for f, e in
          zip(off[3 * i : 3 * i + 3], errors[3 * i : 3 * i + 3], strict=True)] for i in range(3)]
    r = [norm(errors[3 * i : 3 * i + 3]).upper() for i in range(3)]
    seen = [[a + b for a, b in zip(x, y, strict=True)] for x, y in zip(p, d, strict=True)]
    witness = [sum((x.mid() / norm([y.mid() for y in q]).mid() for q, x in
                    ((q, q[c]) for q in p)), arb(0)).mid() for c in range(3)]
    arc = whole = arb(0)
    near, shown, clear = arb("inf"), True, arb("inf")
    for i, j in NEXT:
        true, held = cross(p[i], p[j]), cross(seen[i], seen[j])
        rounded = arb("2.01") * U * norm([most(seen[i][a]) * most(seen[j][b]) + most(seen[i][b]) *
                                          most(seen[j][a]) for a, b in ((1, 2), (2, 0), (0, 1))]).upper()
        side = norm([a - b for a, b in zip(p[i], p[j], strict=True)])
        plane = max(norm(true).lower(), (side * height).lower())
        moved = norm([a + b for a, b in zip(cross(p[i], d[j]), cross(d[i], seen[j]), strict=True)]) + rounded
        least = max((norm(held) - rounded).lower(), (plane - moved).lower())
        if not (least > 1e-14 and moved < plane):
            return arb("inf"), arb(0)
        q = [[t + o for t, o in zip(truth[3 * n : 3 * n + 3], off[3 * n : 3 * n + 3], strict=True)] for n in (i, j)]
        ends = []
        for at in (i, j):
            own = off[3 * at : 3 * at + 3]
            real = [f.over(way) for f in own]
            normal = cross(q[0], q[1])
            wide = [f.over(way) for f in normal]
            far, close = (norm([f.over(way) for f in x]).upper() for x in q)
            extra = (far * r[j] + close * r[i] + r[i] * r[j]) * (norm(real) + r[at])
            extra += sum((most(a) * e for a, e in zip(wide, errors[3 * at : 3 * at + 3], strict=True)), arb(0))
            extra += rounded * norm(p[at])
            ends.append((-dot(normal, own).over(way) + arb(0, 1) * extra.upper()) / least)
        a, b, between = ends[0], ends[1], dot(p[i], p[j])
        turns = []
        for x, y, along in ((max(a.upper(), arb(0)), max(b.upper(), arb(0)), -between.lower()), (most(a), most(b), most(between))):
            x, y = x * norm(p[j]).upper(), y * norm(p[i]).upper()
            both = x * x + y * y + 2 * (x / norm(p[j]).upper()) * (y / norm(p[i]).upper()) * along
            turns.append(max(x.upper(), y.upper(), max(both.upper(), arb(0)).sqrt().upper()) / plane)
        arc, whole = max(arc, turns[0].upper()), max(whole, turns[1].upper())
        near = min(near, (plane / side.upper()).lower())
        shown = shown and bool(dot(true, witness) > 0)
        clear = min(clear, ((dot(held, witness) - rounded * norm(witness)) / ((norm(held) + rounded) * norm(witness))).lower())
    return (min(arc, whole) if shown and clear > arc else whole), near


def facet(p: list, d: list, rules: dict, held: Map) -> tuple:
    """Return whether what the map answers as standing stands, the least height, and 1 / cos of the cone."""
    edges = [cross(p[i], p[j]) for i, j in NEXT]
    normal = [sum((e[c] for e in edges), arb(0)) for c in range(3)]
    reach = max(norm(x).upper() for x in p)
    sides = [norm([a - b for a, b in zip(p[i], p[j], strict=True)]) for i, j in NEXT]
    moved = max(norm(x).upper() for x in d)
    lowest, steepest, width = map(arb, held.limits)
    wrong = 24 * U * reach * (reach + moved)
    for i, j in NEXT:
        seen = [a + b for a, b in zip(p[j], d[j], strict=True)]
        wrong += norm([a + b for a, b in zip(cross(p[i], d[j]), cross(d[i], seen), strict=True)]).upper()
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
    upright = rules["steepest"] <= -1 or bool(sign and -sign * normal[2] > rules["steepest"] * size) or (
        held.limits[1] > -1 and bool(steepest - tilt > rules["steepest"]))
    wide = rules["width"] <= 0 or bool(size > rules["width"] * max(s.upper() for s in sides)) or (
        held.limits[2] > 0 and bool(width * (1 - 16 * U) * (1 - 2 * moved / longest) - wrong / longest > rules["width"]))
    return bool(height > rules["ball"]) and upright and wide, height, reach, edges


def refused(p: list, held: Map) -> bool:
    """Whether the map answers nothing of a cell: a facet the wrong way round, too low or too steep."""
    edges = [cross(p[i], p[j]) for i, j in NEXT]
    volume, reach = dot(edges[0], p[2]), max(norm(x).upper() for x in p)
    normal = [sum((e[c] for e in edges), arb(0)) for c in range(3)]
    size, hair = norm(normal), arb("1e-3") * reach**3
    if (abs(volume) if held.either else volume) + hair < arb(held.limits[0]) * size:
        return True
    sign = -1 if volume > hair else 1 if volume < -hair else 0
    down = sign * normal[2] if sign else abs(normal[2])
    return held.limits[1] > -1 and bool(down < arb(held.limits[1] - 1e-3) * size)


def need(truth: list, off: list, held: Map, rules: dict, box: list) -> Any:
    """Return the guard (rad) that a cell needs, and the planes' turn; infinite where it shows nothing."""
    fs = cells_of([*truth, *off], box)
    way = [arb(0, 1) * ((high - low) / 2).upper() for low, high in box]
    p = [[f.over(way) for f in fs[3 * i : 3 * i + 3]] for i in range(3)]
    d = [[f.over(way) + arb(0, 1) * e.upper() for f, e in zip(fs[9 + 3 * i : 12 + 3 * i], held.errors[3 * i : 3 * i + 3], strict=True)] for i in range(3)]
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
        size = (lengths[i] * lengths[j]).lower() if product > 0 else (lengths[i] * lengths[j]).upper()
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
    if not all(row[0] <= low and row[-1] >= high for row, (low, high) in zip(cuts, held.box, strict=True)):
        print("NOT proved: the cells do not cover what the map reads")
        return 1
    guard, most_turn, looked = arb(held.guard), (arb(held.guard_i) - arb("1.7496")) / 32767, 0
    boxes: list = [[]]
    for row in cuts:
        boxes = [[*b, pair] for b in boxes for pair in zip(row, row[1:], strict=False)]
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
            todo += [([*box[:at], half, *box[at + 1 :]], depth, told) for half in ((middle, high), (low, middle))]
    if next(trail, None) is not None:
        print("NOT proved: the trail goes on after the last cell")
        return 1
    print(f"proved: {looked} cells, guard {held.guard * 57.29577951308232:.6g} deg")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
