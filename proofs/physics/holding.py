"""Whether wheels hold on a slope, where statics leaves the load on them open.

Owns robots with more contacts than three: six wheels whose middle pair rolls, or alone is braked;
three contacts in a line; contacts inside the polygon.  How they share the load is decided by
hundredths of a millimetre, so each robot is tried with a few sets of them.  Lutgen's *holds*, a
promise for every load, must not be given where the robot moves with one of them, and *rolls*, for
none, not where it stays with one; *may hold* is allowed both.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lutgen.analysis import Posture as Asked
from lutgen.analysis import holds, may_hold
from proofs.physics.begin import Start
from proofs.physics.body import Floats, Solid, as_recipe, on_solids, tip_angles
from proofs.physics.release import DOWN, Run

AXLE, UP = np.eye(3)[1], np.eye(3)[2]
RADIUS, HALF = 0.1, 0.01
# Going so far (m) in this time (s) is moving: 2 % beyond its limit a robot goes some 10 cm.
GONE, WATCHED = 0.02, 1.5
# Before, it comes to rest on level ground, which is then tilted: let go on the slope from some
# 0.05 mm a robot may go on hopping from wheel to wheel, all the way down, where at rest it holds.
SETTLED, TILTED = 0.3, 1.0
# Slopes nearer to the limit than this factor are left out: soft contacts creep there.
BAND = 1.03
# Verdicts nearer to tipping than this (rad) are drawn again: wheels have a little mass.
NEAR_LIMIT = math.radians(1.0)
# Wheels are off by up to so much (m), a few times what they sink into the ground: any of them may
# then carry a lot or nothing, and the robot leans by 0.01 deg.
UNEVEN, SETS = 5e-5, 3
# What rolls, and the height of the com (m), of six-wheelers on perfectly equal wheels.
KNOWN = tuple(
    (name, height)
    for name in ("middle wheels roll", "only middle wheels braked")
    for height in (0.5, 0.2)
)
MU, TANGENTS = 0.7, np.arange(0.05, 0.70, 0.05)
CHUNK, SEED = 20, 34


@dataclass(frozen=True)
class Machine:
    """A robot on wheels and balls that all touch one level plane; `height` of the com over it."""

    solids: tuple[Solid, ...]
    height: float
    mu: float

    @property
    def asked(self) -> Asked:
        """The robot as lutgen gets it; a cylinder is its two rims."""
        rolling = [not s.braked for s in self.solids for _ in range(2 if s.half > 0.0 else 1)]
        recipe = as_recipe(on_solids(self.solids), f"friction = {self.mu!r}", rolling)
        return Asked(recipe, np.zeros(0))

    def uneven(self, rng: np.random.Generator) -> "Machine":
        """Return the machine with every wheel and ball a little higher or lower."""
        off = rng.uniform(-UNEVEN, UNEVEN, len(self.solids))
        solids = tuple(
            replace(solid, centre=solid.centre + up * UP)
            for solid, up in zip(self.solids, off, strict=True)
        )
        return replace(self, solids=solids)

    def moves(self, gravity_dir: Floats) -> bool:
        """Put it on level ground, tilt that, and tell whether the robot leaves its place."""
        low = min(float(s.centre[2]) - s.radius for s in self.solids)
        begin = Start(DOWN, -low, np.array([s.centre for s in self.solids]))
        run = Run(on_solids(self.solids), begin, DOWN, self.mu)
        while run.data.time < SETTLED + TILTED + WATCHED:
            part = min(max(run.data.time - SETTLED, 0.0) / TILTED, 1.0)
            run.tilt(DOWN + part * (gravity_dir - DOWN))
            run.step()
            if float(np.linalg.norm(run.moved)) > GONE:
                return True
        return False


def wheel(x: float, y: float, height: float, braked: bool) -> Solid:
    """Return a wheel on the ground."""
    return Solid("cylinder", np.array([x, y, RADIUS - height]), RADIUS, AXLE, HALF, braked)


def six(height: float, middle: bool, mu: float = MU, offset: float = 0.0) -> Machine:
    """Return a six-wheeler of 0.8 x 0.6 m; `middle` tells that the middle wheels are braked."""
    solids = tuple(
        wheel(x + offset, y, height, (x == 0.0) == middle)
        for x in (0.4, 0.0, -0.4)
        for y in (0.3, -0.3)
    )
    return Machine(solids, height, mu)


def any_six(middle: bool) -> Callable[[np.random.Generator], Machine]:
    """Return a maker of six-wheelers with any height and offset of the com and any friction."""

    def make(rng: np.random.Generator) -> Machine:
        return six(rng.uniform(0.15, 0.5), middle, rng.uniform(0.4, 0.9), rng.uniform(-0.3, 0.3))

    return make


def in_line(rng: np.random.Generator) -> Machine:
    """Return a machine on three wheels in a line and a fourth beside it, some braked."""
    height, braked = rng.uniform(0.15, 0.4), rng.integers(0, 2, 4).astype(bool)
    braked[int(rng.integers(4))] = True
    braked[int(rng.integers(4))] = False
    shift = rng.uniform(-0.1, 0.1)
    places = [(0.4, 0.2), (rng.uniform(-0.2, 0.2), 0.2), (-0.4, 0.2), (shift, -0.4)]
    solids = tuple(wheel(x, y, height, bool(b)) for (x, y), b in zip(places, braked, strict=True))
    return Machine(solids, height, rng.uniform(0.4, 0.9))


def inside(rng: np.random.Generator) -> Machine:
    """Return a car with one or two wheels or balls inside its polygon, some braked."""
    height, count = rng.uniform(0.15, 0.4), int(rng.integers(1, 3))
    braked = rng.integers(0, 2, 4 + count).astype(bool)
    braked[int(rng.integers(4))] = True
    braked[4] = not braked[:4].all() and bool(rng.integers(2))
    solids = [
        wheel(x, y, height, bool(b))
        for (x, y), b in zip(
            ((0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)), braked, strict=False
        )
    ]
    for b in braked[4:]:
        x, y = rng.uniform(-0.2, 0.2, 2)
        if rng.integers(2):
            solids.append(wheel(x, y, height, bool(b)))
        else:
            centre = np.array([x, y, RADIUS - height])
            solids.append(Solid("sphere", centre, RADIUS, braked=bool(b)))
    return Machine(tuple(solids), height, rng.uniform(0.4, 0.9))


ROBOTS: dict[str, Callable[[np.random.Generator], Machine]] = {
    "six wheels, the middle ones roll": any_six(False),
    "six wheels, only the middle ones braked": any_six(True),
    "three wheels in a line and one": in_line,
    "a car with contacts inside": inside,
}


@dataclass(frozen=True)
class Trial:
    """One slope: lutgen's verdict, and of `SETS` + 1 sets of wheels, with how many it moved."""

    name: str
    said: str
    moved: int


@dataclass(frozen=True)
class Known:
    """A six-wheeler that is known: the largest tangents that lutgen holds and may hold, and found.

    `held` is the tangent through which the engine holds it, `moved` that from which it moves.
    """

    name: str
    height: float
    holds: float
    may_hold: float
    held: float
    moved: float


def slope(tangent: float, heading: float) -> Floats:
    """Return the direction of gravity on a slope, body frame."""
    down = np.array([tangent * math.cos(heading), tangent * math.sin(heading), -1.0])
    return np.asarray(down / np.linalg.norm(down))


def said(asked: Asked, tangent: float, heading: float) -> str:
    """Return lutgen's verdict: "holds", "may hold", "rolls", or "" near a limit."""
    near = np.array([slope(tangent * factor, heading) for factor in (1.0 / BAND, BAND)])
    sure, maybe = holds(asked, near), may_hold(asked, near)
    if sure[0] != sure[1] or maybe[0] != maybe[1]:
        return ""
    return "holds" if sure[0] else "may hold" if maybe[0] else "rolls"


def judged(name: str, chunk: int) -> list[Trial]:
    """Return `CHUNK` trials, the same in every run."""
    rng = np.random.default_rng([SEED, list(ROBOTS).index(name), chunk])
    trials: list[Trial] = []
    while len(trials) < CHUNK:
        machine = ROBOTS[name](rng)
        heading = rng.choice([0.0, math.pi, rng.uniform(0.0, 2.0 * math.pi)])
        tangent = machine.mu * rng.uniform(0.05, 0.95)
        down, asked = slope(tangent, heading), machine.asked
        if tip_angles(asked.recipe, down[None])[0] < NEAR_LIMIT:
            continue
        verdict = said(asked, tangent, heading)
        if verdict:
            tried = [machine, *(machine.uneven(rng) for _ in range(SETS))]
            trials.append(Trial(name, verdict, sum(one.moves(down) for one in tried)))
    return trials


def known(name: str, height: float) -> Known:
    """Return what lutgen and the engine say of a six-wheeler that is known."""
    machine = six(height, name.startswith("only"))
    downs = np.array([slope(tangent, 0.0) for tangent in TANGENTS])
    asked = machine.asked
    stands = tip_angles(asked.recipe, downs) >= NEAR_LIMIT
    moved = np.array([machine.moves(down) for down in downs[stands]])
    tangents = TANGENTS[stands]
    sure, maybe, held = (
        float(tangents[verdict].max(initial=0.0))
        for verdict in (holds(asked, downs[stands]), may_hold(asked, downs[stands]), ~moved)
    )
    from_ = float(tangents[moved].min(initial=math.inf))
    return Known(name, height, sure, maybe, held, from_)


def table(trials: Sequence[Trial], rows: Sequence[Known]) -> str:
    """Return both tables as Markdown."""
    lines = [
        '| robots | "holds" | of these moved | "may hold" | of these moved with some load '
        '| stayed with some load | "rolls" | of these stayed |',
        "|---|---|---|---|---|---|---|---|",
    ]
    for name in ROBOTS:
        cells: list[int] = []
        for verdict in ("holds", "may hold", "rolls"):
            moved = [t.moved for t in trials if t.name == name and t.said == verdict]
            cells.append(len(moved))
            cells += [sum(m > 0 for m in moved)] if verdict != "rolls" else []
            cells += [sum(m <= SETS for m in moved)] if verdict != "holds" else []
        lines.append(f"| {name} | {' | '.join(map(str, cells))} |")
    lines += [
        "",
        "| six wheels, mu 0.7, nose down | com | lutgen holds through tan | may hold through "
        "| the engine holds through | moves from |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r.name} | {r.height} m | {r.holds:.2f} | {r.may_hold:.2f} | {r.held:.2f} "
        f"| {r.moved:.2f} |"
        for r in rows
    ]
    return "\n".join(lines) + "\n"


def missed(trials: Sequence[Trial], rows: Sequence[Known]) -> list[str]:
    """Return the promises that were not kept, one line each."""
    faults = []
    for name in ROBOTS:
        mine = [t for t in trials if t.name == name]
        gone = sum(t.said == "holds" and t.moved > 0 for t in mine)
        stayed = sum(t.said == "rolls" and t.moved <= SETS for t in mine)
        if gone:
            faults.append(f'{name}: {gone} moved where lutgen says "holds"')
        if stayed:
            faults.append(f'{name}: {stayed} stayed where lutgen says "rolls"')
    for r in rows:
        if r.holds >= r.moved:
            faults.append(f"{r.name}, com {r.height} m: holds at {r.holds:.2f}, moves there")
        if r.may_hold < r.held:
            faults.append(f"{r.name}, com {r.height} m: rolls at {r.held:.2f}, stays there")
    return faults
