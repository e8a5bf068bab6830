"""Gaps against letting the robot go place by place, with fine steps of rolling and no algebra."""

import math

import numpy as np
import pytest

import lutgen
from lutgen.channels import acceptance_of
from lutgen.recipe import forward, radii_and_kinds
from lutgen.support import edges_at, empty_region, facet_table, pack, stand
from lutgen.support.arc import Arc, arc_normal, enter_roll
from lutgen.support.catch import REFUSED, REST
from lutgen.support.primitive import support_contact
from lutgen.support.region import Acceptance, acceptance
from lutgen.support.rest import find_rests
from lutgen.support.table import FIRST, NEIGHBOUR, VERTEX, FacetTable
from lutgen.vector import Floats, Ints
from tests.fixtures.length import part

STEPS = 60


def rolled(
    primitives: Floats, i: int, j: int, begin: Floats, end: Floats, g: Floats, steps: int = STEPS
) -> tuple[Floats, float, float]:
    """Return gravity after a roll, how far the com has risen and the turn; in small steps."""
    rise = turn = 0.0
    here, contact = np.array(begin), np.array(support_contact(primitives, i, tuple(begin)))
    for step in range(1, steps + 1):
        there = np.array(
            end
            if step == steps
            else arc_normal(primitives, Arc(i, j, tuple(begin), tuple(end)), step / steps)
        )
        about = np.cross(here, there)
        turned = g + np.cross(about, g) + np.cross(about, np.cross(about, g)) / (1.0 + here @ there)
        beyond = np.array(support_contact(primitives, i, tuple(there)))
        rise += (turned - g) @ (contact + beyond) / 2.0
        turn += math.asin(min(float(np.sqrt(about @ about)), 1.0))
        g, here, contact = turned, there, beyond
    return g, rise, turn


class LetGo:
    """One posture, and what becomes of the robot where it is let go."""

    def __init__(self, primitives: Floats, limits: Acceptance, size: float) -> None:
        n = len(primitives)
        self.primitives, self.limits = primitives, limits
        self.table: FacetTable = facet_table(n)
        stand(self.table, empty_region(n), primitives, limits)
        facets = self.table.hull.tally[0]
        # Finding the rests writes bits into the spans, which `stand` has done already.
        self.hull = self.table.hull._replace(span=self.table.hull.span[: facets + 1].copy())
        self.span = self.hull.span
        self.kind: Ints = np.zeros(facets, np.int64)
        centroid = np.empty((facets, 3))
        find_rests(self.hull, primitives, limits, size, self.kind, centroid, self.table.work)

    def after(self, f: int, at: int) -> int:
        """Return the next corner of a facet."""
        return at + 1 if at + 1 < self.span[f + 1, FIRST] else int(self.span[f, FIRST])

    def edges(self) -> list[tuple[int, int]]:
        """Edges between two accepted facets, from the one with the lower index."""
        found = []
        for f in np.flatnonzero(self.kind != REFUSED):
            for at in range(*edges_at(self.span, f)):
                other = self.hull.link[at, NEIGHBOUR]
                if other > f and self.kind[other] != REFUSED:
                    found.append((int(f), at))
        return found

    def roll(self, f: int, at: int, g: Floats) -> tuple[Floats, float, float]:
        """Roll over an edge of a facet; see `rolled`."""
        i, j = self.hull.link[at, VERTEX], self.hull.link[self.after(f, at), VERTEX]
        other = self.hull.link[at, NEIGHBOUR]
        return rolled(self.primitives, i, j, self.hull.facet[f, :3], self.hull.facet[other, :3], g)

    def rests_on(
        self, f: int, came: int, g: Floats, raised: float, turned: float, depth: int = 0
    ) -> tuple[float, set[int]]:
        """Return the largest sum of turns of any way, infinity if one tips, and where they end."""
        assert depth < 20
        corner, least, ends = self.hull.corner, turned, set()
        begin, end = corner[came], corner[self.after(f, came)]
        line = (end - begin) / np.linalg.norm(end - begin)
        ways = []
        for at in range(*edges_at(self.span, f)):
            p, q = corner[at], corner[self.after(f, at)]
            off = max(np.linalg.norm(np.cross(one - begin, line)) for one in (p, q))
            if at == came or (
                off <= self.limits.rest_width / 2 and (self.kind[f] == REST or (q - p) @ line > 0)
            ):
                continue
            along = (q - p) / np.linalg.norm(q - p)
            arm = along * (p @ along) - p
            rise = np.linalg.norm(arm) * np.linalg.norm(g - along * (along @ g)) + arm @ g
            ways.append((rise, at, np.cross(p, q) @ g < 0.0 or raised + rise < 0.0))
        goes = [(at, raised) for _, at, leaves in ways if leaves]
        if not goes and self.kind[f] == REST:
            return turned, {f}
        if not goes and ways:
            rise, at, _ = min(ways)
            goes = [(at, -rise)]
        if not goes:
            return math.inf, ends
        for at, from_height in goes:
            other = self.hull.link[at, NEIGHBOUR]
            if other < 0 or self.kind[other] == REFUSED:
                return math.inf, ends
            seen, more, turn = self.roll(f, at, g)
            if turned + turn > self.limits.rock_angle:
                return math.inf, ends
            back = int(self.hull.link[at, 2])
            sum_of_turns, rests = self.rests_on(
                other, back, seen, from_height + more, turned + turn, depth + 1
            )
            least, ends = max(least, sum_of_turns), ends | rests
        return least, ends

    def caught(self, f: int, at: int, part: float) -> bool:
        """Tell whether a balance over an edge is caught, where its gap begins and where it ends."""
        other, back = int(self.hull.link[at, NEIGHBOUR]), int(self.hull.link[at, 2])
        for near, edge, far, far_edge, w in (
            (f, at, other, back, part),
            (other, back, f, at, 1.0 - part),
        ):
            p, q = self.hull.corner[edge], self.hull.corner[self.after(near, edge)]
            g = p + w * (q - p)
            g = g / np.linalg.norm(g)
            seen, rise, turn = self.roll(near, edge, g)
            ahead, some = self.rests_on(far, far_edge, seen, rise, turn)
            behind, others = self.rests_on(near, edge, g, 0.0, 0.0)
            if ahead + behind > self.limits.rock_angle or some & others:
                return False
        return True


def robots() -> list[tuple[str, LetGo]]:
    """Postures of two gallery robots, and wheels and balls at random places."""
    rng = np.random.default_rng(4)
    found = []
    for name in ("marv", "absolem"):
        recipe = lutgen.load_recipe(f"maps/{name}.toml")
        low = [one.minimum for one in recipe.parameters]
        high = [one.maximum for one in recipe.parameters]
        postures = forward(recipe, rng.uniform(low, high, (4, len(low))))
        limits = acceptance_of(recipe)
        for m in range(part(4, 2)):
            rows = pack(postures.centres[m], postures.axes[m], *radii_and_kinds(recipe))
            found.append((f"{name} {m}", LetGo(rows, limits, limits.rest_width / 0.01)))
    limits = acceptance(math.radians(80), math.radians(30), 0.0, 0.01, 1e-4)
    for m in range(part(12, 2)):
        centres = rng.uniform([-1.0, -0.6, -0.5], [1.0, 0.6, -0.3], (6, 3))
        kinds = np.full(6, 2 if m % 2 else 1)
        axes = np.tile([0.0, 1.0, 0.0], (6, 1)) * (m % 2)
        rows = pack(centres, axes, rng.uniform(0.05, 0.3, 6), kinds)
        found.append((f"random {m}", LetGo(rows, limits, 1.0)))
    return found


@pytest.fixture(scope="module")
def let_go() -> list[tuple[str, LetGo]]:
    return robots()


def test_a_balance_is_caught_in_the_gap_and_not_beside_it(let_go) -> None:
    places = np.linspace(0.02, 0.98, 9)
    inside = outside = 0
    for name, robot in let_go:
        for f, at in robot.edges():
            low, high = robot.table.held[at]
            for place in places:
                # Steps of 1/60 of an arc are right to about 1e-3 of the edge.
                if min(abs(place - low), abs(place - high)) < 5e-3:
                    continue
                caught = robot.caught(f, at, float(place))
                if low < place < high:
                    assert caught, f"{name}: facet {f}, edge {at}, place {place}, [{low}, {high}]"
                    inside += 1
                elif low >= high:
                    outside += 1
                    assert not caught, f"{name}: facet {f}, edge {at}, place {place}, no gap"
                else:
                    outside += not caught
    # Neither "never caught" nor "always caught" would pass.
    assert inside > part(100, 2)
    assert outside > part(100, 2)


def test_a_roll_is_linear_in_gravity_and_rolling_back_undoes_it(let_go) -> None:
    rng = np.random.default_rng(1)
    rows = np.empty((2, 13))
    turned = 0
    for _, robot in let_go:
        for f, at in robot.edges():
            other = robot.hull.link[at, NEIGHBOUR]
            i, j = (
                robot.hull.link[at, VERTEX],
                robot.hull.link[robot.after(f, at), VERTEX],
            )
            begin, end = robot.hull.facet[f, :3], robot.hull.facet[other, :3]
            turn = enter_roll(robot.primitives, Arc(i, j, tuple(begin), tuple(end)), 0, 1, rows)
            if turn > 0.6:
                continue
            turned += 1
            matrix, rise = rows[0, :9].reshape(3, 3), rows[0, 9:12]
            g = rng.standard_normal(3)
            want, raised, length = rolled(robot.primitives, i, j, begin, end, g)
            # What is said in `arc`: gravity to 1e-4 rad, a rise to 1e-4 of a radius below 1.
            assert np.abs(matrix @ g - want).max() < 2e-4
            assert rise @ g == pytest.approx(raised, abs=2e-4)
            assert turn == pytest.approx(length, abs=1e-4)
            back, sunk = rows[1, :9].reshape(3, 3), rows[1, 9:12]
            assert np.abs(back @ (matrix @ g) - g).max() < 1e-14
            assert sunk @ (matrix @ g) == pytest.approx(-(rise @ g), abs=1e-14)
    assert turned > part(30, 2)


def test_a_roll_over_a_wheel_that_lies_nearly_flat_is_right_too() -> None:
    # Its contact goes 94 deg along the rim while the plane turns by 17.
    rows = pack(
        np.array([[-0.3006, -0.2219, -0.3], [0.2514, 0.3682, -0.5607]]),
        np.array([[0.0116, 0.0225, -0.9997], [0.4702, -0.1982, 0.86]]),
        np.array([0.1281, 0.1426]),
        np.array([2, 2]),
    )
    begin, end = np.array([-0.3957, 0.0001, -0.9184]), np.array([-0.529, 0.2411, -0.8136])
    begin, end = (
        np.array(arc_normal(rows, Arc(0, 1, tuple(n), tuple(n)), 0.0))
        for n in (begin / np.linalg.norm(begin), end / np.linalg.norm(end))
    )
    rim = [np.array(support_contact(rows, 1, tuple(n))) for n in (begin, end)]
    assert np.linalg.norm(rim[1] - rim[0]) > 1.3 * 0.1426
    out = np.empty((2, 13))
    for i, j in ((0, 1), (1, 0)):
        turn = enter_roll(rows, Arc(i, j, tuple(begin), tuple(end)), 0, 1, out)
        matrix, rise = out[0, :9].reshape(3, 3), out[0, 9:12]
        for g in np.eye(3):
            want, raised, length = rolled(rows, i, j, begin, end, g)
            assert np.abs(matrix @ g - want).max() < 2e-4
            # 60 steps over the rim are right to 1e-5; one pair of steps was off by 3e-3.
            assert rise @ g == pytest.approx(raised, abs=5e-5)
            assert turn == pytest.approx(length, abs=1e-4)


def speeding(rng: np.random.Generator) -> tuple[Floats, Arc]:
    """Return a wheel and a foot, and an arc on which the wheel's pace at least doubles."""
    while True:
        axle, begin, end = (v / np.linalg.norm(v) for v in rng.normal(size=(3, 3)))
        rows = pack(
            rng.uniform(-0.5, 0.5, (2, 3)),
            np.array([axle, np.zeros(3)]),
            np.array([0.2, 0.0]),
            np.array([2, 0]),
        )
        ends = [
            arc_normal(rows, Arc(0, 1, tuple(n), tuple(n)), 0.0)
            for n in (begin, (begin + 0.5 * end) / np.linalg.norm(begin + 0.5 * end))
        ]
        arc = Arc(0, 1, *ends)
        sines = [
            np.linalg.norm(np.cross(axle, arc_normal(rows, arc, part / 8))) for part in range(9)
        ]
        if max(sines) > 2.0 * min(sines) and min(sines) > 0.05:
            return rows, arc


def test_a_roll_is_the_same_from_either_end_and_whichever_contact_comes_first() -> None:
    rng, out, other = np.random.default_rng(3), np.empty((2, 13)), np.empty((2, 13))
    for _ in range(100):
        rows, arc = speeding(rng)
        enter_roll(rows, arc, 0, 1, out)
        enter_roll(rows, Arc(1, 0, arc.end, arc.begin), 0, 1, other)
        assert np.abs(out[::-1] - other).max() < 1e-12


def test_a_roll_is_right_where_a_wheel_runs_ever_faster_along_its_rim() -> None:
    rng, out, off = np.random.default_rng(3), np.empty((2, 13)), []
    for _ in range(30):
        rows, arc = speeding(rng)
        enter_roll(rows, arc, 0, 1, out)
        begin, end = np.array(arc.begin), np.array(arc.end)
        # Over the foot, whose place is known to the last digit.
        fine = [rolled(rows, 1, 0, begin, end, g, 500)[1] for g in np.eye(3)]
        off.append(np.abs(out[0, 9:12] - fine).max())
    # Pairs of 0.4 rad at any pace had a median of 3e-4, and 5e-3 in one of ten.
    assert np.median(off) < 2e-5
    assert np.percentile(off, 90) < 2e-4
