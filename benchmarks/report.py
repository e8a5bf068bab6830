"""The plain text report of a run."""

from collections.abc import Iterable, Sequence

from benchmarks.cell import Cell
from benchmarks.directions import ASKED, Directions
from benchmarks.enumeration import Enumeration
from benchmarks.files import CONTENDERS, FileSweep
from benchmarks.postures import PostureSweep
from benchmarks.process import Processes


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return rows as text, columns aligned to the right except the first."""
    every = [list(head), *(list(row) for row in rows)]
    widths = [max(len(row[i]) for row in every) for i in range(len(head))]
    lines = []
    for row in every:
        first, *rest = (cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        lines.append("  ".join([row[0].ljust(widths[0]), *rest]) if first else "")
    lines.insert(1, "-" * len(lines[0]))
    return "\n".join(lines)


def rates_table(cells: list[Cell]) -> str:
    """Return evaluations per second, in millions: medians, best of ours in brackets."""
    names = ("fill", "sdg large", "sdg reused", "both large", "both reused", "c", "numpy")

    def rate(cell: Cell, name: str) -> str:
        return f"{cell.rates[name] / 1e6:,.3g}" if name in cell.rates else "-"

    return table(
        ["case", "dirs", "thr", *names, "best sdg", "best both"],
        (
            [
                f"{cell.contacts} {cell.stance}",
                f"{cell.directions:,}",
                str(cell.threads),
                *(rate(cell, name) for name in names),
                *(f"{cell.best[name] / 1e6:,.3g}" for name in ("sdg large", "both large")),
            ]
            for cell in cells
        ),
    )


def ratios_table(cells: list[Cell]) -> str:
    """Return ratios of medians and agreement."""

    def ratio(cell: Cell, faster: str, slower: str) -> str:
        value = cell.ratio(faster, slower)
        return f"{value:.3g}" if value == value else "-"

    head = ["case", "dirs", "thr", "sdg/fill", "reused/fill", "both/sdg", "C/sdg", "NumPy/sdg"]
    head += ["diff C", "diff NumPy", "NaN C", "NaN NumPy", "diff tip", "of nodes"]
    return table(
        head,
        (
            [
                f"{cell.contacts} {cell.stance}",
                f"{cell.directions:,}",
                str(cell.threads),
                ratio(cell, "fill", "sdg large"),
                ratio(cell, "fill", "sdg reused"),
                ratio(cell, "sdg large", "both large"),
                ratio(cell, "sdg large", "c"),
                ratio(cell, "sdg large", "numpy"),
                f"{cell.agreement['c'].difference:.0e}",
                f"{cell.agreement['numpy'].difference:.0e}",
                str(cell.agreement["c"].nan_mismatches),
                str(cell.agreement["numpy"].nan_mismatches),
                f"{cell.agreement['tip_angle'].difference:.0e}",
                f"{cell.agreement['c'].nodes:,}",
            ]
            for cell in cells
        ),
    )


def files_table(files: list[FileSweep]) -> str:
    """Return times in ms and ratios of end-to-end sweeps."""
    return table(
        [
            "channels",
            "n",
            "thr",
            "MB",
            *(f"{name} ms" for name in CONTENDERS),
            "ratio",
            "with fsync",
        ],
        (
            [
                " + ".join(f.channels),
                str(f.contacts),
                str(f.threads),
                f"{f.size / 1e6:.0f}",
                *(f"{f.times[name].median * 1e3:.0f}" for name in CONTENDERS),
                f"{f.ratio():.2f}",
                f"{f.ratio(' fsync'):.2f}",
            ]
            for f in files
        ),
    )


def stages_table(files: list[FileSweep]) -> str:
    """Return where the time of a sweep to a file goes, in ms, and its throughput."""
    stages = list(files[0].stages)
    return table(
        ["channels", "n", "thr", "MB/s", "M nodes/s", *(f"{name} ms" for name in stages)],
        (
            [
                " + ".join(f.channels),
                str(f.contacts),
                str(f.threads),
                f"{f.size / 1e6 / f.times['sweep'].median:.0f}",
                f"{f.size / 4e6 / len(f.channels) / f.times['sweep'].median:.0f}",
                *(f"{f.stages[name] * 1e3:.0f}" for name in stages),
            ]
            for f in files
        ),
    )


def postures_table(sweeps: list[PostureSweep]) -> str:
    """Return rates and stages of the sweeps of a million postures."""
    names = ("kinematics", "facets", "region", "rest", "writing")

    def stages(sweep: PostureSweep) -> dict[str, float]:
        known = sum(sweep.stages[name] for name in ("kinematics", "facets", "region"))
        return {**sweep.stages, "rest": sweep.stages["memory"] - known}

    return table(
        ["n", "thr", "M eval/s memory", "to file", *(f"{name} %" for name in names)],
        (
            [
                str(s.contacts),
                str(s.threads),
                f"{s.memory_rate / 1e6:.2f}",
                f"{s.file_rate / 1e6:.2f}",
                *(f"{100.0 * stages(s)[name] / s.stages['memory']:.0f}" for name in names),
            ]
            for s in sweeps
        ),
    )


def directions_table(rows: list[Directions]) -> str:
    """Return nanoseconds per direction, and ratios to C and NumPy."""
    return table(
        ["thr", *ASKED, "c", "numpy", "C/three", "NumPy/three", "diff C", "diff NumPy"],
        (
            [
                str(row.threads),
                *(f"{row.times[name]:.1f}" for name in (*ASKED, "c", "numpy")),
                *(f"{row.times[name] / row.times['three']:.3g}" for name in ("c", "numpy")),
                *(f"{row.differences[name]:.0e}" for name in ("c", "numpy")),
            ]
            for row in rows
        ),
    )


def enumeration_table(rows: list[Enumeration]) -> str:
    """Return microseconds per posture and shares of a sweep of 1,014 directions."""
    return table(
        ["primitives", "n", "limits", "facets", "us facets", "us region", "us sweep", "share %"],
        (
            [
                row.kind,
                str(row.contacts),
                "90/30" if row.limits_on else "off",
                f"{row.facets_found:.1f}",
                f"{row.facets_us:.2f}",
                f"{row.region_us:.2f}",
                f"{row.sweep_us:.1f}",
                f"{100.0 * row.share:.0f}",
            ]
            for row in rows
        ),
    )


def processes_text(processes: Processes) -> str:
    """Return the times of whole processes in words."""
    if processes.help is None or processes.map_warm is None:
        return "skipped: the command `lutgen` is not installed beside this Python"
    return (
        f"lutgen --help: {processes.help.median:.3f} s (best {processes.help.best:.3f})\n"
        f"50 x 50 map at one direction, compiled kernels cached: {processes.map_warm.median:.2f} s "
        f"(best {processes.map_warm.best:.2f})\n"
        f"the same with an empty kernel cache: {processes.map_cold:.1f} s"
    )
