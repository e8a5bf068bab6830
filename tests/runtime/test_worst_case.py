"""The bound of a read: every loop has one, and the machine code is summed up as by hand."""

from pathlib import Path

import pytest

from firmware_export.emit.runtime import runtime_text
from lutgen.errors import ExportError
from targets import heads, loops
from targets.listing import parse
from targets.longest import bounded, measured
from targets.size import SETS
from targets.worst import Bounds
from tests.runtime.test_targets import needs_arm, row

# As much as any export has.
WIDEST = loops.Shape(
    *(8, 32, 8, 8, 8, 99, 99, 10, 255, 32, 8, 80, 250, 60, 254, 254, 250),
    *(2000, 33, 64, 40, 26),
)


def test_every_loop_of_the_runtime_has_a_bound() -> None:
    every = set[str]()
    for features in SETS:
        source = runtime_text(frozenset(features))
        found = loops.bounds(source, WIDEST)
        assert len(found) > 20
        assert all(0 < rounds <= WIDEST.work for rounds in found.values())
        every |= set(heads.heads(source).values())
    # And none is listed that is not there, nor one that says itself what bounds it.
    assert set(loops.LOOPS) == {head for head in every if not loops.CHARGE.search(head)}
    assert set(loops.COUNTED) | set(loops.PAID) <= set(loops.LOOPS)


def test_what_work_costs_is_read_from_the_runtime_itself() -> None:
    for rails, asked in ((4, {"EVENT": 93}), (0, {"NEWTON": 8, "FACET": 25 + 8 * 16})):
        found = next(
            loops.costs(source, loops.Shape(8, 16, rails=rails))
            for source in (runtime_text(frozenset(one)) for one in SETS)
            if f"SMAP_COST_{next(iter(asked))} " in source
        )
        assert found | asked == found
        assert found["SIDE"] == 3 + 3 * 16 // 4
        # Every part has a cost, and each is taken somewhere.
        assert all(units > 0 for units in found.values())


def test_a_head_on_two_lines_is_read_whole_and_checks_are_left_out() -> None:
    source = "static int smap_f(void)\n{\n  for (i = 0; i < n &&\n       i < 3; i++) {\n  }\n}\n"
    assert heads.heads(source) == {3: "i = 0; i < n && i < 3; i++"}
    assert heads.heads(source.replace("smap_f", "smap_check_f")) == {}


@pytest.mark.parametrize(
    "line",
    ["  while (!ready) {", "  for (i = 0; i < other; i++) {", "  goto again;", "  } while (x);"],
)
def test_a_loop_that_is_not_listed_is_refused(line: str) -> None:
    source = runtime_text(frozenset(SETS[0])) + f"\nstatic void smap_f(void)\n{{\n{line}\n}}\n"
    with pytest.raises(ExportError, match="bound"):
        loops.bounds(source, loops.Shape(2))


def test_the_halvings_of_a_binary_search_are_counted_by_trying() -> None:
    for nodes in range(2, 300):
        left, steps = nodes - 1, 0
        while left > 1:
            left, steps = (left + 1) >> 1, steps + 1
        assert loops.Shape(1, nodes=nodes).halvings == steps


def test_triples_of_contacts_are_counted_by_trying() -> None:
    for n in range(3, 17):
        # As smap_find_facets goes over them.
        tried = sum(n - 1 - j for i in range(n - 2) for j in range(i + 1, n - 1))
        assert loops.Shape(1, contacts=n).triples == tried


def test_a_jump_by_address_is_not_followed() -> None:
    for text in ("tbb\t[pc, r3]", "add\tpc, r3", "ldr.w\tpc, [r3]"):
        with pytest.raises(ExportError, match="table of branches"):
            parse(f"00000000 <f>:\n       0:\t{text}\n")
    for text in ("pop\t{r4, pc}", "ldr.w\tpc, [sp], #4", "bx\tlr"):
        (only,) = parse(f"00000000 <f>:\n       0:\t{text}\n")["f"]
        assert not only.falls


# Lines 3 and 5 of a made-up smap.c have the heads of an outer and an inner loop.
LISTING = """\
00000000 <inner>:
inner():
smap.c:1
       0:\tadds\tr0, #1
       2:\tbx\tlr

00000010 <outer>:
outer():
smap.c:3
      10:\tmovs\tr4, #4
smap.c:5
      12:\tmovs\tr5, #3
smap.c:6
      14:\tbl\t0 <inner>
smap.c:5
      18:\tsubs\tr5, #1
      1a:\tbne.n\t14 <outer+0x4>
smap.c:3
      1c:\tsubs\tr4, #1
      1e:\tbne.n\t12 <outer+0x2>
      20:\tbx\tlr
"""


def test_the_bound_of_nested_loops_is_what_one_counts_by_hand() -> None:
    bounds = Bounds(parse(LISTING), {3: 4, 5: 3}, [0, 2], {}, {}, {}, {}, 0)
    assert bounds.of("inner") == 2
    # A round of the inner loop: 3 instructions and the callee's 2.  It goes round 3 times, and
    # once more as it may be left at its end: 4 x 5 = 20.  A round of the outer: 1 + 20 + 2 = 23;
    # again once more than 4: 5 x 23.  And one before and one after.
    assert bounds.of("outer") == 1 + 5 * 23 + 1


def test_what_a_counter_counts_is_added_once_by_hand() -> None:
    known = parse(LISTING), {3: 4, 5: 3}, [0, 2], {}, {}
    bounds = Bounds(*known, {5: ("left", 6, 2)}, {}, 0)
    # The inner loop is gone through once a round of the outer one, which takes 1 + 5 + 2; its ways
    # back, 5 each, take 2 of 6 that are left: three for all rounds together.
    assert bounds.whole("outer") == 1 + 5 * 8 + 1 + 3 * 5
    # Calls of the callee, which takes 2, take 3 of 18: at most six, and not one in each round; and
    # one that takes none.
    bounds = Bounds(*known, {}, {"inner": (3, 1)}, 18)
    assert bounds.whole("outer") == 1 + 5 * (1 + 4 * 3 + 2) + 1 + 6 * 2 + 2


def test_a_loop_without_a_known_head_has_no_bound() -> None:
    with pytest.raises(ExportError, match="of no head"):
        Bounds(parse(LISTING), {3: 4}, [0, 2], {}, {}, {}, {}, 0).of("outer")


def test_a_loop_of_whose_head_nothing_is_left_is_known_by_its_body() -> None:
    source = (
        "{\n  for (i = 0; i < 3; i++) {\n    for (k = 0; k < 3; k++) {\n      x;\n    }\n  }\n}\n"
    )
    assert heads.spans(source) == {2: 6, 3: 5}
    # Line 6 of the listing is within the loop of line 5, which goes round three times.
    headless = LISTING.replace("smap.c:5\n      18", "smap.c:6\n      18")
    headless = headless.replace("smap.c:5\n      12", "smap.c:3\n      12")
    found = Bounds(parse(headless), {3: 4, 5: 3}, [0, 2], {}, {3: 8, 5: 7}, {}, {}, 0)
    assert found.of("outer") == 1 + 5 * 23 + 1
    nowhere = headless.replace("smap.c:6", "smap.c:9")
    with pytest.raises(ExportError, match="of no head"):
        Bounds(parse(nowhere), {3: 4, 5: 3}, [0, 2], {}, {3: 8, 5: 7}, {}, {}, 0).of("outer")


@needs_arm
def test_no_read_of_a_small_export_takes_longer_than_its_bound(tmp_path: Path) -> None:
    one = row(tmp_path)
    seen, most = measured(one, 2000), bounded(one)
    assert seen.keys() == most.keys()
    for call, count in seen.items():
        assert count <= most[call] < 4 * count
