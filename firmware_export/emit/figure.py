"""NAME_pareto.png: bytes of flash against error of the candidates, the chosen one marked.

It draws into bytes and writes no file.  The same candidates give the same bytes.
"""

import io
from typing import Any

from firmware_export.codecs import codec as info

_GREY = "#595959"
_SETTINGS: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.linewidth": 0.6,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "legend.fontsize": 7,
    "legend.frameon": False,
}
# Inches: one column of a journal.
_SIZE, _DPI = (3.5, 2.6), 200


def _size(row: dict[str, Any]) -> int:
    return int(row.get("total_bytes") or row["bytes"])


def draw_pareto(pareto: list[dict[str, Any]], measure: str = "largest") -> bytes | None:
    """Return the plot as PNG, or None where there is nothing to choose from: fewer than two sizes.

    Candidates without an error above 0 are left out; `measure` says which error it is, such as
    ``largest`` or ``99th percentile``.
    """
    rows = [row for row in pareto if (row.get("error") or 0.0) > 0.0 and _size(row) > 0]
    if len(set(map(_size, rows))) < 2:
        return None
    import matplotlib.style
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import (
        FixedLocator,
        FuncFormatter,
        MaxNLocator,
        NullFormatter,
        NullLocator,
    )

    with matplotlib.style.context(["default", _SETTINGS]):
        figure = Figure(figsize=_SIZE, layout="constrained", dpi=_DPI)
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        axes.set_xscale("log")
        axes.set_yscale("log")
        for codec in sorted({str(row.get("codec", "")) for row in rows}):
            own = sorted((row for row in rows if row.get("codec", "") == codec), key=_size)
            colour, marker = info(codec).look
            sizes = [_size(row) for row in own]
            errors = [float(row["error"]) for row in own]
            axes.plot(sizes, errors, marker, ms=2.6, mew=0, color=colour, label=codec)
        front = _front(rows)
        axes.step(*zip(*front, strict=True), where="post", color=_GREY, lw=0.6, zorder=1)
        for row in rows:
            if row.get("chosen"):
                at = (_size(row), float(row["error"]))
                axes.plot(*at, "o", ms=8, mfc="none", mec="black", mew=0.9, label="chosen")
        with_code = all(row.get("total_bytes") for row in rows)
        axes.set_xlabel(f"flash: tables{' and code' if with_code else ''} [bytes]")
        axes.set_ylabel(f"{measure} error\nof $|SD_g|$ [% of range]")
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        for axis, values in (
            (axes.xaxis, [float(_size(row)) for row in rows]),
            (axes.yaxis, [float(row["error"]) for row in rows]),
        ):
            low, high = min(values), max(values)
            axis.set_minor_formatter(NullFormatter())
            if high < 20.0 * low:
                # Hardly a decade: powers of ten would leave one label or none.
                margin = (high / low) ** 0.05
                low, high = min(low / margin, 0.98 * low), max(high * margin, 1.02 * high)
                ticks = MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(low, high)
                axis.set_major_locator(FixedLocator([at for at in ticks if low <= at <= high]))
                axis.set_minor_locator(NullLocator())
                axis.axes.set(**{f"{axis.axis_name}lim": (low, high)})
        axes.grid(True, lw=0.3, color="#d0d0d0")
        axes.set_axisbelow(True)
        axes.legend(loc="best", handletextpad=0.3)
        stream = io.BytesIO()
        figure.savefig(stream, format="png", dpi=_DPI, metadata={"Software": None})
    return stream.getvalue()


def _front(rows: list[dict[str, Any]]) -> list[tuple[int, float]]:
    """Return size and error of the candidates that no smaller one beats."""
    front: list[tuple[int, float]] = []
    for size, error in sorted((_size(row), float(row["error"])) for row in rows):
        if not front or error < front[-1][1]:
            front.append((size, error))
    return front
