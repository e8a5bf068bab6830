"""No words of a figure cover others or leave the paper, whatever the robot's parts are called."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.text import Text

from lutgen.plot import draw, draw_path, on_sheet
from lutgen.plot.style import ANGLES, FACTOR, ink_on, said_once
from lutgen.recipe import parse_recipe
from lutgen.search import along, drive
from tests.fixtures.length import part
from tests.fixtures.recipes import tripod

# Dots: letters have room around them that is theirs, and none of it ink.
CLEAR = 2.0
KINDS = ("curve", "contour", "surface", "sphere", "polar", "robot")
# Strange robots: one of each kind, at length 50 (six minutes).
STRANGE = part(50, 6)
PLAIN = ("front", "rear", "left", "wheel", "suspension", "a", "of_the", "carrier", "alpha", "II")
SYLLABLES = (*PLAIN, "Höhe", "роботик", "ύψος", "履帯", "גלגל", "$5", r"\\t", "x^2", "manipulator")


def corners(text):
    """Return the corners (4, 2) of a text's box, turned as the text is, dots."""
    turn = text.get_rotation()
    text.set_rotation(0.0)
    # Of a note without the line to what it names.
    box = Text.get_window_extent(text).padded(-CLEAR)
    text.set_rotation(turn)
    middle = np.mean(Text.get_window_extent(text).get_points(), axis=0)
    angle = np.radians(turn)
    axes = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    signs = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    return middle + signs * np.array([box.width, box.height]) / 2.0 @ axes


def apart(one, other):
    """Tell whether a line separates two boxes, which is along a side of one of them."""
    sides = [box[i] - box[0] for box in (one, other) for i in (1, 2)]
    return any(
        (one @ s).max() <= (other @ s).min() or (other @ s).max() <= (one @ s).min()
        for s in sides
        if s.any()
    )


def check(figure, what):
    """Demand that no text covers another and none leaves the paper."""
    drawn = {}
    with pytest.MonkeyPatch.context() as patch, said_once():
        draw_text = Text.draw
        patch.setattr(
            Text, "draw", lambda text, r: (drawn.update({id(text): text}), draw_text(text, r))
        )
        figure.draw_without_rendering()
    words = [
        (t.get_text(), corners(t))
        for t in drawn.values()
        if t.get_visible() and t.get_text().strip()
    ]
    assert len(words) > 4, what
    for (one, here), (other, there) in combinations(words, 2):
        assert apart(here, there), f"{what}: {one!r} covers {other!r}"
    for text, box in words:
        inside = (box >= -CLEAR).all() and (box <= figure.bbox.max + CLEAR).all()
        assert inside, f"{what}: {text!r} leaves the paper"


def strange(seed):
    """Return a robot with names of all lengths and in several scripts, and with lines in them."""
    rng = np.random.default_rng(seed)

    def name(most, parts=SYLLABLES):
        return "_".join(rng.choice(parts, int(rng.integers(1, most)))) + f"_{rng.integers(1000)}"

    chart = rng.choice(["cone", "sphere"])
    text = tripod(chart=chart, **({"max_tilt": 70.0} if chart == "cone" else {}))
    for old in ("reach", "swing"):
        text = text.replace(old, name(7, PLAIN))
    text = text.replace('name = "tripod"', f'name = "x"\ntitle = "{name(8)}\\n{name(4)}"')
    return parse_recipe(text.replace('"m"', f'"{rng.choice(["mm", "m", "cm", "1"])}"'))


@pytest.mark.filterwarnings("error:Glyph")
@pytest.mark.parametrize("seed", range(STRANGE))
def test_words_of_figures_of_strange_robots_cover_nothing(seed):
    recipe, kind = strange(seed), KINDS[seed % len(KINDS)]
    check(draw(kind, recipe), f"robot {seed}, {kind}")


def test_words_stay_apart_at_the_narrowest_size():
    with on_sheet("85"):
        for kind in ("curve", "contour", "polar"):
            figure = draw(kind, strange(3))
            assert figure.get_figwidth() == pytest.approx(85.0 / 25.4)
            check(figure, kind)
    with on_sheet("200x80", "dark"):
        assert draw("robot", strange(3)).get_figheight() <= 80.0 / 25.4 + 1e-9


@pytest.mark.parametrize(
    "points",
    [
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]],
        [[0, 0, 0], [0, 50, 0.5], [3, 90, 0.2]],
        [[1e6, 5, 0], [1e6 + 1, 5, 2], [1e6 + 1.5, 5, 3]],
    ],
)
def test_words_of_any_path_cover_nothing(two, points):
    rates = {"alpha": 0.001}
    straight = drive(two, along(points), control=False)
    free = drive(two, along(points), lag=0, headings=8, rates=rates, speed=1.0)
    for runs in ({"turning": free}, {"fixed": straight, "turning": free}, {"fixed": straight}):
        check(draw_path(two, runs), list(runs))


def test_letters_on_colours_can_be_read():
    for cmap in (ANGLES, FACTOR):
        fills = cmap(np.linspace(0.0, 1.0, 64))[:, :3]
        linear = np.where(fills <= 0.04045, fills / 12.92, ((fills + 0.055) / 1.055) ** 2.4)
        for fill, bright in zip(fills, linear @ [0.2126, 0.7152, 0.0722], strict=True):
            own = 1.0 if ink_on(fill) == "white" else 0.01
            # WCAG asks for 3 : 1 for bold and large letters.
            assert (max(own, bright) + 0.05) / (min(own, bright) + 0.05) > 3.0, fill
