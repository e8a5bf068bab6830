"""One entry for all figures."""

from typing import Unpack

from matplotlib.figure import Figure

from lutgen.errors import InputError
from lutgen.mapping import StabilityMap
from lutgen.plot.choices import Choices, choose
from lutgen.plot.kinds import KINDS
from lutgen.plot.style import house_style, settled
from lutgen.recipe import Recipe

__all__ = ["draw"]

# Sides in inches: nothing can be read below, and pictures grow too large above.
SMALLEST, LARGEST = 2.0, 40.0


def draw(
    kind: str,
    source: StabilityMap | Recipe,
    *,
    size: tuple[float, float] | None = None,
    **asked: Unpack[Choices],
) -> Figure:
    """Draw a figure.

    Parameters
    ----------
    kind : {"curve", "contour", "surface", "sphere", "polar", "metrics", "robot"}
        `curve`: `channel` and the height over one parameter; `contour`, `surface`: `channel`
        over two parameters; `sphere`: `channel` over all gravity directions of the chart;
        `polar`: largest tilt before tip-over in each heading; `metrics`: five metrics over all
        headings at one tilt; `robot`: the body in 3-D.
    source : StabilityMap or Recipe
        For a map, `contour` and `surface` draw its nodes and `curve` marks them.  All else, such
        as tip-over boundaries, is evaluated exactly, as everything is for a recipe.
    params : mapping of str to float, optional
        Parameters in their display unit (deg for angles); the others are in the middle of their
        range.
    gravity : (3,) array_like
        Direction in the body frame, pointing down; not used by `sphere`, `polar` and
        `metrics`.
    channel : str
        One of `quantities.RANKED`; not used by `polar`, `metrics` and `robot`.
    axes : sequence of str, optional
        The parameters that `curve` (one), `contour` and `surface` (two) vary; by default the
        first ones that `params` does not fix.
    convention : {"body", "plane"}
        Whether gravity is fixed in the body frame, or relative to the contact plane, so that it
        turns in the body while the shape changes (T_g, see `lutgen.channels.settle`).  The
        latter for recipes only, and not for `sphere`, `polar` and `metrics`.
    tilt : float
        Degrees; used by `metrics` only.
    size : (float, float), optional
        Width and height in inches; the default fits a journal's column.

    Returns
    -------
    matplotlib.figure.Figure
        Independent of pyplot; see `save`.

    Raises
    ------
    InputError
        For an unknown kind, parameter or channel, a value outside its range, and a direction
        that the map does not cover.
    """
    view = choose(kind, source, asked)
    if size is not None and not all(SMALLEST <= side <= LARGEST for side in size):
        raise InputError(
            f"plot: a figure measures {SMALLEST:g} to {LARGEST:g} in a side (got "
            f"{' x '.join(f'{side:g}' for side in size)}); give width and height in inches."
        )
    with house_style():
        return settled(KINDS[kind].paint(view, size))
