"""The page's sections on errata and forces, and on what is left out."""

import math

from lutgen.paper.errata import force_statistics, force_table, triple_statistics
from lutgen.paper.page import Page
from lutgen.paper.results import Results

__all__ = ["errata_section", "forces_section", "omitted_section"]


def errata_section(page: Page, results: Results) -> None:
    """List the errata, and the number that decides each."""
    page.heading("Errata, each with its check", "errata")
    wrong = [each for each in results.errata if not each.confirmed]
    right = [each for each in results.errata if each.confirmed]
    page.paragraph(
        f"{len(wrong)} places of the paper are wrong or contradict each other, {len(right)} that "
        "looked doubtful are right as printed. Every number was computed for this page: by the "
        "form as printed, by ours, and by a third way that knows neither."
    )
    for title, group in (("Wrong or contradictory", wrong), ("Right as printed", right)):
        page.subheading(title)
        page.table(
            ["place", "printed", "correct", "why"],
            [[each.place, each.printed, each.correct, each.why] for each in group],
        )
        page.table(
            ["place", "what was computed", "as printed", "ours", "reference"],
            [
                [each.place, c.claim, *map(_shown, (c.printed, c.ours, c.reference))]
                for each in group
                for c in each.checks
            ],
            "The checks.",
        )


def _shown(value: float) -> str:
    """Return a number for the table of checks."""
    return "0/0" if math.isnan(value) else f"{value:.8g}"


def forces_section(page: Page) -> None:
    """Compare the paper's Eq 12 with exact statics, and its choice of wheels with the hull."""
    page.heading("Normal forces: Eq 12 against the exact ones", "forces")
    page.paragraph(
        "Friction lies in the contact plane and has no moment about axes in it, so three normal "
        "forces follow from balance alone. Eq 12, without its leading minus, adds up to the whole "
        "but does not balance: at a tip-over axis it still gives the lifting wheel a fifth."
    )
    page.table(
        ["pitch (deg)", "heading (deg)", "exact shares", "Eq 12", "largest error"],
        [
            [
                row.pitch_deg,
                row.heading_deg,
                "  ".join(f"{share:.4f}" for share in row.exact),
                "  ".join(f"{share:.4f}" for share in row.heuristic),
                f"{row.largest_error:.3f}",
            ]
            for row in force_table()
        ],
        "The nominal robot on a slope; heading 0: wheel 1 points uphill.",
    )
    page.table(
        ["triangles", "mean error", "95th percentile", "worst", "a wheel pulls at the ground"],
        [
            [
                each.triangles,
                f"{each.mean:.3f}",
                f"{each.p95:.3f}",
                f"{each.worst:.3f}",
                f"{100 * each.negative:.1f} %",
            ]
            for each in force_statistics()
        ],
        "Largest error of Eq 12 in a share, over random loads inside the triangle.",
    )
    triples = triple_statistics()
    page.paragraph(
        "More than three wheels: the triple that passes the paper's two tests is the facet of the "
        "contacts' convex hull through which gravity's ray leaves it. Checked by brute force on "
        f"{triples.sets} random sets of 4 to 7 contacts: {triples.agree} agree, {triples.tipping} "
        f"of them with no such facet; never more than {triples.most_passing} triple passed."
    )


def omitted_section(page: Page) -> None:
    """Name what the report leaves out."""
    page.heading("What is not here", "omitted")
    page.paragraph(
        "Pictures 1 to 3 are photographs, Figs 1 and 2 renderings of a robot base, and Figs 3 "
        "and 6 block diagrams; they hold no result to compute. The inverse kinematics, "
        "which the paper announces, is `lutgen wheels`."
    )
