"""Cars whose wheels turn freely: where they roll away, and where they tip while they roll.

Owns the statements that are checked.  Wheels are real cylinders, on hinges where they are free.
On the ground with unit normal n (out of the body) a wheel of axis a rolls along t = a x n.

*All wheels free, without mass*: no torque on a wheel means no force along t, so the robot
accelerates by (g . t) t and feels g - (g . t) t: it tips as it would under that direction.
*Some braked*: the moments about axes in the ground do not depend on friction, so the shares of
the normal force are those of a robot that stands.  Let N be the braked wheels' share of it.  It
rolls away where |g . t| > mu N.  It stands where N^2 (mu^2 - (g . a)^2) >= (g . t)^2 with forces
per normal force of the robot: then each wheel can take the load across t in proportion to its own
normal force, and the braked ones that along t too.  In between, which only a slope across t
leaves open, it depends on how the wheels share the load across t.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from proofs.physics.begin import Start
from proofs.physics.body import Floats, Posture, Solid, on_solids
from proofs.physics.release import Run
from proofs.physics.robots import cap

# Sliding or rolling down for this long (s) and this far (m) is not standing.
WATCHED, GONE = 1.0, 0.02
# Closer to its limit than this factor a car that rolls has not gone so far in that time.
BAND = 1.06
# Cases nearer to tipping than this (rad) are drawn again: wheels have a little mass.
NEAR_LIMIT = math.radians(0.2)
CARS, SEED = 100, 22


@dataclass(frozen=True)
class Car:
    """Four equal wheels on level axles along y, x of the axles, half track, height of the com."""

    front: float
    rear: float
    left: float
    right: float
    height: float
    radius: float
    half: float
    mass: float

    @property
    def begin(self) -> Start:
        """The car on its four wheels."""
        points = np.array(
            [[x, y, -self.height] for x in (self.front, self.rear) for y in (self.left, self.right)]
        )
        return Start(np.array([0.0, 0.0, -1.0]), self.height, points)

    def posture(self, front: bool = True, rear: bool = True) -> Posture:
        """Return the car with the wheels of an axle braked or free."""
        axis = np.array([0.0, 1.0, 0.0])
        low = self.radius - self.height
        solids = [
            Solid("cylinder", np.array([x, y, low]), self.radius, axis, self.half, braked)
            for x, braked in ((self.front, front), (self.rear, rear))
            for y in (self.left, self.right)
        ]
        return on_solids(tuple(solids), self.mass)

    def braked_share(self, gravity_dir: Floats, front: bool, rear: bool) -> float:
        """Return the braked axles' share of the normal force."""
        pierced = self.height * gravity_dir[0] / -gravity_dir[2]
        at_front = (pierced - self.rear) / (self.front - self.rear)
        return float(front * at_front + rear * (1.0 - at_front))

    def slopes(self, gravity_dir: Floats, share: float, mu: float) -> tuple[float, float]:
        """Return two ratios: below 1 in the first it must roll, from 1 in the second it holds."""
        along, across = np.abs(gravity_dir[:2]) / -gravity_dir[2]
        return mu * share / along, mu * share / math.hypot(along, share * across)


def car(rng: np.random.Generator) -> Car:
    """Return a random car, its com between its axles."""
    base, track = rng.uniform(0.3, 0.6, 2)
    x, y = base * rng.uniform(0.3, 0.7), track * rng.uniform(0.3, 0.7)
    radius = rng.uniform(0.05, 0.1)
    height = radius + rng.uniform(0.0, 0.3)
    half = rng.uniform(0.005, 0.02)
    return Car(x, x - base, y, y - track, height, radius, half, rng.uniform(2.0, 30.0))


def felt(gravity_dir: Floats) -> Floats:
    """Return the direction that a freely rolling car feels."""
    return np.asarray(gravity_dir * [0.0, 1.0, 1.0])


def tips_while_rolling(what: Car, gravity_dir: Floats) -> bool:
    """Let a car go with all its wheels free, and tell whether it turns over."""
    run = Run(what.posture(False, False), what.begin, gravity_dir)
    while run.data.time < 3.0 and run.turned < math.radians(30.0):
        run.step()
    return run.turned >= math.radians(30.0)


def gets_away(what: Car, gravity_dir: Floats, mu: float, front: bool, rear: bool) -> bool:
    """Let a car go with axles braked or free, and tell whether it leaves its place."""
    run = Run(what.posture(front, rear), what.begin, gravity_dir, mu)
    while run.data.time < WATCHED:
        run.step()
        if float(np.linalg.norm(run.moved)) > GONE:
            return True
    return False


@dataclass(frozen=True)
class Part:
    """One table row: of `cases`, `agree` agree; `other` is the count of a wrong prediction."""

    name: str
    cases: int
    agree: int
    other: int
    wrong: str


def free_wheels() -> Part:
    """Compare verdicts on cars that roll freely, and those that forget that they roll."""
    rng = np.random.default_rng(SEED)
    agree = other = 0
    for _ in range(CARS):
        what = car(rng)
        posture = what.posture()
        while True:
            gravity_dir = cap(rng, 75.0)
            rolls = posture.tip_angle(felt(gravity_dir))
            if abs(rolls) > NEAR_LIMIT:
                break
        tips = tips_while_rolling(what, gravity_dir)
        agree += tips == (rolls < 0.0)
        other += tips == (posture.tip_angle(gravity_dir) < 0.0)
    return Part("all wheels free: tips", CARS, agree, other, "g as it is")


def one_axle(across: bool) -> Part:
    """Compare the two bounds on cars with one axle braked; without slope across they are one."""
    rng = np.random.default_rng([SEED, across])
    cases = agree = other = 0
    while cases < CARS:
        what, mu, front = car(rng), rng.uniform(0.3, 1.0), bool(rng.integers(2))
        tilt = math.atan(mu) * rng.uniform(0.2, 0.97)
        turn = rng.uniform(-1.3, 1.3) if across else 0.0
        x, y = math.sin(tilt) * math.cos(turn), math.sin(tilt) * math.sin(turn)
        gravity_dir = np.array([x * rng.choice([-1.0, 1.0]), y, -math.cos(tilt)])
        share = what.braked_share(gravity_dir, front, not front)
        most, least = what.slopes(gravity_dir, share, mu)
        if what.posture().tip_angle(gravity_dir) < NEAR_LIMIT or not 0.6 < least < 1.6:
            continue
        if 1.0 / BAND < most < BAND or 1.0 / BAND < least < BAND or most > 1.0 > least:
            continue
        away = gets_away(what, gravity_dir, mu, front, not front)
        cases += 1
        agree += away == (most < 1.0)
        other += away == (math.hypot(x, y) / -gravity_dir[2] > mu)
    name = "one axle braked, slope " + ("in any heading" if across else "along the wheels")
    return Part(f"{name}: rolls away", cases, agree, other, "all wheels braked")


PARTS = ("free", "along", "across")


def judged(part: str) -> Part:
    """Return one row."""
    return free_wheels() if part == "free" else one_axle(part == "across")


def table(parts: Sequence[Part]) -> str:
    """Return the table of rows as Markdown."""
    lines = [
        "| cars on four cylinders | cases | agree | a wrong prediction agrees |",
        "|---|---|---|---|",
    ]
    for p in parts:
        wrong = f"{100.0 * p.other / p.cases:.0f} % ({p.wrong})"
        lines.append(f"| {p.name} | {p.cases} | {100.0 * p.agree / p.cases:.4g} % | {wrong} |")
    return "\n".join(lines) + "\n"


def missed(parts: Sequence[Part]) -> list[str]:
    """Return the rows with a disagreement, one line each."""
    return [f"{p.name}: {p.cases - p.agree} wrong" for p in parts if p.agree < p.cases]
