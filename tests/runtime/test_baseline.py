"""The baseline of the emulated targets: its gate, what an update writes, what is told of it."""

import copy
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from firmware_export.emit.source import body_of
from lutgen.errors import ExportError, InputError
from proofs.exports import tripod_export
from targets import baseline, cases, costs, image, run, size, tables
from targets.boards import BOARDS, board
from targets.footprint import Footprint

# The gate


def cell(**changes: int) -> dict[str, Any]:
    counts = {name: changes.pop(name, 100 * (1 + at)) for at, name in enumerate(baseline.COUNTED)}
    sizes = {"code": 1000, "stack": 150, "pose_bytes": 80, "pose_i_bytes": 40}
    return sizes | changes | {"calls": {"at": counts}}


def content(**changes: int) -> dict[str, Any]:
    row = {
        "spec": "s",
        "codec": "grid",
        "arithmetic": "float",
        "tables": 59,
        "recipe_sha256": "0",
        "channels": ["sdg"],
    }
    return {
        "compilers": {"m4f": "gcc 12"},
        "rows": {"a": row | {"boards": {"m4f": {"-O2": cell(**changes)}}}},
    }


@pytest.mark.parametrize("measure", [*baseline.MEASURES, *baseline.COUNTED])
def test_more_than_two_percent_is_worse_or_asks_for_an_update(measure: str) -> None:
    label = f"at {measure}" if measure in baseline.COUNTED else measure
    old = baseline.flat(cell())[label]
    assert old is not None
    for factor, worse, better in ((1.01, 0, 0), (1.05, 1, 0), (0.99, 0, 0), (0.95, 0, 1)):
        found = baseline.compare(content(), content(**{measure: round(old * factor)}))
        assert [len(lines) for lines in found] == [worse, better]
        if worse:
            assert found[0][0].startswith(f"a m4f -O2 {label}: {old:,} in the baseline")


def test_of_a_sample_the_least_count_says_nothing_and_all_others_do() -> None:
    for measure in baseline.COUNTED:
        old = baseline.flat(cell())[f"at {measure}"]
        assert old is not None
        changed = content(**{measure: round(old * 1.05)})
        worse, _ = baseline.compare(content(), changed, {"m4f"})
        assert len(worse) == (measure != "min")
        assert baseline.compare(content(), changed, {"m0"}) == baseline.compare(content(), changed)


def test_what_the_baseline_does_not_hold_is_a_failure() -> None:
    found = content()
    found["rows"]["b"] = found["rows"]["a"]
    assert baseline.compare(content(), found)[0] == ["b: is not in the baseline"]
    found = copy.deepcopy(content())
    found["rows"]["a"]["boards"]["m4f"]["-Os"] = cell()
    assert baseline.compare(content(), found)[0] == ["a m4f -Os: is not in the baseline"]
    found = copy.deepcopy(content())
    found["rows"]["a"]["spec"] = "other"
    assert baseline.compare(content(), found)[0] == ["a: is other, in the baseline s"]
    found = copy.deepcopy(content())
    found["compilers"]["m4f"] = "gcc 13"
    assert "cannot be compared" in baseline.compare(content(), found)[0][0]
    found = copy.deepcopy(content())
    found["rows"]["a"]["tables"] = 62
    assert baseline.compare(content(), found)[0] == [
        "a tables: 59 in the baseline, now 62 (+5.1 %)"
    ]


def test_a_function_that_needs_no_stack_may_be_compared() -> None:
    assert baseline.compare(content(stack=0), content(stack=0)) == ([], [])
    assert baseline.compare(content(stack=0), content(stack=8))[0] == [
        "a m4f -O2 stack: 0 in the baseline, now 8"
    ]


def test_what_is_less_than_nothing_is_not_worse_than_itself() -> None:
    assert baseline.compare(content(min=-1), content(min=-1)) == ([], [])
    worse, better = baseline.compare(content(min=-1), content(min=-3))
    assert (len(worse), len(better)) == (0, 1)


def test_an_export_that_no_longer_fits_a_part_is_worse() -> None:
    found = content()
    found["rows"]["a"]["boards"]["m4f"]["-O2"] = {}
    worse, _ = baseline.compare(content(), found)
    assert "a m4f -O2 code: 1000 in the baseline, now None" in worse
    assert baseline.compare(found, found) == ([], [])


def test_a_call_that_is_no_longer_counted_is_worse() -> None:
    found = content()
    del found["rows"]["a"]["boards"]["m4f"]["-O2"]["calls"]["at"]
    worse, _ = baseline.compare(content(), found)
    assert "a m4f -O2 at median: 200 in the baseline, now None" in worse


def test_the_integer_form_costs_what_it_adds_to_each_posture() -> None:
    counts = {"pose": [10, 40, 20], "both": [15, 41, 30]}
    made = baseline.numbers(image.Outcome(0, counts, Footprint(1, 2), 80, 40))
    assert made["calls"]["form_i"] == {"min": 1, "median": 5, "max": 10}
    assert "form_i" not in baseline.numbers(image.Outcome(0, {"pose": [1]}, Footprint(1, 2), 8, 4))


def test_the_stack_of_a_call_stands_beside_its_counts() -> None:
    size = Footprint(1, 900, {"pose": 300})
    made = baseline.numbers(image.Outcome(0, {"pose": [1], "at": [2]}, size, 80, 40))
    assert baseline.flat(made)["pose stack"] == 300
    assert made["calls"]["pose"]["stack"] == 300
    assert "stack" not in made["calls"]["at"]


def test_an_update_replaces_what_was_run_and_keeps_the_rest(tmp_path: Path) -> None:
    old = content()
    old["rows"]["b"] = copy.deepcopy(old["rows"]["a"])
    old["rows"]["a"]["boards"]["m3"] = {"-O2": cell()}
    made = baseline.merged(old, content(max=290))
    assert made["rows"]["a"]["boards"] == {"m4f": {"-O2": cell(max=290)}, "m3": {"-O2": cell()}}
    assert made["rows"]["b"] == old["rows"]["b"]
    baseline.save(made, tmp_path / "b.json")
    assert baseline.load(tmp_path / "b.json") == made
    first = (tmp_path / "b.json").read_bytes()
    baseline.save(dict(reversed(made.items())), tmp_path / "b.json")
    assert (tmp_path / "b.json").read_bytes() == first


def test_a_baseline_that_is_none_is_refused(tmp_path: Path) -> None:
    (tmp_path / "b.json").write_text("[]")
    with pytest.raises(ExportError, match="is no baseline"):
        baseline.load(tmp_path / "b.json")


def test_the_committed_baseline_holds_every_row_and_board() -> None:
    known = baseline.load()
    assert set(known["rows"]) == {case.name for case in cases.cases()}
    assert set(known["compilers"]) == {one.name for one in BOARDS}
    left_out = {case.name: case.without for case in cases.cases()}
    for name, row in known["rows"].items():
        assert set(row["boards"]) == {one.name for one in BOARDS}
        for on, cells in row["boards"].items():
            assert set(cells) == set(board(on).options)
            # Small parts have no room for large tables and for the postures of many contacts.
            if on not in ("mega328p", "mega2560", "m0", *left_out[name]):
                assert all(cells.values())


def test_the_markdown_table_has_a_row_for_each_export_and_dashes_for_what_does_not_fit() -> None:
    known = content()
    known["rows"]["a"]["boards"]["mega328p"] = {"-O2": {}}
    assert tables.markdown(known, ("m4f", "mega328p")).splitlines() == [
        "| export | call | Cortex-M4F | ATmega328P, cycles |",
        "|---|---|---|---|",
        "| `a` | smap_at | 200 / 300 | - |",
    ]


# What reports tell


def test_a_report_tells_the_counts_of_just_the_export_that_was_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from firmware_export.emit import facts
    from firmware_export.emit.page import page

    export = tripod_export()
    known = content(max=290)
    known["rows"]["a"]["boards"]["m4f"]["-O2"]["calls"]["at"]["stack"] = 48
    known["rows"]["a"] |= {
        "spec": export.tables.spec.label,
        "recipe_sha256": export.recipe.digest,
        "channels": list(export.channels),
    }
    rows = json.loads(baseline.published(known, BOARDS, ["a", "b"]))["rows"]
    monkeypatch.setattr(facts, "_counts", lambda: rows)
    expected = {"target": "Cortex-M4F", "option": "-O2", "unit": "instructions", "call": "at"}
    assert facts.counted(export) == [expected | {"median": 200, "max": 290, "stack": 48}]
    body = body_of(export)
    text = page(facts.report(export, body, []), body, None)
    assert "| Cortex-M4F, -O2 | `smap_at` | instructions | 200 | 290 | 48 |" in text
    other = replace(export, channels=("tip_angle",))
    assert facts.counted(other) is None
    assert "Not measured for these tables." in page(facts.report(other, body, []), body, None)


# What the documents show


def test_the_readme_shows_the_costs_of_the_baseline_and_update_writes_them() -> None:
    readme = run.README.read_text(encoding="utf-8")
    exports = run.EXPORTS.read_text(encoding="utf-8")
    assert costs.shown(readme, baseline.load(), exports) == readme
    dearer = baseline.load()
    dearer["rows"]["absolem"]["boards"]["m4f"]["-O2"]["calls"]["at"]["median"] = 12_345
    assert "| 12,345 / " in costs.shown(readme, dearer, exports)
    dearer["rows"]["paper_two"]["boards"]["m4f"]["-Os"]["stack"] = 9_999
    assert "and 9,999 bytes of" in costs.shown(readme, dearer, exports)
    # Every column but that with jumps has an error that was measured.
    for name in list(costs.COLUMNS)[:-1]:
        one = dearer["rows"][name]
        assert costs.errors(exports)["paper_two", one["spec"], one["arithmetic"]].endswith("%")
    with pytest.raises(InputError, match=r"^README\.md: has no table of costs"):
        costs.shown("# Without a table\n", dearer, exports)


def test_the_document_shows_the_baseline_and_update_writes_it() -> None:
    page = run.PAGE.read_text(encoding="utf-8")
    assert run.shown(page, baseline.load()) == page
    less = baseline.load()
    dropped, *_ = less["rows"]
    del less["rows"][dropped]
    assert f"| `{dropped}` |" not in run.shown(page, less)
    with pytest.raises(InputError, match=r"^targets\.md: has no table of counts"):
        run.shown("# Without marks\n", less)


def test_the_document_shows_the_sizes_that_exports_count_with() -> None:
    page = run.PAGE.read_text(encoding="utf-8")
    rows = json.loads(size.SIZES.read_text(encoding="utf-8"))["sets"]
    assert size.shown(page, rows) == page
    rows[0]["code"] += 1
    assert size.shown(page, rows) != page
