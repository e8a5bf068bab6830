"""The published method: its equations as printed, and what is wrong with them.

The words are data: `errata.toml` those of the errata, `page.md.in` those of the page, and
`published.toml` what the paper prints.

In reading order: `nominal`, `printed`, `published`, `closed_form`, `erratum`, `checks_path`,
`forces`, `reference`, `triples`, `checks_plane`, `checks_polygon`, `checks_statics`,
`checks_text`, `errata`, `markup`, `page`, `robot`, `rough`, `simulations`, `results`, `pictures`,
`numbers`, `tables`, `page_tables`, `manifest`, `report`.
"""

from lutgen.paper.report import write_report

__all__ = ["write_report"]
