"""The chooser: the best of what a codec can do, on codecs whose errors are known formulas."""

import functools
import math
from dataclasses import dataclass
from types import SimpleNamespace

import pytest

import lutgen
from firmware_export import choose as chooser
from firmware_export.choose import Candidate, Goal, Trials, choose
from firmware_export.codecs import codec, named, usable
from firmware_export.model.exact import Model
from firmware_export.quantity import ErrorBound
from lutgen.errors import ExportError, InputError
from tests.fixtures.fits import few_points
from tests.fixtures.recipes import rover, tripod

CODE = 1000


@dataclass(frozen=True)
class Spec:
    """Nodes of each axis."""

    nodes: tuple[int, ...]

    @property
    def label(self):
        return "x".join(map(str, self.nodes))


@dataclass(eq=False)
class Formula:
    """A codec of multilinear tables whose error is a sum over the axes."""

    name: str = "grid"
    weights: tuple[float, ...] = (20.0, 5.0, 1.0)
    largest: int = 30
    false_tip: object = lambda spec: 0.0

    def sizes(self, *_):
        """Return sizes, each a node more along the axis that adds most to the error."""
        found = [Spec((3,) * len(self.weights))]
        while max(found[-1].nodes) < self.largest:
            nodes = list(found[-1].nodes)
            parts = [w / (n - 1) ** 2 for w, n in zip(self.weights, nodes, strict=True)]
            nodes[parts.index(max(parts))] += 1
            found.append(Spec(tuple(nodes)))
        return found

    def size(self, spec):
        return math.prod(spec.nodes)

    def error(self, spec):
        # Percent.
        return sum(w / (n - 1) ** 2 for w, n in zip(self.weights, spec.nodes, strict=True))


class Paper(Trials):
    """Trials that measure nothing: candidates are what the formula says."""

    def __init__(self):
        self.tried, self.arithmetic = {}, "float"
        self.channels = ("sdg", "tip_angle")
        self.model = SimpleNamespace(recipe=SimpleNamespace(source="paper.toml"))

    def try_out(self, codec, spec):
        if (codec, spec) not in self.tried:
            size, error = codec.size(spec), codec.error(spec)
            export = SimpleNamespace(codec=codec.name, tables=SimpleNamespace(spec=spec))
            given_up = codec.false_tip(spec)
            measured = SimpleNamespace(error=lambda relative: error, false_tip=given_up)
            self.tried[codec, spec] = Candidate(export, size + CODE, measured)
        return self.tried[codec, spec]


def goal(flash, percent):
    return Goal(flash, None if percent is None else ErrorBound(percent, relative=True))


def best(formula, flash, percent):
    return choose(Paper(), [formula], goal(flash, percent))


def test_the_smallest_listed_size_that_holds_an_error_is_found_in_few_trials():
    for percent in (20.0, 5.0, 2.0, 1.0, 0.3):
        paper, formula = Paper(), Formula()
        found = choose(paper, [formula], goal(None, percent))
        holding = [one for one in formula.sizes() if formula.error(one) <= percent / Goal.margin]
        assert found.total == min(map(formula.size, holding)) + CODE, percent
        assert len(paper.tried) <= 8


def test_the_first_codec_that_meets_the_goal_is_taken_and_no_other_tried():
    codecs = [Formula("contacts", largest=6), Formula()]
    for percent, name in ((5.0, "contacts"), (1.0, "grid")):
        paper = Paper()
        assert choose(paper, codecs, goal(None, percent)).export.codec == name
        assert {codec.name for codec, _ in paper.tried} == {"contacts", name}


def test_both_limits_hold_or_the_error_names_the_nearest():
    found = best(Formula(), 10_000, 2.0)
    assert found.total <= 10_000
    assert found.certificate.error(True) <= 2.0 / Goal.margin
    with pytest.raises(ExportError, match="smallest there is"):  # code counts as flash
        best(Formula(), CODE, None)
    with pytest.raises(ExportError) as caught:
        best(Formula(), 1050, 2.0)
    text = str(caught.value)
    assert "1,050 bytes of flash and an error of 2 %" in text
    # The smallest error within the flash, and the smallest size for the error.
    assert "in 1," in text
    assert "are needed for that error" in text


def test_an_export_that_gives_up_little_goes_before_a_smaller_one():
    found = best(Formula(false_tip=lambda spec: 2.0 / spec.nodes[2] ** 2), None, 5.0)
    # At most 5 %: 7 nodes of an axis that the error alone would leave at 3.
    assert found.false_tip <= 0.05
    assert found.export.tables.spec.nodes[2] >= 7
    # Where all give up much, the one that gives up least.
    paper = Paper()
    much = Formula(false_tip=lambda spec: 0.3 + 1.0 / spec.nodes[2], largest=12)
    found = choose(paper, [much], goal(None, 5.0))
    holding = [one for one in paper.tried.values() if goal(None, 5.0).holds(one)]
    assert found.false_tip == min(one.false_tip for one in holding)


def test_codecs_are_named_and_tried_in_order_and_refuse_with_a_reason():
    model = Model(lutgen.parse_recipe(tripod()))
    assert [one.name for one in usable(model, "float")] == ["contacts", "grid"]
    assert usable(model, "float", "contacts") == named("contacts")
    assert usable(model, "integer") == [codec("grid")]
    for unknown in (lambda: codec("zip"), lambda: usable(model, "fixed")):
        with pytest.raises(InputError, match="unknown"):
            unknown()
    with pytest.raises(ExportError, match="integer"):
        usable(robot_of(rover()), "integer", "contacts")


@functools.cache
def robot_of(text):
    """Return the robot of a recipe, whose points are sampled once for all tests."""
    return Model(lutgen.parse_recipe(text))


def test_a_trained_table_takes_the_flash_that_there_is_and_keeps_the_error_or_is_refused(
    monkeypatch,
):
    # Four wheels, one of which lifts off.
    monkeypatch.setattr(chooser, "POINTS", 12_000)
    bench, other = (
        Trials(robot_of(rover()), "rover", channels, "integer")
        for channels in (("sdg", "tip_angle"), ("tip_angle", "height"))
    )
    codecs = usable(bench.model, "integer", "grid")
    with few_points():
        found = choose(bench, codecs, goal(6_000, 30.0))
        assert len(bench.tried) == 1
        assert 5_000 < found.total <= 6_000
        assert goal(6_000, 30.0).holds(found)
        assert goal(None, 90.0).holds(choose(other, codecs, goal(6_000, 90.0)))
        said = r"6,000 bytes of flash and an error of 0.1 %.*nearest"
        with pytest.raises(ExportError, match=said):
            choose(bench, codecs, goal(6_000, 0.1))


def test_where_no_size_can_be_encoded_the_reason_is_told_once(monkeypatch):
    def encode(*_):
        raise InputError("tripod.toml: its region has too many pieces; choose another.")

    model = robot_of(tripod())
    bench = Trials(model, "tripod", ("tip_angle",), "float")
    place = model.recipe.source
    grid = codec("grid")
    monkeypatch.setattr(grid, "encode", encode)
    with pytest.raises(ExportError, match="no codec could encode the robot") as caught:
        choose(bench, [grid], goal(8_000, None))
    assert "grid: tripod.toml: its region has too many pieces; choose another)" in str(caught.value)
    assert str(caught.value).startswith(f"{place}: no codec")
