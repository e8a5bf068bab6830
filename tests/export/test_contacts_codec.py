"""The codec that stores positions in closed form: exact for every tree of joints."""

from dataclasses import replace

import numpy as np
import pytest

from firmware_export.certify.answers import device
from firmware_export.choose import Trials
from firmware_export.contacts import codec as contacts
from firmware_export.contacts.terms import terms_of
from firmware_export.exporter import examine, guarded
from firmware_export.protocol import describe
from firmware_export.truth.model import Model
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import forward, radii_and_kinds
from lutgen.recipe.recipe import load_recipe, parse_recipe
from tests.fixtures.recipes import contact, rigid, rover, tripod

OK, ROCKS = 0, 1
ROBOTS = ("paper_one", "paper_two", "three_leg_sphere", "absolem", "marv", "markhor", "excavator")
ALL = (*ROBOTS, "articulated")


def recipe_of(name):
    texts = {"tripod": tripod, "rover": rover}
    return parse_recipe(texts[name]()) if name in texts else load_recipe(f"maps/{name}.toml")


def export_of(name):
    return contacts.INFO.export(Model(recipe_of(name)), "robot", EXPORTABLE)


def places(recipe, count, seed):
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])
    rng = np.random.default_rng(seed)
    return rng.uniform(low, high, (count, len(low))).astype(np.float32)


def read(terms, params, contacts):
    """Return positions (m, n, 3) and then axes as the tables have them, in float64."""
    entry = [np.ones(len(params))]
    for p, rate in terms.angles:
        entry += [np.sin(rate * params[:, p]), np.cos(rate * params[:, p])]
    entry += [params[:, p] for p in terms.travels]
    for a, b in terms.products:
        entry.append(entry[a] * entry[b])
    zero = np.zeros(len(params))
    found = np.array([sum((w * entry[e] for w, e in one), zero) for one in terms.coordinates]).T
    common = found[:, None, :3] if terms.common else 0.0
    rest = found[:, 3 * terms.common :].reshape(len(params), -1, 3)
    rest[:, :contacts] += common
    return rest


@pytest.mark.parametrize("name", [*ALL, "tripod", "rover"])
def test_positions_are_the_robots_in_every_posture(name):
    recipe = recipe_of(name)
    radius, kind = radii_and_kinds(recipe)
    order = list(range(len(kind)))[::-1]
    terms = terms_of(recipe, radius, order, turning=True)
    params = places(recipe, 300, 1).astype(np.float64)
    known = forward(recipe, params)
    found = read(terms, params, len(kind))
    size = np.abs(known.centres).max()
    # float64, and coefficients of less than 1e-9 of the size left out.
    np.testing.assert_allclose(found[:, : len(kind)], known.centres[:, order], atol=1e-8 * size)
    for at, of in enumerate(terms.axis_of):
        if of != 255:
            axes = found[:, len(kind) + of]
            along = np.abs((axes * known.axes[:, order[at]]).sum(axis=1))
            np.testing.assert_allclose(along, 1.0, atol=1e-8)


@pytest.mark.parametrize("name", [*ALL, "tripod", "rover"])
def test_no_answer_is_safer_than_the_truth_and_next_to_nothing_is_given_up(name):
    export = export_of(name)
    model = export.model
    params = np.repeat(places(export.recipe, 400, 2), 50, axis=0)
    rng = np.random.default_rng(3)
    gravity = rng.normal(size=(len(params), 3)).astype(np.float32)
    gravity[:, 2] = -2.0 * np.abs(gravity[:, 2])
    status, reading = device(export).read(params, gravity)
    exact = model.exact(params.astype(np.float64), gravity.astype(np.float64)[:, None])
    tip, held = exact.tip_angle[:, 0], status != 3
    safe = np.isin(status, (OK, ROCKS))
    assert not np.any(safe & (tip < 0.0))
    assert np.all(reading[safe, 1] <= tip[safe])
    given_up = (held & ~safe & (tip >= 0.0)).sum() / max((held & (tip >= 0.0)).sum(), 1)
    assert given_up < 0.002
    size = np.abs(forward(export.recipe, params[:400]).centres).max()
    # |SD_g| jumps where the facet changes: there rounding decides.
    assert np.percentile(np.abs(reading[safe, 0] - exact.sdg[safe, 0]), 99) < 2e-5 * size
    assert np.percentile(np.abs(reading[safe, 2] - exact.height[safe, 0]), 99) < 2e-5 * size


def test_the_papers_robot_takes_51_bytes_and_its_guard_is_a_bound():
    paper = export_of("paper_two")
    assert paper.tables.bytes == 51
    # Other points, with nothing altered, would be no proof of a larger guard.
    assert paper.tables.guarded(1e-3) is None
    assert "floating point" in str(contacts.INFO.refusal(paper.model, "integer"))
    # Links that only move the com are stored once for all contacts.
    assert not paper.tables.terms.common
    assert export_of("marv").tables.terms.common


def test_gravity_of_any_length_gives_the_same_answer():
    export = export_of("absolem")
    params = np.repeat(places(export.recipe, 1, 5), 7, axis=0)
    gravity = np.array([[0.1, 0.05, -1.0]]) * (2.0 ** np.arange(-60, 80, 20))[:, None]
    status, reading = device(export).read(params, gravity)
    assert len(set(status.tolist())) == 1
    assert np.ptp(reading[:, 1]) == 0.0


@pytest.mark.parametrize("axle", [(0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.6, -0.8, 0.0)])
def test_axles_may_point_either_way(axle):
    # The importer gives every cylinder of a description that is turned a quarter about x the axle
    # -y: the frame of such rails was turned and not turned back, and whole cars were refused.
    def blob(sign):
        text = rigid(
            "".join(
                contact(f"wheel{k}{s}", (x, s * y, -0.3), 0.1, tuple(sign * a for a in axle))
                for k, (x, y) in enumerate(((0.1, 0.2), (0.3, 0.1), (-0.4, 0.25)))
                for s in (-1, 1)
            ),
            head="rock_angle = 30\nupright = 80",
        )
        export = contacts.INFO.export(Model(parse_recipe(text)), "robot", EXPORTABLE)
        return export, describe(export).bytes

    export, forth = blob(1.0)
    assert forth == blob(-1.0)[1]
    assert len(export.tables.many.first) > 2
    rng = np.random.default_rng(5)
    gravity = rng.normal(size=(3000, 3)).astype(np.float32)
    gravity[:, 2] = -2.0 * np.abs(gravity[:, 2])
    status, reading = device(export).read(np.zeros((3000, 0), np.float32), gravity)
    exact = export.model.exact(np.zeros((3000, 0)), gravity.astype(np.float64)[:, None])
    tip, safe = exact.tip_angle[:, 0], np.isin(status, (OK, ROCKS))
    assert not np.any(safe & (tip < 0.0))
    assert np.all(reading[safe, 1] <= tip[safe])
    assert safe[tip > 3e-4].mean() > 0.99


def test_a_guard_that_is_too_small_is_made_as_large_as_points_need():
    # Tables of a robot whose com is a little further ahead say too much of tipping backwards.
    export = export_of("rover")
    trials = Trials(export.model, "rover", EXPORTABLE, "float")

    def told_by(ahead):
        other = Model(parse_recipe(rover(ahead=ahead)))
        return replace(export, tables=contacts.INFO.encode(other, EXPORTABLE, contacts.Spec()))

    bold = told_by(3e-4)
    assert examine(bold, trials, None, 10_000).false_safe > 0
    mended, certificate = guarded(bold, trials, None, 10_000)
    assert certificate.false_safe == 0
    assert 0.0 < mended.tables.guard < 3e-3
    assert mended.tables.many.guard == pytest.approx(np.sin(mended.tables.guard))
    assert "as much as points needed" in mended.tables.guard_text
    assert mended.tables.guard_text.count("as much as points needed") == 1
    # What is wrong by more than any rounding is not hidden by a guard.
    wild = told_by(0.05)
    kept, certificate = guarded(wild, trials, None, 10_000)
    assert certificate.false_safe > 0
    assert kept.tables.guard == wild.tables.guard
