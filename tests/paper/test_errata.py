"""The errata of the paper: each printed form is wrong, each correction right, on any robot."""

import math
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from lutgen.analysis.forces import heuristic_forces, normal_forces
from lutgen.channels.evaluation import stability
from lutgen.paper import checks_polygon, checks_text, closed_form, printed, reference
from lutgen.paper.checks_path import equal_spacing, gaussian_spacing, steeper_than_the_limit
from lutgen.paper.checks_statics import line_distances, point_distances
from lutgen.paper.errata import CHECKS, ROWS, errata
from lutgen.paper.erratum import Check, Erratum, Example
from lutgen.paper.forces import (
    exact_forces,
    force_statistics,
    force_table,
    pierced_point,
    slope_gravity,
)
from lutgen.paper.nominal import DOWN, NOMINAL_DEG, nominal_wheels, tripods
from lutgen.paper.published import PRINTED, numbers_of
from lutgen.paper.reference import four_contacts
from lutgen.paper.triples import leaving_facet, passing_triples, triple_statistics

Array = NDArray[np.float64]

FOUND = errata()
NAMES = [erratum.place for erratum in FOUND]
# Places whose numbers are those of the example robot; the others are counts or the paper's robot.
OF_THE_EXAMPLE = {
    "Eq 3",
    "Eqs 4 to 7",
    "text before Eq 3",
    "text before Eq 8, first successful case",
    "Eqs 8 to 11",
    "text before Eq 8",
    "text before Eq 1 against text before Eq 12",
    "Eq 12, moments",
    "Eq 16",
    "text before Eq 18",
    "text before Eq 20",
    "text before Eq 20, four wheels and more",
    "text before Eq 21",
    "block diagram, Figure 6",
    "text before Eq 22",
    "Eq 24",
    "Eqs 25 and 26",
    "Eqs 24 to 27, vertical plane",
    "Eq 27",
    "Eq 29",
}


def another(seed: int) -> Example:
    """Return a random robot as `Example` asks for: a tilted triangle, gravity through it."""
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0.0, 2.0 * np.pi) + np.array([0.0, 2.0, 4.0]) + rng.uniform(-0.3, 0.3, 3)
    radius = rng.uniform(6.0, 14.0, 3)
    below = rng.uniform(-9.0, -6.0, 3)
    return Example(
        wheels=np.column_stack([radius * np.cos(turn), radius * np.sin(turn), below]),
        gravity=rng.uniform(1.0, 20.0) * np.append(rng.uniform(-0.2, 0.2, 2), -1.0),
        elements=rng.normal(size=(5, 3)),
        masses=rng.uniform(1.0, 4.0, 5),
        seed=seed,
    )


def by_place(found: tuple[Erratum, ...]) -> dict[str, Erratum]:
    return {erratum.place: erratum for erratum in found}


def agrees(value: float, check: Check) -> bool:
    """Return whether a number of a check is its reference; never for NaN."""
    return bool(abs(value - check.reference) <= check.tolerance)


def numbers(erratum: Erratum) -> list[float]:
    """Return the numbers of all checks without NaN."""
    every = [x for c in erratum.checks for x in (c.printed, c.ours, c.reference)]
    return [x for x in every if not math.isnan(x)]


def test_every_place_is_listed_once_and_says_what_why_and_how() -> None:
    assert len(set(NAMES)) == len(NAMES)
    for erratum in FOUND:
        for text in (erratum.printed, erratum.correct, erratum.why):
            assert text.strip()
        assert (erratum.correct.startswith("as printed")) is erratum.confirmed, erratum.place
        assert erratum.printed != erratum.correct


def test_every_erratum_names_its_checks_and_every_check_serves_one_erratum() -> None:
    named = [name for row in ROWS for name in row["checks"]]
    assert all(row["checks"] for row in ROWS)
    assert sorted(named) == sorted(CHECKS)
    assert all(erratum.checks for erratum in FOUND)


@pytest.mark.parametrize(
    ("place", "kind", "number", "wrong"),
    [
        ("text before Eq 14", "equations", "13", "S_M"),
        ("text after Figure 9, minimum of the stability map", "figures", "10", "A map."),
        ("third method, figure references", "figures", "13", "The result of the 2nd step."),
    ],
)
def test_a_reference_to_a_number_is_looked_up_in_what_the_paper_prints(
    monkeypatch: pytest.MonkeyPatch, place: str, kind: str, number: str, wrong: str
) -> None:
    (row,) = (row for row in ROWS if row["place"] == place)
    (name,) = row["checks"]
    said = {**PRINTED[kind], number: wrong, "40": PRINTED[kind][number]}
    monkeypatch.setitem(PRINTED, kind, said)
    try:
        agree = [agrees(c.ours, c) for c in CHECKS[name](Example())]
    except ValueError:
        # No number, or more than one, has the words.
        return
    assert not all(agree)


def test_words_of_equations_and_captions_are_found_by_number() -> None:
    assert numbers_of("equations", "S_MO") == [13]
    assert numbers_of("figures", "stability map") == [10, 11]
    assert list(PRINTED["figures"]) == [str(number) for number in range(1, 18)]
    assert list(PRINTED["equations"]) == [str(number) for number in range(1, 22)]


@pytest.mark.parametrize("erratum", [e for e in FOUND if not e.confirmed], ids=lambda e: e.place)
def test_the_printed_form_is_wrong_and_the_correction_right(erratum: Erratum) -> None:
    for c in erratum.checks:
        # Each check names its own tolerance, rounding unless the paper has few digits.
        assert abs(c.ours - c.reference) <= c.tolerance, c
        assert agrees(c.ours, c)
        assert not agrees(c.printed, c)
        if not math.isnan(c.printed):
            # The slightest is Table 1's angle of |SD_g| = 0, by 0.005 in 31 deg.
            assert abs(c.printed - c.reference) > 1e-4 * abs(c.reference), c
            assert abs(c.printed - c.reference) > 3.0 * c.tolerance, c


@pytest.mark.parametrize("erratum", [e for e in FOUND if e.confirmed], ids=lambda e: e.place)
def test_a_confirmed_form_agrees_as_printed(erratum: Erratum) -> None:
    assert erratum.checks
    for c in erratum.checks:
        assert agrees(c.printed, c), c
        assert agrees(c.ours, c), c
        assert c.reference != 0.0


@pytest.mark.parametrize("seed", range(1, 9))
def test_the_verdicts_hold_for_any_robot_and_the_numbers_change_with_it(seed: int) -> None:
    first, other = by_place(FOUND), by_place(errata(another(seed)))
    assert list(first) == list(other)
    for place, erratum in other.items():
        for c in erratum.checks:
            assert agrees(c.ours, c), c
            assert agrees(c.printed, c) is erratum.confirmed, c
        if place in OF_THE_EXAMPLE:
            assert numbers(erratum) != numbers(first[place]), place


def test_nothing_is_kept_between_calls() -> None:
    for before, after in zip(FOUND, errata(), strict=True):
        assert before.place == after.place
        assert numbers(before) == numbers(after)


def test_errata_are_invariant_to_the_length_of_gravity() -> None:
    robot = Example()
    longer = by_place(errata(Example(gravity=7.0 * robot.gravity)))
    for place, erratum in by_place(FOUND).items():
        # The torque of gravity and t_1 of the wrong line are the two that have its length.
        if place not in ("text before Eq 18", "Eq 3"):
            # A few operations on numbers below 100.
            assert numbers(longer[place]) == pytest.approx(numbers(erratum), abs=1e-11), place


def test_random_directions_follow_the_seed_of_the_example() -> None:
    place = "text before Eq 3"
    counts = {errata(Example(seed=seed))[NAMES.index(place)].checks[0].ours for seed in range(4)}
    assert len(counts) > 1


def test_printed_equations_by_hand() -> None:
    # A right angle in the plane z = -2, with g at 45 deg.
    corners = np.array([[4.0, -2.0, -2.0], [-2.0, -2.0, -2.0], [-2.0, 4.0, -2.0]])
    normal, gravity = np.array([0.0, 0.0, 1.0]), np.array([3.0, 0.0, -3.0])
    assert printed.normal_of(corners).tolist() == printed.normal_of(corners[::-1]).tolist()
    assert printed.normal_of(corners) == pytest.approx(normal)
    # -(z1 - g_z)/g_z = -(-2 + 3)/-3.
    assert printed.eq7(normal, corners[0], gravity) == pytest.approx(1 / 3)
    assert printed.eq4_to_6(gravity, 1 / 3) == pytest.approx([2.0, 0.0, -2.0])
    assert printed.eq8_to_11(-5.0 * normal, corners[0]) == pytest.approx([0.0, 0.0, -2.0])
    assert printed.eq2(7) == 35.0
    assert printed.eq16(np.array([1.0, 2.0, 3.0]), 2.0, np.array([0.0, 1.0, 1.0])).tolist() == [
        *(1.0, 0.0, 1.0)
    ]
    assert printed.eq22_23(corners) == pytest.approx([0.0, 0.0])
    assert printed.eq24(corners) == 18.0
    assert printed.eq28(np.array([2.0, -3.0, 6.0])) == 7.0
    assert printed.eq29(np.array([2.0, 0.0, -2.0]), np.array([0.0, 0.0, -2.0])) == 2.0
    # L = 1, 2, 3, 4: (10/(4/2) - L)/10 with the minus.
    assert printed.eq12(np.array([1.0, 2.0, 3.0, 4.0])) == pytest.approx([-0.4, -0.3, -0.2, -0.1])
    assert printed.eq32(np.pi / 2) == pytest.approx(1.6 / np.pi)
    assert printed.eq33(np.pi / 2) == pytest.approx(30.0 / np.pi)


# Eq 27 ------------------------------------------------------------------------------------------


def test_eq_27_gives_the_three_wrong_heights_of_one_triangle_whose_centre_is_at_minus_6_5() -> None:
    checks = by_place(FOUND)["Eq 27"].checks
    # Mean of -6, -6.5 and -7.
    assert [c.ours for c in checks] == pytest.approx([-6.5] * 3, abs=1e-12)
    # Worked out to three decimals; half of the last.
    assert checks[0].printed == pytest.approx(-6.488, abs=5e-4)
    assert checks[1].printed == pytest.approx(-23.96, abs=5e-3)
    assert checks[2].printed == pytest.approx(6.45, abs=5e-3)


def test_eq_27_by_hand_in_fractions() -> None:
    # Edges (-16, 10, -1/2) and (-15, -7, -1); their cross product is the normal, not of length 1.
    a, b, c = Fraction(-27, 2), Fraction(-17, 2), Fraction(262)
    sx, sy = Fraction(-1, 3), Fraction(0)
    offset = 10 * a - b - 6 * c
    assert (offset - a * sx - b * sy) / c == Fraction(-13, 2)
    literal = offset - (a * sx + b * sy) / c
    normal, corner = np.array([-13.5, -8.5, 262.0]), np.array([10.0, -1.0, -6.0])
    assert printed.eq27(normal, corner, -1 / 3, 0.0) == pytest.approx(float(literal), rel=1e-14)
    corrected = checks_polygon.eq27_corrected(normal, corner, -1 / 3, 0.0)
    assert corrected == pytest.approx(-6.5, rel=1e-14)
    # With the normal scaled to c = 1, and only then, the printed form is right.
    assert printed.eq27(normal / 262.0, corner, -1 / 3, 0.0) == pytest.approx(-6.5, rel=1e-14)


@pytest.mark.parametrize("tilt", [0.05, 0.2, 0.7])
def test_the_error_of_eq_27_for_a_unit_normal_is_the_offset_times_1_minus_1_over_c(
    tilt: float,
) -> None:
    turn = np.array(
        [[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]]
    )
    wheels = nominal_wheels() @ turn.T
    normal = printed.normal_of(wheels)
    sx, sy = wheels[:, :2].mean(axis=0)
    error = printed.eq27(normal, wheels[0], sx, sy) - wheels[:, 2].mean()
    # The plane is 12 below the com: 12 (1/cos - 1), about 12 tilt^2/2.
    assert error == pytest.approx(12.0 * (1.0 / math.cos(tilt) - 1.0), rel=1e-9)


# Forces -----------------------------------------------------------------------------------------


def test_the_force_table_has_the_printed_four_digits() -> None:
    rows = force_table()
    want = [
        (0, 0, (0.3333, 0.3333, 0.3333), (0.3333, 0.3333, 0.3333), 0.0),
        (10, 0, (0.2628, 0.3686, 0.3686), (0.2992, 0.3504, 0.3504), 0.036),
        (20, 0, (0.1877, 0.4061, 0.4061), (0.2658, 0.3671, 0.3671), 0.078),
        (30, 0, (0.1024, 0.4488, 0.4488), (0.2331, 0.3834, 0.3834), 0.131),
        (39.7, 0, (0.0012, 0.4994, 0.4994), (0.2029, 0.3986, 0.3986), 0.202),
        (30, 180, (0.5643, 0.2179, 0.2179), (0.4542, 0.2729, 0.2729), 0.110),
        (58, 180, (0.9735, 0.0133, 0.0133), (0.6551, 0.1725, 0.1725), 0.318),
        (30, 90, (0.3333, 0.1333, 0.5333), (0.3243, 0.2424, 0.4334), 0.109),
    ]
    assert len(rows) == len(want)
    for row, (pitch, heading, exact, rough, error) in zip(rows, want, strict=True):
        assert (row.pitch_deg, row.heading_deg) == (pitch, heading)
        # Half of the last digit.
        assert row.exact == pytest.approx(exact, abs=5.1e-5)
        assert row.heuristic == pytest.approx(rough, abs=5.1e-5)
        assert row.largest_error == pytest.approx(error, abs=5.1e-4)


def test_the_force_table_does_not_depend_on_the_size_but_on_the_shape() -> None:
    rows = force_table()
    for row, doubled in zip(rows, force_table(2.0 * nominal_wheels()), strict=True):
        assert doubled.exact == pytest.approx(row.exact, abs=1e-12)
        assert doubled.heuristic == pytest.approx(row.heuristic, abs=1e-12)
    lower = force_table(nominal_wheels() * [1.0, 1.0, 0.5])
    # At half the height the load moves half as far: 1/3 - tan(30 deg) 6/30.
    assert lower[3].exact[0] == pytest.approx(1 / 3 - math.tan(math.pi / 6) / 5.0, abs=1e-12)


def test_exact_forces_are_the_areas_of_the_triangles_opposite_to_each_wheel() -> None:
    for robot in map(another, range(1, 9)):
        pierced = pierced_point(robot.wheels, robot.gravity)
        arms = robot.wheels - pierced
        areas = np.linalg.norm(
            np.cross(np.roll(arms, -1, axis=0), np.roll(arms, 1, axis=0)), axis=1
        )
        shares = exact_forces(robot.wheels, robot.gravity)
        # Solves of 3 x 3 systems against areas.
        assert shares == pytest.approx(areas / areas.sum(), abs=1e-11)
        assert shares == pytest.approx(normal_forces(robot.wheels, pierced), abs=1e-11)


def test_beyond_the_tip_over_axis_the_lifted_wheel_would_have_to_pull() -> None:
    # atan(10/12) = 39.81 deg.
    for pitch, sign in ((39.8, 1.0), (39.82, -1.0), (50.0, -1.0)):
        gravity = slope_gravity(math.radians(pitch), 0.0)
        shares = exact_forces(nominal_wheels(), gravity)
        assert sign * shares[0] > 0.0
        assert shares.sum() == pytest.approx(1.0, abs=1e-12)
        assert shares[0] == pytest.approx(1 / 3 - 0.4 * math.tan(math.radians(pitch)), abs=1e-12)


def test_errors_of_eq_12_over_random_loads() -> None:
    equilateral, anyhow = force_statistics()
    # 200 000 loads: three standard errors of the means are below 0.001, of the percentiles and
    # of a share of 0.128 below 0.0025.  The worst only grows with the number of loads, to 1/3.
    assert equilateral.mean == pytest.approx(0.152, abs=1.5e-3)
    assert equilateral.p95 == pytest.approx(0.266, abs=2.5e-3)
    assert 0.331 <= equilateral.worst < 1 / 3
    assert equilateral.negative == 0.0
    assert anyhow.mean == pytest.approx(0.218, abs=1.5e-3)
    assert anyhow.p95 == pytest.approx(0.417, abs=2.5e-3)
    assert 0.637 <= anyhow.worst < 2 / 3
    assert anyhow.negative == pytest.approx(0.128, abs=2.5e-3)


def test_force_statistics_follow_their_seed_and_count() -> None:
    assert force_statistics(2000, 1) == force_statistics(2000, 1)
    assert force_statistics(2000, 1)[1] != force_statistics(2000, 2)[1]
    # Against the library's function, one load at a time, in the same order of random numbers.
    rng = np.random.default_rng(5)
    shares, corners = rng.dirichlet(np.ones(3), 300), rng.random((300, 3, 2))
    rough = np.array([heuristic_forces(t, w @ t) for t, w in zip(corners, shares, strict=True)])
    found = force_statistics(300, 5)[1]
    assert found.worst == pytest.approx(np.abs(rough - shares).max(), abs=1e-12)
    assert found.negative == (rough.min(axis=1) < 0.0).mean()


def test_the_two_definitions_of_l_agree_only_if_plane_and_gravity_are_level() -> None:
    wheels, down = nominal_wheels(), np.array([0.0, 0.0, -9.81])
    assert line_distances(wheels, down) == pytest.approx(point_distances(wheels, down), abs=1e-12)
    leaning = np.array([1.0, 0.0, -3.0])
    # A level contact plane alone is not enough, nor is gravity along -z alone.
    assert abs(line_distances(wheels, leaning) - point_distances(wheels, leaning)).max() > 0.1
    tilted = wheels + np.outer(wheels[:, 0], [0.0, 0.0, 0.3])
    assert abs(line_distances(tilted, down) - point_distances(tilted, down)).max() > 0.1


# Ground plane and polygon ------------------------------------------------------------------------


def test_the_triples_that_pass_both_tests_are_the_facet_that_gravity_leaves_by() -> None:
    found = triple_statistics()
    assert found.sets == found.agree == 2000
    assert found.most_passing == 1
    # Both answers are common: neither "always" nor "never" would pass.
    assert 500 < found.tipping < 1500
    assert triple_statistics(200, 3) != triple_statistics(200, 4)


def test_two_ways_to_a_facet_by_hand() -> None:
    # A tetrahedron round the com with its flat side down, and its tip above.
    contacts = np.array([[3.0, 0.0, -1.0], [-2.0, 2.0, -1.0], [-2.0, -2.0, -1.0], [0.0, 0.0, 2.0]])
    for gravity, want in (
        ([0.0, 0.0, -1.0], (0, 1, 2)),
        ([-1.0, 0.0, 0.0], (1, 2, 3)),
        ([1.0, 1.0, 0.0], (0, 1, 3)),
    ):
        down = np.array(gravity)
        assert passing_triples(contacts, down) == [want]
        assert leaving_facet(contacts, down) == want
    beside = contacts + np.array([9.0, 0.0, 0.0])
    assert passing_triples(beside, np.array([0.0, 0.0, -1.0])) == []
    assert leaving_facet(beside, np.array([0.0, 0.0, -1.0])) is None
    # The opposite ray of a line that goes through the triangle.
    assert passing_triples(contacts[:3], np.array([0.0, 0.0, 1.0])) == []


def test_the_printed_line_in_place_of_a_ray_finds_a_robot_upside_down_to_stand() -> None:
    check = by_place(FOUND)["text before Eq 3"].checks[0]
    assert check.printed == 2.0 * check.ours
    assert 0 < check.ours < 500


def test_on_a_square_two_triangles_pass_whichever_way_it_leans() -> None:
    square = np.array([[1.0, 1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0], [1.0, -1.0, -1.0]])
    for x, y in ((0.3, 0.1), (-0.2, 0.5), (0.1, -0.6)):
        assert len(passing_triples(square, np.array([x, y, -1.0]))) == 2


def test_centres_of_polygons_by_hand() -> None:
    # A square of side 2 with a triangle of area 1 on its right: (0 * 4 + 4/3 * 1)/5.
    house = np.array(
        [
            [1.0, 1.0, -3.0],
            [2.0, 0.0, -3.0],
            [-1.0, 1.0, -3.0],
            [1.0, -1.0, -3.0],
            [-1.0, -1.0, -3.0],
        ]
    )
    for centre in (reference.polygon_centre(house), reference.contour_centroid(house)):
        assert centre == pytest.approx([4 / 15, 0.0, -3.0], abs=1e-12)
    assert printed.eq25_26(house[[0, 2, 4, 3, 1]]) == pytest.approx([4 / 15, 0.0], abs=1e-12)
    assert abs(printed.eq25_26(house) - [4 / 15, 0.0]).max() > 0.1


def test_the_incentre_is_the_point_furthest_from_all_edges() -> None:
    # Sides 3, 4, 5: inradius 1 about (1, 1); the centroid is at (4/3, 1).
    triangle = np.array([[0.0, 0.0, -2.0], [4.0, 0.0, -2.0], [0.0, 3.0, -2.0]])
    assert reference.incentre(triangle) == pytest.approx([1.0, 1.0, -2.0], abs=1e-12)
    assert reference.largest_inscribed_radius(triangle) == pytest.approx(1.0, abs=1e-9)
    # |3 * 4/3 + 4 * 1 - 12|/5 = 4/5.
    middle = triangle.mean(axis=0)
    assert reference.edge_distance(triangle, middle) == pytest.approx(0.8, abs=1e-12)
    wheels = nominal_wheels()
    assert reference.incentre(wheels) == pytest.approx(wheels.mean(axis=0), abs=1e-12)


def test_four_wheels_in_a_plane_leave_one_load_open() -> None:
    contacts = four_contacts(Example().wheels)
    normal = printed.normal_of(contacts)
    assert np.ptp(contacts @ normal) < 1e-12
    pierced = pierced_point(contacts, np.array([0.0, 0.0, -1.0]))
    shares = normal_forces(contacts, pierced)
    # Wheel 4 is -0.8, 1.1, 0.7 of the others: that mixture of loads changes nothing.
    others = shares + 0.05 * np.array([-0.8, 1.1, 0.7, -1.0])
    assert others.sum() == pytest.approx(1.0, abs=1e-12)
    assert others @ contacts == pytest.approx(pierced, abs=1e-9)
    assert min(others.min(), shares.min()) > 0.0


def test_the_limit_of_the_stability_factor_is_10_over_an_edge_and_20_over_a_wheel() -> None:
    wheels = nominal_wheels()
    for heading, limit in ((0, 20.0), (60, 10.0), (120, 20.0), (180, 10.0)):
        found = reference.factor_at_tipping(wheels, math.radians(heading))
        assert found == pytest.approx(limit, abs=1e-9)


# Results ----------------------------------------------------------------------------------------


def test_the_robot_in_closed_form_has_the_known_stability_factors() -> None:
    # The reconstruction with gravity along the body's -z.
    for alpha, gamma, want in (
        (30, 30, 0.066340810),
        (31, 31, 0.0025316053),
        (31.2, 31.2, 0.016549591),
        (32, 32, 0.073435114),
        (30.9628, 30.9605, 0.00020238762),
        (20, 40, 1.1935927),
        (40, 20, 1.1935927),
        (50, 50, 1.7068262),
    ):
        # Eight digits are known.
        assert closed_form.factor_at(alpha, gamma) == pytest.approx(want, rel=1e-6)


def test_the_first_order_line_touches_the_model_at_the_optimum() -> None:
    nominal = NOMINAL_DEG
    for da, dg in ((1.0, 1.0), (1.0, 0.0), (-1.0, 1.0), (0.3, -0.8)):
        step = 1e-3
        # (h/3) sqrt(da^2 + dg^2 - da dg) with h = 12; second order is a thousandth of it.
        want = 4.0 * math.radians(step) * math.sqrt(da * da + dg * dg - da * dg)
        found = closed_form.factor_at(nominal + step * da, nominal + step * dg)
        assert found == pytest.approx(want, rel=1e-3)


def test_the_search_takes_six_levels_and_is_not_monotone() -> None:
    trace = closed_form.search_trace(6)
    # Five left ends of [0, 50], then of the cells beside the best: worked out by hand.
    assert trace == pytest.approx([30, 32, 31.2, 30.88, 31.008, 30.9568], abs=1e-9)
    assert trace == pytest.approx(checks_text.nearest_nodes(6), abs=1e-9)
    values = [closed_form.factor_at(angle, angle) for angle in trace]
    assert values[1] > values[0]
    assert closed_form.levels_until(30.9568) == 6
    assert closed_form.levels_until(29.0) == 0


def test_percentages_are_those_of_the_table() -> None:
    checks = by_place(FOUND)["Table 1, error %"].checks
    want = [0.022, 0.0009092, 0.821, 0.566, 0.131, 0.0037889]
    assert [c.ours for c in checks] == pytest.approx(want, rel=1e-12)
    text = by_place(FOUND)["fminsearch, text"].checks[0]
    assert text.printed == pytest.approx(10.0 * text.ours, rel=1e-12)


def test_the_entry_at_30_deg_has_one_and_a_half_times_the_slope_of_that_at_32() -> None:
    nominal = NOMINAL_DEG
    slope = 0.0566 / (32.0 - nominal)
    assert slope == pytest.approx(0.0546, abs=5e-5)
    assert 0.0821 / (nominal - 30.0) == pytest.approx(0.0852, abs=5e-5)
    assert 0.0521 / (nominal - 30.0) == pytest.approx(0.0541, abs=5e-5)
    first = by_place(FOUND)["Table 1 and text, 30°"].checks[0]
    assert first.reference == pytest.approx(slope * (nominal - 30.0), rel=1e-12)


def test_lines_through_the_entries_of_table_1_end_at_two_different_optima() -> None:
    angle = by_place(FOUND)["Table 1, 31° to 32°"].checks[1]
    # 31.2 - 0.0131 * 0.8/0.0435 and 30.9568 + 0.00037889 * 0.8/0.0435.
    assert angle.printed == pytest.approx(30.95908, abs=5e-6)
    assert angle.reference == pytest.approx(30.96377, abs=5e-6)
    assert angle.ours == pytest.approx(math.degrees(math.atan(0.6)), rel=1e-14)


def test_the_entry_of_fminsearch_is_far_below_its_angles() -> None:
    check = by_place(FOUND)["Table 1, fminsearch"].checks[0]
    # da = -0.00096, dg = -0.00326 deg: 0.0029 deg at 0.0546 per deg.
    assert check.ours == pytest.approx(0.0029 * 0.0546, rel=5e-3)
    assert check.ours / check.printed == pytest.approx(1.74, abs=0.02)
    # Rounding of the printed angles explains a fiftieth.
    for da in (-5e-5, 5e-5):
        moved = closed_form.factor_at(30.9628 + da, 30.9605 + da)
        assert moved == pytest.approx(closed_form.factor_at(30.9628, 30.9605), rel=0.03)


def test_the_path_starts_with_the_limits_of_its_quotients() -> None:
    y, z, slope = by_place(FOUND)["Eqs 32 and 33"].checks
    assert [y.ours, z.ours, slope.ours] == [0.8, 0.0, 15.0]
    assert all(math.isnan(c.printed) for c in (y, z, slope))
    for x in (0.3, 2.0, 7.0):
        rise = (printed.eq33(x + 1e-6) - printed.eq33(x - 1e-6)) / 2e-6
        # The difference quotient loses ten of sixteen digits.
        assert closed_form.path_slope(x) == pytest.approx(rise, abs=1e-7)
        assert closed_form.path_height(x) == printed.eq33(x)


def test_the_uncontrolled_robot_tips_on_72_of_100_points_and_wherever_it_is_too_steep() -> None:
    assert closed_form.tipping_points(equal_spacing(100)) == 72
    for points in (37, 250, 1000):
        found = closed_form.tipping_points(equal_spacing(points))
        assert found == steeper_than_the_limit(points)
        assert found == pytest.approx(0.72 * points, rel=0.1)
    # On the last hundredth of the path, which is nearly flat, it stands.
    assert closed_form.tipping_points(np.linspace(12.5, 4.0 * np.pi, 20)) == 0


def test_with_control_the_closed_form_tips_on_the_known_points() -> None:
    # Found with the library's recipe, search and drive.
    for points, tips in ((50, 12), (100, 22), (200, 43), (500, 108), (1000, 215)):
        assert closed_form.tipping_points(equal_spacing(points), control=True) == tips


def test_gaussian_spacings_of_the_path_tip_without_control_as_often_and_with_it_do_not() -> None:
    # Nothing is printed of the Gaussian: mean in the middle, several standard deviations.
    spacings = [gaussian_spacing(100, parts) for parts in (4, 5, 6, 8)]
    assert all((np.diff(places) >= 0.0).all() and places[0] > 0.0 for places in spacings)
    assert all(71 <= closed_form.tipping_points(places) <= 74 for places in spacings)
    checks = by_place(FOUND)["path simulation, text"].checks
    assert [c.printed for c in checks] == [16, 11, 9, 4]


def test_the_second_shape_of_the_paper_is_equilateral_too() -> None:
    angle = closed_form.second_optimum_deg()
    assert angle == pytest.approx(-6.25, abs=5e-3)
    shape = tripods(*np.radians([[angle], [angle]]))
    down = closed_form.leaning(shape, DOWN)
    assert closed_form.stability_factors(shape, down)[0] < 1e-9


def test_the_centroid_is_not_the_direction_of_the_largest_tip_angle() -> None:
    wheels = Example().wheels
    middle = wheels.mean(axis=0)
    edges = np.cross(wheels, np.roll(wheels, -1, axis=0))
    edges *= np.sign(edges @ middle)[:, None]
    # Equally far from the three tip-over planes.
    inmost = np.linalg.solve(edges / np.linalg.norm(edges, axis=1)[:, None], np.ones(3))
    angle = stability(wheels[None], np.stack([middle, inmost]), ("tip_angle",))["tip_angle"][0]
    assert angle[1] > angle[0] + math.radians(1.0)
