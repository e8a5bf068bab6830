"""The published method: its equations as printed, and what is wrong with them.

In reading order: `printed`, `forces`, `closed_form`, `erratum`, `errata_path`, `reference`,
`triples`, `errata_plane`, `errata_polygon`, `errata_statics`, `published`, `errata_text`,
`errata`, `page`, `robot`, `rough`, `simulations`, `pictures`, `results`, `tables`, `sections`,
`sections_checks`, `report`.
"""

from lutgen.paper.report import write_report

__all__ = ["write_report"]
