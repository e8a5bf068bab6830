"""Stability under forces and with an uncertain com: hand-worked, by brute force, by balance."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

import lutgen
from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.metrics import compare_metrics
from lutgen.analysis.sliding import slides_first, slopes
from lutgen.analysis.stance import Posture
from lutgen.channels.evaluation import evaluate_each
from lutgen.channels.scan import Scanner
from lutgen.channels.settle import body_gravity
from lutgen.chart import STANDARD_GRAVITY, gravito_inertial
from lutgen.quantities import CHANNELS
from lutgen.recipe.recipe import Recipe
from lutgen.search.objective import Objective
from tests.fixtures.recipes import contact, feet, rigid, tripod

Floats = NDArray[np.float64]
MASS = 10.0
WEIGHT = MASS * STANDARD_GRAVITY
FREE = "upright = 180.0\nrock_angle = 180.0"
BOX = [(0.4, 0.3, -0.5), (-0.4, 0.3, -0.5), (-0.4, -0.3, -0.5), (0.4, -0.3, -0.5)]
LEVEL = [0.0, 0.0, -1.0]


def array(values: Any) -> str:
    return str([float(x) for x in values])


def pull(force: Any, position: Any = (0, 0, 0), moment: Any = (0, 0, 0)) -> str:
    """Return the TOML of a force on the body."""
    return (
        f'[[robot.force]]\nname = "pull"\nlink = "body"\nposition = {array(position)}\n'
        f"force = {array(force)}\nmoment = {array(moment)}\n"
    )


def robot(
    contacts: str, force: str = "", rho: float = 0.0, com: Any = (0, 0, 0), head: str = FREE
) -> Recipe:
    """Return a rigid robot of 10 kg whose com is given."""
    body = f'[[robot.link]]\nname = "body"\nmass = {MASS}\ncom = {array(com)}\n'
    uncertain = f"\ncom_uncertainty = {rho!r}" if rho else ""
    return lutgen.parse_recipe(rigid(contacts + body + force, head=head + uncertain))


def read(recipe: Recipe, gravity: Any, *channels: str) -> Floats:
    """Return the first channel asked for, tip_angle by default, in each direction."""
    names = channels or ("tip_angle",)
    return lutgen.evaluate(recipe, np.zeros((1, 0)), gravity, names)[names[0]][0]


def directions(rng: np.random.Generator, count: int) -> Floats:
    """Return unit vectors that mostly point down."""
    g = rng.normal(size=(count, 3)) * [0.6, 0.6, 1.0]
    g[:, 2] = -np.abs(g[:, 2])
    return np.asarray(g / np.linalg.norm(g, axis=1)[:, None])


def around(rng: np.random.Generator, g: Floats, angle: Any, count: int) -> Floats:
    """Directions at an angle from g, every way round."""
    across = rng.normal(size=(count, 3))
    across -= (across @ g)[:, None] * g
    across /= np.linalg.norm(across, axis=1)[:, None]
    angle = np.broadcast_to(angle, count)[:, None]
    return np.asarray(np.cos(angle) * g + np.sin(angle) * across)


def cloud(rng: np.random.Generator, kind: str) -> str:
    """Contacts strewn below the com."""
    places = rng.normal(size=(rng.integers(4, 8), 3)) * [0.5, 0.4, 0.1] + [0, 0, -0.45]
    if kind == "points":
        return feet(places.tolist())
    axis = (0, 1, 0) if kind == "discs" else None
    return "".join(
        contact(f"P{i}", place, float(rng.uniform(0.05, 0.2)), axis)
        for i, place in enumerate(places.tolist())
    )


# No load


def test_a_load_of_zero_changes_no_bit() -> None:
    plain = robot(feet(BOX))
    zero = robot(feet(BOX), pull((0, 0, 0), (1, 2, 3)))
    g = directions(np.random.default_rng(1), 50)
    for name in CHANNELS:
        assert (read(plain, g, name) == read(zero, g, name)).sum() == (
            ~np.isnan(read(plain, g, name))
        ).sum()
    assert not zero.loaded


def test_the_loaded_kernel_with_next_to_no_load_says_what_the_plain_one_does() -> None:
    rng = np.random.default_rng(2)
    for kind, head in (("points", FREE), ("discs", "rock_angle = 40.0"), ("spheres", "")):
        for _ in range(8):
            contacts = cloud(rng, kind)
            g = directions(rng, 60)
            plain = robot(contacts, head=head)
            for loaded in (
                robot(contacts, pull((1e-12, 0, 0)), head=head),
                robot(contacts, rho=1e-15, head=head),
            ):
                for name in ("tip_angle", "margin", "sdg", "height", "facet"):
                    # 1e-12 N of 98 N, through asin near 1.
                    assert read(loaded, g, name) == pytest.approx(
                        read(plain, g, name), abs=1e-7, nan_ok=True
                    )


# Forces


def test_a_drawbar_tips_a_box_where_the_lever_rule_says() -> None:
    # About the rear edge: W (a cos t - h sin t) = P z at the tilt t, nose up.
    force, height, half, high = 30.0, 0.3, 0.4, 0.5
    box = robot(feet(BOX), pull((-force, 0, 0), (-0.4, 0, height - high)))
    size = math.hypot(half, high)
    tilt = math.acos(force * height / WEIGHT / size) - math.atan2(high, half)
    found = diagnose(Posture(box, []), LEVEL)
    rear = next(axis for axis in found.tip_over_axes if set(axis.names) == {"P2", "P3"})
    assert rear.tip_angle == pytest.approx(tilt, abs=1e-12)
    assert found.channels["tip_angle"] == pytest.approx(tilt, abs=1e-12)
    just = [[-math.sin(tilt + d), 0, -math.cos(tilt + d)] for d in (-1e-9, 1e-9)]
    assert (read(box, just) >= 0).tolist() == [True, False]
    # The resultant meets the ground P z / W behind the com, and its line passes that edge at
    # (a - P z / W) cos(slope of the resultant).
    back = force * height / WEIGHT
    assert found.facet is not None
    assert found.pierced == pytest.approx([-back, 0, -high], abs=1e-12)
    assert found.channels["sdg"] == pytest.approx(back, abs=1e-12)
    lean = math.atan2(force, WEIGHT)
    assert rear.margin == pytest.approx((half - back) * math.cos(lean), abs=1e-12)
    assert found.slope == pytest.approx(lean, abs=1e-12)
    assert sum(found.normal_forces.values()) == pytest.approx(1.0)
    rear_share = found.normal_forces["P2"] + found.normal_forces["P3"]
    assert rear_share == pytest.approx(0.5 + back / (2 * half), abs=1e-12)


def test_a_strong_force_holds_an_axis_down_for_ever_or_tips_the_robot_always() -> None:
    down = robot(feet(BOX), pull((0, 0, -3 * WEIGHT)))
    up = robot(feet(BOX), pull((0, 0, 3 * WEIGHT)))
    everywhere = np.random.default_rng(3).normal(size=(50, 3))
    assert read(down, everywhere) == pytest.approx(math.pi)
    assert read(up, everywhere) == pytest.approx(-math.pi)


def test_a_force_through_the_com_has_the_verdict_of_the_resultants_direction() -> None:
    rng = np.random.default_rng(4)
    for kind, head in (
        ("points", FREE),
        ("discs", "rock_angle = 40.0"),
        ("points", "upright = 50.0\nrock_angle = 12.0"),
    ):
        for _ in range(8):
            contacts, force = cloud(rng, kind), rng.normal(size=3) * 0.2
            g = directions(rng, 80)
            loaded = robot(contacts, pull(force * WEIGHT), head=head)
            plain = robot(contacts, head=head)
            there = read(plain, g + force)
            clear = np.abs(there) > 1e-9
            assert ((read(loaded, g) >= 0) == (there >= 0))[clear].all()
            for name in ("sdg", "height", "facet"):
                got = read(loaded, g, name)[clear]
                assert got == pytest.approx(
                    read(plain, g + force, name)[clear], abs=1e-9, nan_ok=True
                )


@pytest.mark.parametrize(
    ("kind", "head", "moment"),
    [
        ("points", FREE, 0.0),
        ("points", FREE, 1.0),
        ("points", "upright = 60.0\nrock_angle = 15.0", 0.0),
        ("points", "upright = 60.0\nrock_angle = 15.0", 1.0),
        ("discs", "rock_angle = 40.0", 0.0),
        ("discs", "rock_angle = 40.0", 1.0),
        ("spheres", "", 1.0),
    ],
)
def test_no_direction_nearer_than_the_tip_angle_tips(kind: str, head: str, moment: float) -> None:
    rng = np.random.default_rng(5)
    tight = looked = 0
    for _ in range(6):
        contacts = cloud(rng, kind)
        force = pull(
            rng.normal(size=3) * 0.2 * WEIGHT,
            rng.normal(size=3) * 0.3 * moment,
            rng.normal(size=3) * 0.03 * WEIGHT * moment,
        )
        exact = robot(contacts, force, head=head)
        for rho in (0.0, 0.03):
            bound = robot(contacts, force, rho, head=head)
            g = directions(rng, 40)
            angle = read(bound, g)
            a, b = rng.integers(0, 40, (2, 200))
            apart = np.arccos(np.clip((g[a] * g[b]).sum(axis=1), -1, 1))
            inside = (angle[a] >= 0) & (angle[b] >= 0)
            assert (np.abs(angle[a] - angle[b]) <= apart + 1e-7)[inside].all()
            for i in np.flatnonzero((angle > 1e-6) & (angle < 3.0))[:8]:
                near = around(rng, g[i], angle[i] * rng.uniform(0.5, 0.9999, 500), 500)
                assert (read(exact, near) >= 0).all()
                if rho == 0.0:
                    looked += 1
                    ring = around(rng, g[i], 1.01 * angle[i] + 1e-4, 3000)
                    tight += bool((read(exact, ring) < 0).any())
    # Nothing smaller would do: of a convex region a direction just beyond tips, always.
    if head == FREE:
        assert tight == looked > 20


def balanced(points: Floats, normal: Floats, resultant: Floats, moment: Floats) -> bool:
    """Whether pushing normal forces and any friction balance a wrench about the com."""
    columns = []
    frame = np.linalg.svd(normal[None])[2]
    for point in points:
        for way in (-normal, frame[1], -frame[1], frame[2], -frame[2]):
            columns.append([*way, *np.cross(point, way)])
    found = linprog(
        np.zeros(len(columns)),
        A_eq=np.transpose(columns),
        b_eq=-np.concatenate([resultant, moment]),
    )
    return bool(found.status == 0)


def test_the_verdict_is_that_of_a_linear_programme_for_the_contact_forces() -> None:
    rng = np.random.default_rng(6)
    seen = set()
    for case in range(24):
        # In one plane any force will do; a cloud, many facets, takes those without a moment.
        flat = case % 2 == 0
        points = rng.normal(size=(5, 3)) * [0.5, 0.4, 0.0 if flat else 0.1] + [0, 0, -0.4]
        if flat:
            points[:, 2] += points[:, :2] @ [0.1, -0.2]
        force, place = rng.normal(size=3) * 0.2, rng.normal(size=3) * (0.3 if flat else 0.0)
        twist = rng.normal(size=3) * (0.03 if flat else 0.0)
        loaded = robot(feet(points.tolist()), pull(force * WEIGHT, place, twist * WEIGHT))
        faces: list[tuple[Floats, Floats]] = []
        if flat:
            normal = np.array([0.1, -0.2, -1.0])
            faces.append((points, normal / np.linalg.norm(normal)))
        else:
            hull = ConvexHull(points)
            for corners, (*normal_, level) in zip(hull.simplices, hull.equations, strict=True):
                if level < 0:
                    faces.append((points[corners], np.array(normal_)))
        for g in directions(rng, 12):
            angle = read(loaded, g)[0]
            if abs(angle) < 1e-6:
                continue
            moment = np.cross(place, force) + twist
            carried = any(balanced(p, n, g + force, moment) for p, n in faces)
            assert carried == (angle >= 0)
            seen.add(carried)
    assert seen == {True, False}


def test_about_the_zero_moment_point_no_moment_lies_in_the_plane() -> None:
    rng = np.random.default_rng(7)
    for _ in range(20):
        force, place = rng.normal(size=3) * 0.1, rng.normal(size=3) * 0.2
        loaded = robot(feet(BOX), pull(force * WEIGHT, place))
        found = diagnose(Posture(loaded, []), LEVEL)
        assert found.facet is not None
        about = np.cross(place - found.pierced, force)
        about += np.cross(-found.pierced, LEVEL)
        assert np.cross(found.facet.normal, about) == pytest.approx(np.zeros(3), abs=1e-12)
        assert found.facet.points @ found.facet.normal == pytest.approx(0.5)
        apart = float(np.linalg.norm(found.pierced - found.facet.centroid))
        assert found.channels["sdg"] == pytest.approx(apart, abs=1e-12)
        points = np.array([BOX[int(n[1]) - 1] for n in found.normal_forces])
        centre = np.array(list(found.normal_forces.values())) @ points
        assert centre == pytest.approx(found.pierced, abs=1e-9)


# An uncertain com


def worst(contacts: str, g: Floats, rho: float, head: str, count: int, force: str = "") -> Floats:
    """Return the least tip angle over coms on the sphere of radius rho, by the plain kernel."""
    rng = np.random.default_rng(8)
    places = rng.normal(size=(count, 3))
    places *= rho / np.linalg.norm(places, axis=1)[:, None]
    readings = [read(robot(contacts, force, com=place, head=head), g) for place in places]
    return np.asarray(np.min(readings, axis=0))


def test_the_planes_of_a_box_turn_inward_by_the_angle_of_the_ball() -> None:
    box = robot(feet(BOX), rho=0.05)
    side = math.atan2(0.3, 0.5) - math.asin(0.05 / math.hypot(0.3, 0.5))
    assert read(box, LEVEL)[0] == pytest.approx(side, abs=1e-12)
    assert read(box, LEVEL, "margin")[0] == pytest.approx(0.25, abs=1e-12)
    assert read(box, LEVEL, "height")[0] == pytest.approx(0.5)
    # The com must be above the feet wherever it is in the ball.
    assert read(robot(feet(BOX), rho=0.4999), LEVEL, "facet")[0] == -1.0
    assert read(robot(feet(BOX), rho=0.501), LEVEL)[0] == -math.pi


def test_of_points_it_is_the_least_over_all_coms_of_the_ball() -> None:
    rng = np.random.default_rng(9)
    for _ in range(4):
        contacts, rho, g = cloud(rng, "points"), rng.uniform(0.01, 0.06), directions(rng, 40)
        reduced = read(robot(contacts, rho=rho), g)
        truth = worst(contacts, g, rho, FREE, 500)
        assert (reduced <= truth + 1e-9).all()
        # 500 coms leave gaps of 0.1 rad on the ball: rho (1 - cos(0.1)) / d.
        assert reduced == pytest.approx(truth, abs=2e-3)
        assert ((reduced >= 0) == (truth >= 0))[np.abs(truth) > 2e-3].all()


@pytest.mark.parametrize(
    ("kind", "head"),
    [
        ("points", "upright = 60.0\nrock_angle = 0.0"),
        ("discs", "rock_angle = 40.0"),
        ("spheres", ""),
    ],
)
def test_of_any_region_it_is_never_above_the_least_and_close_to_it(kind: str, head: str) -> None:
    rng = np.random.default_rng(10)
    for _ in range(4):
        contacts, rho, g = cloud(rng, kind), rng.uniform(0.01, 0.06), directions(rng, 40)
        reduced = read(robot(contacts, rho=rho, head=head), g)
        truth = worst(contacts, g, rho, head, 150)
        assert (reduced <= truth + 1e-9).all()
        # The same with 150 coms, where it stands.
        stands = reduced >= 0
        assert reduced[stands] == pytest.approx(truth[stands], abs=8e-3)


@pytest.mark.parametrize(
    ("kind", "head"), [("points", FREE), ("points", "rock_angle = 15.0"), ("discs", "")]
)
def test_with_a_force_too_it_is_never_above_the_least_over_all_coms(kind: str, head: str) -> None:
    rng = np.random.default_rng(13)
    short = []
    for _ in range(4):
        contacts, rho, g = cloud(rng, kind), rng.uniform(0.01, 0.06), directions(rng, 40)
        force = pull(rng.normal(size=3) * 0.2 * WEIGHT, rng.normal(size=3) * 0.3)
        reduced = read(robot(contacts, force, rho, head=head), g)
        truth = worst(contacts, g, rho, head, 150, force)
        stands = reduced >= 0
        assert (reduced <= truth + 1e-9)[stands].all()
        assert not ((truth < 0) & stands).any()
        short += (truth - reduced)[stands].tolist()
    # A bound, but no empty one: where it stands it gives away a degree or so.
    assert len(short) > 20
    assert np.median(short) < math.radians(1.5)


def test_the_signs_of_all_channels_agree_under_any_load() -> None:
    rng = np.random.default_rng(11)
    for kind, head in (("points", FREE), ("discs", "rock_angle = 40.0"), ("spheres", "")):
        for rho in (0.0, 0.02):
            force = pull(rng.normal(size=3) * 20, rng.normal(size=3) * 0.2)
            loaded = robot(cloud(rng, kind), force, rho, head=head)
            got = lutgen.evaluate(loaded, np.zeros((1, 0)), directions(rng, 200), CHANNELS)
            stands = got["tip_angle"] >= 0
            assert ((got["margin"] >= 0) == stands).all()
            assert (np.isfinite(got["sdg"]) == stands).all()
            assert (np.isfinite(got["height"]) == stands).all()
            assert ((got["facet"] >= 0) == stands).all()
            assert np.isnan(got["energy_margin"]).all()


def test_turning_and_scaling_everything_changes_nothing_but_the_lengths() -> None:
    rng = np.random.default_rng(12)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    points = np.array(BOX) + rng.normal(size=(4, 3)) * 0.05
    force, place, twist = rng.normal(size=3) * 15, rng.normal(size=3) * 0.2, rng.normal(size=3)
    g = directions(rng, 60)
    for rho in (0.0, 0.02):
        one = robot(feet(points.tolist()), pull(force, place, twist), rho)
        other = robot(
            feet((3 * points @ turn.T).tolist()),
            pull(turn @ force, 3 * turn @ place, 3 * turn @ twist),
            3 * rho,
        )
        for name, factor in (("tip_angle", 1.0), ("margin", 3.0), ("sdg", 3.0)):
            want = factor * read(one, g, name)
            # asin near 1 turns 1e-16 into 1e-8.
            assert read(other, g @ turn.T, name) == pytest.approx(want, abs=1e-7, nan_ok=True)


# Every way to a reading


def moving() -> Recipe:
    """Return the tripod with a payload and a force on its leg and an uncertain com."""
    extra = (
        '[[robot.payload]]\nname = "tool"\nlink = "leg"\nposition = [0.1, 0, 0]\nmass = 0.5\n'
        '[[robot.force]]\nname = "pull"\nlink = "leg"\nposition = [0.3, 0, 0]\nforce = [0, 6, -4]\n'
    )
    return lutgen.parse_recipe(
        tripod(head="friction = 0.8\ncom_uncertainty = 0.03", contacts=extra)
    )


def test_pairs_sweeps_and_diagnoses_read_what_evaluate_reads() -> None:
    recipe = moving()
    params = recipe.grid.params(np.arange(recipe.grid.size))
    g = recipe.chart.directions().reshape(-1, 3)
    names = ("sdg", "height", "tip_angle", "margin", "facet")
    got = lutgen.evaluate(recipe, params, g, names)
    assert (got["tip_angle"] >= 0).any()
    assert (got["tip_angle"] < 0).any()
    scanner = Scanner(recipe, recipe.chart, names)
    for first, last in ((0, scanner.rows), (2, 5)):
        out = np.full(
            (len(CHANNELS), len(params) * (last - first) * recipe.chart.nodes), 7.0, np.float32
        )
        assert scanner.fill(params, first, last, out) == 0
        for name in names:
            want = got[name].reshape(len(params), scanner.rows, -1)[:, first:last]
            mapped = out[CHANNELS.index(name)]
            assert (mapped == want.ravel().astype(np.float32)).sum() == np.isfinite(want).sum()
    for i, j in ((0, 3), (5, 24), (11, 40)):
        pair = evaluate_each(recipe, params[[i]], g[[j]], names)
        found = diagnose(Posture(recipe, params[i]), g[j])
        for name in names:
            assert pair[name][0] == pytest.approx(got[name][i, j], abs=0, nan_ok=True)
            assert found.channels[name] == pytest.approx(got[name][i, j], abs=0, nan_ok=True)
        assert min(axis.tip_angle for axis in found.tip_over_axes) == pytest.approx(
            found.channels["tip_angle"]
        )


def test_the_slope_is_that_of_the_resultant_and_friction_is_asked_of_it() -> None:
    recipe = moving()
    params = recipe.grid.params(np.arange(recipe.grid.size))
    g = recipe.chart.directions().reshape(-1, 3)
    got = slopes(recipe, params, np.broadcast_to(g, (len(params), *g.shape)))
    slides = slides_first(recipe, params, g)
    assert slides.any()
    assert not slides.all()
    for i, j in ((0, 3), (5, 24), (11, 40)):
        found = diagnose(Posture(recipe, params[i]), g[j])
        assert got[i, j] == pytest.approx(found.slope, abs=1e-7)
        assert slides[i, j] == found.slides
    # About 10 N across 64 N.
    assert (
        abs(got[0, 24] - diagnose(Posture(lutgen.parse_recipe(tripod()), params[0]), g[24]).slope)
        > 0.02
    )


def test_what_knows_the_weight_alone_refuses_forces() -> None:
    pulled, uncertain = robot(feet(BOX), pull((5, 0, 0))), robot(feet(BOX), rho=0.01)
    with pytest.raises(lutgen.InputError, match="counts the weight and no other force"):
        compare_metrics(Posture(pulled, []), LEVEL)
    with pytest.raises(lutgen.InputError, match="metrics are those of one com"):
        compare_metrics(Posture(uncertain, []), LEVEL)


def test_a_payload_moves_the_com_as_a_link_of_its_mass_does() -> None:
    recipe = lutgen.parse_recipe(
        rigid(
            feet(BOX)
            + '[[robot.link]]\nname = "body"\nmass = 6.0\n'
            + '[[robot.payload]]\nname = "tool"\nlink = "body"\n'
            + "position = [0.4, 0, 0.2]\nmass = 2.0\n"
        )
    )
    assert lutgen.postures(recipe, np.zeros((1, 0)))[1][0] == pytest.approx([0.1, 0.0, 0.05])


def test_a_wheel_pressed_down_decides_on_which_facet_the_robot_rests() -> None:
    # A roof: level feet at x = +-1 and a ridge at x = 0 below them.
    roof = [(1, 1, -0.9), (1, -1, -0.9), (0, 1, -1), (0, -1, -1), (-1, 1, -0.9), (-1, -1, -0.9)]
    ground = [0.0, 0.0, -1.0]
    for side in (1.0, -1.0):
        loaded = robot(feet(roof), pull((0, 0, -20), (side, 0, 0)))
        down = body_gravity(loaded, np.zeros((1, 0)), ground, "plane")[0]
        assert math.copysign(1.0, down[0]) == side
        assert read(loaded, down)[0] > 0


def test_braking_and_turning_shift_gravity_and_free_fall_is_refused() -> None:
    assert gravito_inertial(LEVEL, [0, 0, 0]).tolist() == LEVEL
    tan = 3.0 / STANDARD_GRAVITY
    felt = gravito_inertial(LEVEL, [0, -3.0, 0])
    assert felt[1] / -felt[2] == pytest.approx(tan)
    with pytest.raises(lutgen.InputError, match="free fall"):
        gravito_inertial(LEVEL, [0, 0, -STANDARD_GRAVITY])
    with pytest.raises(lutgen.InputError, match="three finite numbers"):
        gravito_inertial(LEVEL, [0, math.nan, 0])


# What is refused


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mass = 0.0", "must be above 0"),
        ("mass = -1.0", "must be above 0"),
        ('mass = 1.0\nlinks = "body"', "is not a known key"),
    ],
)
def test_a_payload_that_makes_no_sense_is_refused(text: str, words: str) -> None:
    payload = f'[[robot.payload]]\nname = "tool"\nlink = "body"\nposition = [0, 0, 0]\n{text}\n'
    with pytest.raises(lutgen.RecipeError, match=words):
        robot(feet(BOX), payload)


@pytest.mark.parametrize("kind", ["payload", "force"])
def test_a_robot_without_masses_carries_nothing(kind: str) -> None:
    value = "mass = 1.0" if kind == "payload" else "force = [1, 0, 0]"
    entry = f'[[robot.{kind}]]\nname = "x"\nlink = "body"\nposition = [0, 0, 0]\n{value}\n'
    with pytest.raises(lutgen.RecipeError, match="give its links masses"):
        lutgen.parse_recipe(rigid(feet(BOX) + entry))
    with pytest.raises(lutgen.RecipeError, match="is not a link of the robot"):
        robot(feet(BOX), entry.replace('"body"', '"trunk"'))
    with pytest.raises(lutgen.RecipeError, match="is given twice"):
        robot(feet(BOX), entry + entry)


def test_a_negative_uncertainty_and_an_energy_margin_under_a_load_are_refused() -> None:
    with pytest.raises(lutgen.RecipeError, match="com_uncertainty"):
        robot(feet(BOX), head="com_uncertainty = -0.1")
    text = rigid(feet(BOX), head="com_uncertainty = 0.1", channels=("tip_angle", "energy_margin"))
    with pytest.raises(lutgen.RecipeError, match="energy_margin is not defined"):
        lutgen.parse_recipe(text)
    with pytest.raises(lutgen.InputError, match="energy_margin is not defined"):
        Objective(robot(feet(BOX), rho=0.1), LEVEL, "energy_margin")
