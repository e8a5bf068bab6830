"""The proofs of the C runtime: what is fast of them, and that each gate fails when broken."""

import re
import shutil
from pathlib import Path

import pytest

from firmware_export.emit import package
from firmware_export.emit.runtime import SWITCHES, runtime_text
from firmware_export.host import RUNTIME
from lutgen.errors import ExportError, InputError
from proofs import analysers, eva, exhaustive, fuzz, loops, run, structure
from proofs.annotate import ADMITS, HINTS, LOOP, MUTANTS, annotate, mutate, stale
from proofs.document import DOCUMENT, cells, findings, with_counts, with_rows
from proofs.exports import rover_export, tripod_export
from proofs.parts import PROGRAMS, place, runtime_parts
from proofs.recipes import rover
from proofs.subjects import KINDS, SMALL, Subject, read_subject
from proofs.tools import FAILED, OK, PACKAGES, SKIPPED, Result

PARTS = runtime_parts()
ALL = "\n".join(text for _, text in sorted(PARTS.items()))
# The switches of an export of each kind that has a fault to find.
ON = {
    "points": ("SMAP_POINTS", "SMAP_FLOATS", "SMAP_INTEGERS"),
    "series": ("SMAP_POINTS", "SMAP_SERIES", "SMAP_FLOATS", "SMAP_INTEGERS"),
    "tables": ("SMAP_TABLES", "SMAP_FLOATS", "SMAP_INTEGERS"),
    "tables whole": ("SMAP_TABLES", "SMAP_INTEGERS"),
    "grid": ("SMAP_GRID", "SMAP_LENGTHS", "SMAP_FLOATS"),
    "grid whole": ("SMAP_GRID", "SMAP_LENGTHS", "SMAP_INTEGERS"),
    "rails": ("SMAP_MANY", "SMAP_MANY_BY_RAILS", "SMAP_MANY_GAPS", "SMAP_FLOATS", "SMAP_INTEGERS"),
}
SOURCES = {kind: runtime_text(frozenset(on)) for kind, on in ON.items()}
TEXT = DOCUMENT.read_text(encoding="utf-8")
PATIENCE = 120.0


# the document


def test_every_loop_of_the_runtime_is_in_the_document_with_a_bound() -> None:
    assert structure.undocumented(PARTS, TEXT) == []
    rows = cells(TEXT, "Loops")
    assert sum(int(row[1]) for row in rows) == len(list(loops.loops(ALL))) > 100
    assert all(row[3] for row in rows)


def test_a_loop_that_is_not_in_the_document_is_found_and_so_is_one_that_has_gone() -> None:
    more = {
        **PARTS,
        "end.c": PARTS["end.c"] + "\nstatic void endless(void)\n{\n  for (;;) {\n  }\n}\n",
    }
    assert structure.undocumented(more, TEXT) == [
        "endless: for (;;) has no bound",
        "for (;;) of end is not listed",
    ]
    fewer = {
        **PARTS,
        "check.c": PARTS["check.c"].replace("for (bit = 0; bit < 8; bit++)", "if (1)"),
    }
    assert structure.undocumented(fewer, TEXT) == [
        "for (bit = 0; bit < 8; bit++) of check is listed and not there"
    ]
    with pytest.raises(ExportError, match="write a loop"):
        list(loops.loops("void f(void)\n{\nagain:\n  goto again;\n}\n"))


def test_a_comment_is_no_loop_and_a_loop_over_two_lines_is_one() -> None:
    text = (
        "/* while (1) */\nstatic int f(int n)\n{\n  while (n > 0 &&\n         (n & 1)) {\n  }\n}\n"
    )
    assert list(loops.loops(text)) == [("f", "while (n > 0 && (n & 1))")]


def test_a_function_of_61_lines_is_too_long_and_one_of_60_is_not() -> None:
    def of(lines: int) -> str:
        return "static void f(void)\n{\n" + "  a();\n" * (lines - 2) + "}\n"

    assert structure.long_ones(of(60)) == []
    assert structure.long_ones(of(61)) == ["f: 61 lines"]
    assert structure.long_ones(ALL) == []


def test_the_programs_have_every_part_and_every_switch_between_them() -> None:
    assert {switch for on in PROGRAMS.values() for switch in on} == set(SWITCHES)
    beside = {"smap.h", "smap_config.h"}
    there = {path.name for path in RUNTIME.glob("*.c") if not path.name.startswith("host")}
    # On-board control is not among what is proved yet.
    there = {name for name in there if not name.startswith("control_")}
    assert set(PARTS) - beside == there


def test_the_document_lists_what_the_annotations_assume() -> None:
    listed = [row[0].replace(r"\|", "|") for row in cells(TEXT, "What Eva is told")]
    assert stale(PARTS) == []
    assert sorted(listed) == sorted(ADMITS)


def test_every_analyser_has_its_table_and_every_finding_a_reason() -> None:
    for name in analysers.ANALYSERS:
        for row in cells(TEXT, analysers.heading(name)):
            assert re.fullmatch(r"[1-9]\d*", row[1]), row
            assert len(row[2]) >= 10, row


def test_new_counts_are_written_into_their_own_table_only() -> None:
    known = findings(TEXT, "MISRA deviations")
    assert with_counts(TEXT, "MISRA deviations", known) == TEXT
    changed = with_counts(TEXT, "MISRA deviations", {**known, "12.1": 7, "21.3": 2})
    assert findings(changed, "MISRA deviations") == {**known, "12.1": 7, "21.3": 2}
    # What is new has no reason, so that the test above fails until somebody writes one.
    assert set(changed.splitlines()) - set(TEXT.splitlines()) >= {"| `21.3` | 2 |  |"}
    assert len(set(changed.splitlines()) - set(TEXT.splitlines())) == 2
    gone = with_rows(TEXT, "Loops", [["`for (;;)`", "1", "end", "none"]])
    assert cells(gone, "Loops") == [["for (;;)", "1", "end", "none"]]
    assert findings(gone, "MISRA deviations") == known
    with pytest.raises(InputError, match="has no table of that name"):
        findings(TEXT, "Nothing")


# annotations


def test_annotations_are_comments_and_leave_the_code_as_it_is() -> None:
    kinds = set()
    for source in SOURCES.values():
        lines = annotate(source).split("\n")
        added = [line for line in lines if line.startswith("//@ ")]
        assert added
        assert "\n".join(line for line in lines if not line.startswith("//@ ")) == source
        kinds |= {line.split()[1] for line in added}
        assert all(line.endswith(";") for line in added)
    assert kinds == {"admit", "assert", "split", "merge", "loop"}


def test_a_line_that_has_gone_is_told_and_so_is_the_place_of_a_seeded_fault() -> None:
    line = "q[i] = x;"
    assert line in PARTS["range.c"]
    fewer = {**PARTS, "range.c": PARTS["range.c"].replace(line, "q[i] = x ;")}
    assert stale(fewer) == [hint.line for hint in HINTS if hint.line.startswith("q")]
    with pytest.raises(ExportError, match="the place of a seeded fault is missing"):
        mutate("", "grid")


def test_an_alarm_that_eva_counts_once_is_of_the_kind_that_the_document_explains() -> None:
    text = (
        "3 alarms generated by the analysis:\n     1 division by zero\n     2 integer overflows\n"
    )
    assert eva.kinds(text) == {"divisions by zero": 1, "integer overflows": 2}
    listed = re.findall(r"^### (Alarms left of \w+)$", TEXT, re.MULTILINE)
    assert listed
    for heading in listed:
        assert not set(findings(TEXT, heading)) & set(eva.SINGLE)
        assert all(row[2] for row in cells(TEXT, heading))


def test_every_kind_that_eva_proves_has_a_fault_to_find() -> None:
    assert set(MUTANTS) == set(SOURCES)
    assert {*KINDS.values(), "tables whole", "grid whole"} - set(MUTANTS) == {"search"}
    for kind, source in SOURCES.items():
        assert mutate(source, kind) != source
        assert annotate(source) != mutate(annotate(source), kind)


# what counts as a proof

PROOF = """\
  In these functions, 261 statements reached (out of 279): 93% coverage.
  0 alarms generated by the analysis.
    Assertions        4 valid     0 unknown     0 invalid      4 total
"""


def test_only_the_literal_line_of_no_alarms_is_a_proof() -> None:
    assert eva.verdict(PROOF) == ""
    assert eva.verdict("") == "ended without a verdict"
    assert eva.verdict(PROOF.replace("0 alarms", "10 alarms")) == "10 alarms"
    assert eva.verdict(PROOF.replace("0 alarms", "1 alarm")) == "1 alarms"
    assert "unknown" in eva.verdict(PROOF.replace("0 unknown", "1 unknown"))
    assert "invalid" in eva.verdict(PROOF.replace("0 invalid", "2 invalid"))
    assert eva.verdict("[kernel] User Error: stopping\n" + PROOF) == "was not parsed"
    assert "only 12 %" in eva.verdict(PROOF.replace("93%", "12%"))
    assert "never returns" in eva.verdict(PROOF + "[eva] NON TERMINATING FUNCTION")


def test_an_alarm_is_told_by_its_line() -> None:
    text = "[eva:alarm] work/smap.c:2: Warning: \n  out of bounds read.\n"
    assert eva.alarms(text, "int a;\n  a = b[3];\n") == ["a = b[3];"]


def test_of_many_contacts_each_loop_is_told_how_far_it_may_count_and_no_code_is_altered() -> None:
    source = SOURCES["rails"]
    lines = annotate(source, {7, 12}).split("\n")
    assert "\n".join(line for line in lines if not line.startswith("//@ ")) == source
    told = [i for i, line in enumerate(lines) if 'loop widen_hints "all", 7, 12;' in line]
    heads = [i for i, line in enumerate(lines) if LOOP.match(line)]
    assert [i + 1 for i in told] == heads
    # Each place that a pointer is made of is asserted to be in its array, ahead of the statement.
    assert lines[lines.index("  segment = &o->at.segment[o->at.segments];") - 1] == (
        "//@ assert o->at.segments < SMAP_MANY_LINKS;"
    )
    near = next(i for i, line in enumerate(lines) if "return smap_chord(&w->facet[w->o" in line)
    assert lines[near - 1] == "//@ assert w->owner[w->twin[e]] < SMAP_MANY_FACETS;"
    # Two comments before one loop are no C that the analyser reads.
    assert not any(lines[i - 1].startswith("//@ loop") for i in told)
    assert any(lines[i].startswith("//@ loop unroll 40; loop widen_hints") for i in told)


def test_options_name_only_functions_that_an_export_has() -> None:
    without = eva.coarse(runtime_text(frozenset({"SMAP_MANY", "SMAP_MANY_BY_RAILS"})))
    with_code = eva.coarse(
        runtime_text(frozenset({"SMAP_MANY", "SMAP_MANY_BY_RAILS", "SMAP_SERIES"}))
    )
    assert "smap_series_positions" not in " ".join(without)
    assert "smap_series_positions:300" in " ".join(with_code)
    assert "smap_many_of:50" in " ".join(without)


@pytest.mark.needs("frama-c", "gcc")
def test_eva_proves_four_rigid_wheels_and_finds_one_segment_too_many(tmp_path: Path) -> None:
    four = rover_export("four", text=rover(rock_angle=0.0))
    package.write(four, tmp_path / "four")
    subject = read_subject(tmp_path / "four")
    assert subject.kind == "rails"
    proof = eva.prove(subject, tmp_path, PATIENCE)
    assert proof.state == OK, proof.text
    fault = eva.prove_fault_is_found(subject, tmp_path, PATIENCE)
    assert fault.state == OK, fault.text


@pytest.mark.needs("frama-c", "gcc")
def test_eva_proves_a_small_export_and_finds_its_seeded_fault(tmp_path: Path) -> None:
    package.write(SMALL["tables_float"]("feet"), tmp_path / "feet")
    subject = read_subject(tmp_path / "feet")
    assert (subject.kind, subject.params, subject.integer) == ("tables", 2, False)
    proof = eva.prove(subject, tmp_path, PATIENCE)
    assert proof.state == OK, proof.text
    fault = eva.prove_fault_is_found(subject, tmp_path, PATIENCE)
    assert fault.state == OK, fault.text
    # What does not parse is no proof, although it raises no alarm.
    source = tmp_path / "feet" / "smap.c"
    source.write_text(source.read_text() + "\nint (;\n")
    assert eva.prove(subject, tmp_path, PATIENCE).state == FAILED


@pytest.mark.needs("gcc")
@pytest.mark.parametrize(
    ("name", "part", "text", "instead"),
    [
        ("between", "grid_i", "(way >> (14 - finer))", "(way >> (14 - finer)) + 1u"),
        ("cell", "grid", "lower = x >= smap_u16", "lower = x > smap_u16"),
        ("root", "arithmetic", "digits += digits & 1u;", "digits += 0u;"),
        (
            "whole_root",
            "arithmetic",
            "8u + 1u;\n  result = (result + odd / result) >> 1;",
            "8u + 1u;",
        ),
    ],
)
def test_what_is_tried_everywhere_finds_a_fault(
    name: str, part: str, text: str, instead: str, tmp_path: Path
) -> None:
    assert text in PARTS[f"{part}.c"]
    faulty = {**PARTS, f"{part}.c": PARTS[f"{part}.c"].replace(text, instead)}
    # 127 divides 0x3F80, the upper half of 1.0f, beside which faults of guards are.
    found = {row.subject: row for row in exhaustive.prove(faulty, tmp_path, PATIENCE, 127)}
    # Arcsines are made of roots.
    also = {"arcsine"} if name == "root" else set()
    assert {key for key, row in found.items() if row.state == FAILED} == {name} | also
    assert " 0 wrong" not in found[name].text


# the fuzzer


@pytest.fixture(scope="module")
def feet(tmp_path_factory: pytest.TempPathFactory) -> Subject:
    folder = tmp_path_factory.mktemp("fuzz") / "feet"
    package.write(tripod_export("feet"), folder)
    return read_subject(folder)


@pytest.mark.needs("clang", "gcc")
def test_the_fuzzer_passes_what_is_right_and_finds_a_seeded_fault(
    feet: Subject, tmp_path: Path
) -> None:
    assert fuzz.fuzz(feet, tmp_path / "asked", fuzz.Length(runs=5000)).state == OK
    assert fuzz.fuzz_fault_is_found(feet, tmp_path / "fault").state == OK


@pytest.mark.needs("clang", "gcc")
def test_a_check_that_looks_at_no_size_is_found_by_damaged_maps(
    feet: Subject, tmp_path: Path
) -> None:
    assert fuzz.fuzz(feet, tmp_path / "right", fuzz.Length(runs=5000), "damage").state == OK
    source = feet.folder / "smap.c"
    right = source.read_text()
    faulty = right.replace("good && smap_check_body(map, blob + map->size)", "good")
    assert faulty != right
    source.write_text(faulty)
    try:
        found = fuzz.fuzz(feet, tmp_path / "wrong", fuzz.Length(seconds=60), "damage")
    finally:
        source.write_text(right)
    assert found.state == FAILED


@pytest.mark.needs("gcc")
def test_flipped_bits_pass_a_check_without_a_checksum(feet: Subject, tmp_path: Path) -> None:
    assert fuzz.flip(feet, tmp_path, PATIENCE).state == OK
    source = feet.folder / "smap.c"
    right = source.read_text()
    faulty = right.replace("smap_crc(blob + 4, map->size - 4u) == smap_u32(blob)", "1")
    assert faulty != right
    source.write_text(faulty)
    try:
        assert fuzz.flip(feet, tmp_path, PATIENCE).state == FAILED
    finally:
        source.write_text(right)


# structure and analysers


@pytest.mark.needs("gcc")
def test_globals_recursion_and_library_calls_are_found(tmp_path: Path) -> None:
    place(PARTS, tmp_path)
    states = [row.state for row in structure.prove(PARTS, TEXT, tmp_path, PATIENCE)]
    assert states == [OK] * 5
    faulty = {
        **PARTS,
        "end.c": PARTS["end.c"]
        + (
            "\nstatic volatile int reads;\nvoid extra(int n);\n#include <stdlib.h>\n"
            "void extra(int n)\n{\n  reads += n + rand();\n  if (n & reads) {\n"
            "    extra(n - 1);\n    reads++;\n  }\n}\n"
        ),
    }
    place(faulty, tmp_path)
    rows = {row.subject: row for row in structure.prove(faulty, TEXT, tmp_path, PATIENCE)}
    assert rows["loops"].state == OK
    assert {name for name, row in rows.items() if row.state == FAILED} == {
        *("recursion", "globals", "library")
    }
    assert rows["globals"].text == "reads"
    assert rows["library"].text == "rand"


def test_a_finding_that_is_not_listed_fails_and_so_does_another_number() -> None:
    known = {"10.4": 86, "12.1": 63}
    assert analysers.compare(known, known) == ""
    assert analysers.compare({**known, "21.3": 1}, known) == "21.3 is not in the list"
    assert analysers.compare({"10.4": 85, "12.1": 63}, known) == "10.4: 85 times, listed 86"
    assert analysers.compare({"10.4": 86}, known) == "12.1 is no longer found"


@pytest.mark.needs("cppcheck")
def test_a_rule_that_is_broken_once_more_is_found_and_so_is_a_file_that_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # That the tables are what is found in all programs is what `make verify` tells.
    monkeypatch.setattr(analysers, "PROGRAMS", ("grid_w",))
    place(PARTS, tmp_path)
    end = tmp_path / "end.c"
    right = end.read_text()
    before, failed = analysers.count("MISRA", tmp_path, PATIENCE)
    assert not failed
    lost = "int go_astray(int x);\nint go_astray(int x)\n{\n  goto there;\nthere:\n  return x;\n}\n"
    end.write_text(right + lost)
    result, found = analysers.analyse("MISRA", TEXT, tmp_path, PATIENCE)
    assert result.state == FAILED
    assert "15.1 is not in the list" in result.text
    assert before.keys() <= findings(TEXT, "MISRA deviations").keys()
    assert {
        rule: n - before.get(rule, 0) for rule, n in found.items() if n != before.get(rule)
    } == {"15.1": 1}
    # A file that it gives up is not one without findings.
    end.write_text(
        right + "static int g(int x)\n{\n  switch (x) {\n  case 1 ? 2 : 3:\n    return 1;\n"
        "  default:\n    return 0;\n  }\n}\n"
    )
    result, _ = analysers.analyse("cppcheck", TEXT, tmp_path, PATIENCE)
    assert result.state == FAILED
    assert "is not read" in result.text


# the run


def test_what_is_missing_is_named_and_fails_when_strict(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.delenv("CI", raising=False)
    assert run.main(["--only", "analysers"]) == 0
    printed = capsys.readouterr()
    assert printed.out.count(SKIPPED) == len(analysers.ANALYSERS)
    assert "needs apt-get install cppcheck" in printed.out
    for packages in PACKAGES.values():
        assert set(packages) <= set(printed.err.split())
    assert run.main(["--only", "analysers", "--strict"]) == 1
    monkeypatch.setenv("CI", "true")
    assert run.main(["--only", "analysers"]) == 1


def test_a_failed_proof_is_the_exit_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def failing(*_: object) -> list[Result]:
        return [Result("structure", "loops", FAILED, "endless: for (;;) is not listed")]

    monkeypatch.setattr(structure, "prove", failing)
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    assert run.main(["--only", "structure"]) == 1
    assert "endless" in capsys.readouterr().out


def test_an_error_inside_a_proof_is_a_row_of_the_table(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def failing(*_: object) -> list[Result]:
        raise ExportError("gcc: did not end (got 1 s); run again.")

    monkeypatch.setattr(structure, "prove", failing)
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    assert run.main(["--only", "structure"]) == 1
    assert "did not end" in capsys.readouterr().out
