"""The template of the paper's page: every number is computed, and every computed number used."""

import re
from pathlib import Path
from string import Formatter
from typing import Any

import pytest

from lutgen.paper.errata import ROWS
from lutgen.paper.markup import inline, plain
from lutgen.paper.numbers import page_numbers
from lutgen.paper.page import Table, render, shown_together
from lutgen.paper.page_tables import page_tables
from lutgen.paper.pictures import painters
from lutgen.paper.published import PRINTED
from lutgen.paper.report import TEMPLATE
from lutgen.paper.results import Results

# What may hold digits: placeholders, words of the paper, code, formulas (with a letter), names of
# files and tables, and references to equations, figures, steps and wheels by number.
NUMBER_LISTS = r"\d+(?:(?:,| and| to|,? or) \d+)*"
EXEMPT = (
    r"\{[^}]*\}",
    "\u201c[^\u201d]*\u201d",
    r"`[^`]*`",
    r"\$[^$]*[^\W\d_][^$]*\$",
    r"\]\([^)]*\)",
    rf"\b(?:Eqs?|Figs?|Figures?|Table|Pictures?|[Ss]imulation|[Ss]teps?|wheel) {NUMBER_LISTS}\b",
    r"\bP[123]\b",
)


def typed_numbers(text: str) -> list[str]:
    """Return the numbers that somebody typed into prose."""
    for pattern in EXEMPT:
        text = re.sub(pattern, "", text)
    return re.findall(r"\d[\d.,]*", text)


def fields(text: str) -> set[str]:
    """Return the names of a text's placeholders, without what they look up in what is named."""
    return {re.split(r"[.\[]", name)[0] for _, name, _, _ in Formatter().parse(text) if name}


@pytest.fixture(scope="module")
def numbers(results: Results) -> dict[str, Any]:
    return page_numbers(results, 12.0)


def test_no_number_is_typed_into_the_pages_prose() -> None:
    assert typed_numbers(TEMPLATE) == []


def test_numbers_in_the_words_of_the_errata_are_computed_or_printed_in_table_1() -> None:
    angles = {angle for row in PRINTED["table"] for angle in row["angles_deg"]}
    for row in ROWS:
        for key in ("place", "printed", "correct", "why"):
            assert set(typed_numbers(row[key])) <= angles, row


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("about 1.28 times them", ["1.28"]),
        ("75,018 times faster", ["75,018"]),
        ("in 72 % of Eqs 30 to 33 and Figs 3 and 6", ["72"]),
        ("a factor of $1.7$", ["1.7"]),
        ("$x^2$ at {radius:.6f} in \u201c100 points\u201d, `map2.csv`, step 6, P1", []),
    ],
)
def test_a_typed_number_is_noticed(text: str, found: list[str]) -> None:
    assert typed_numbers(text) == found


def test_every_placeholder_is_filled_and_every_computed_number_used(
    numbers: dict[str, Any],
) -> None:
    assert fields(TEMPLATE) == set(numbers)
    filled = TEMPLATE.format_map(numbers)
    assert not re.search(r"[{}]|\bnan\b|\binf\b", filled)


def test_every_table_and_figure_stands_on_the_page_once(results: Results) -> None:
    shown = re.findall(r"^!\[.*\]\((.*)\)$", TEMPLATE, flags=re.M)
    made = [f"{stem}.png" for stem in painters(results)]
    made += [f"table:{name}" for name in page_tables(results)]
    assert sorted(shown) == sorted(made)


def test_no_figure_number_is_given_twice() -> None:
    captions = re.findall(r"^!\[(Figs?) ([\d and]+):", TEMPLATE, flags=re.M)
    found = [int(number) for _, listed in captions for number in re.findall(r"\d+", listed)]
    assert found == sorted(set(found)) == [4, 5, *range(7, 18)]


def test_the_numbers_of_the_prose_are_those_of_the_simulations(numbers: dict[str, Any]) -> None:
    # Ours over the printed entries of Table 1, at the scale at which the robot tips at 10.
    assert numbers["ratio"] == pytest.approx([1.15, 2.23, 0.80, 1.31, 1.27, 1.28], abs=5.1e-3)
    assert 0.0 < numbers["ratio_low"] < 1.28 < numbers["ratio_high"]
    assert (numbers["nearest_edge"], numbers["steepest_deg"]) == pytest.approx((10.0, 86.19), 1e-4)
    assert (numbers["zero_of_line"], numbers["zero_of_last"]) == pytest.approx(
        (30.95908, 30.96377), abs=5e-6
    )
    # An hour over the time of the sweep, rounded down to one digit.
    assert re.fullmatch(r"[1-9]0*", str(numbers["faster"]))
    assert numbers["faster"] <= 3600e3 / numbers["file_ms"] < 2.0 * numbers["faster"] * 1.001


def test_loads_of_the_force_statistics_are_on_the_page(results: Results) -> None:
    text = page_tables(results)["loads"].html("")
    assert text.count('<td class="number">200,000</td>') == 2


def test_columns_of_numbers_are_right_aligned_and_have_equal_decimals(results: Results) -> None:
    for name, table in page_tables(results).items():
        cells = re.findall(r"<td( class=\"number\")?>(.*?)</td>", table.html(""))
        assert len(cells) == len(table.rows) * len(table.head)
        for place, (words, spec) in enumerate(table.head):
            column = cells[place :: len(table.head)]
            assert {kind for kind, _ in column} == {' class="number"' if spec else ""}
            if spec and spec != "s":
                shown = {re.sub(r"\d", "", text.partition(".")[2]) for _, text in column}
                decimals = {len(text.partition(".")[2]) for _, text in column if text != "\u2013"}
                assert len(decimals) == 1, (name, words, shown)


def test_numbers_beside_each_other_have_the_same_decimals() -> None:
    assert shown_together([1.2295, 1.66803]) == ["1.22950", "1.66803"]
    assert shown_together([0.0, 0.0, 0.0]) == ["0", "0", "0"]
    assert shown_together([7.5e-16, 0.0]) == ["0", "0"]
    assert shown_together([float("nan"), 0.8, 0.8]) == ["0/0", "0.8", "0.8"]
    assert shown_together([-1e-9, 5.0]) == ["0", "5"]


def test_formulas_have_indices_exponents_and_real_minus_signs() -> None:
    assert inline("$-n_a^2$") == (
        '<span class="formula">\u2212<i>n</i><sub>a</sub><sup>2</sup></span>'
    )
    assert inline("$sin alpha$") == '<span class="formula">sin <i>\u03b1</i></span>'
    assert inline("from -6.25 to 1\u20132, well-known") == (
        "from \u22126.25 to 1\u20132, well-known"
    )
    assert plain("`a` of $|SD_g|$") == "a of |SD_g|"


def test_text_is_escaped_and_small_numbers_are_powers_of_ten() -> None:
    table = Table([("a", ""), ("b", ".2e"), ("c", "s")], [["<b>", 1.5e-7, "0.1"], ["", None, "-2"]])
    text = render("# T <x>\n\n## A & B\n\nwords\n\n> note\n\n![c](table:t)", {}, {"t": table})
    assert "<h1>T &lt;x&gt;</h1>" in text
    assert '<h2 id="a-b">A &amp; B</h2>' in text
    assert '<p class="note">note</p>' in text
    assert "<td>&lt;b&gt;</td>" in text
    assert "1.50\u00b710<sup>\u22127</sup>" in text
    assert '<td class="number">\u2013</td><td class="number">\u22122</td>' in text


def test_the_words_ship_with_the_package() -> None:
    folder = Path(__file__).resolve().parents[2]
    listed = (folder / "pyproject.toml").read_text(encoding="utf-8")
    kinds = re.search(r'"lutgen.paper" = \[(.*)\]', listed)
    assert kinds
    data = {p.suffix for p in (folder / "lutgen" / "paper").iterdir() if p.is_file()} - {".py"}
    assert data == {suffix for suffix in re.findall(r"\*(\.\w+)", kinds.group(1))}
