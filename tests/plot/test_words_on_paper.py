"""No words of a figure cover others or leave the paper, whatever the robot's parts are called."""

import re
from itertools import combinations

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from lutgen.plot import draw, on_sheet
from lutgen.plot.fonts import said_once
from lutgen.plot.levels import inks
from lutgen.plot.words import folded, printed
from lutgen.recipe import Recipe, parse_recipe
from tests.fixtures.length import part

# Dots: letters have room around them that is theirs, and none of it ink.
CLEAR = 2.0
KINDS = ("curve", "contour", "surface", "sphere", "polar", "metrics", "robot")
# Strange robots: one of each kind, at length 50 (six minutes).
STRANGE = part(50, 7)
SYLLABLES = (
    *("front", "rear", "left", "wheel", "suspension", "a", "of_the", "Höhe", "роботик", "ύψος"),
    *("carrier", "x", "alpha", "track", "tip", "II", "manipulator", "_", "angle", "履帯", "גלגל"),
)
PLAIN = tuple(part for part in SYLLABLES if part.isascii())


def corners(text: Text) -> np.ndarray:
    """Return the corners (4, 2) of a text's box, turned as the text is, dots."""
    turn = text.get_rotation()
    text.set_rotation(0.0)
    # Of a note without the line to what it names.
    box = Text.get_window_extent(text).padded(-CLEAR)
    text.set_rotation(turn)
    whole = Text.get_window_extent(text)
    middle = np.array([(whole.x0 + whole.x1) / 2.0, (whole.y0 + whole.y1) / 2.0])
    half = np.array([box.width, box.height]) / 2.0
    angle = np.radians(turn)
    across = np.array([np.cos(angle), np.sin(angle)])
    up = np.array([-across[1], across[0]])
    return np.array(
        [middle + a * half[0] * across + b * half[1] * up for a in (-1, 1) for b in (-1, 1)]
    )


def apart(one: np.ndarray, other: np.ndarray) -> bool:
    """Tell whether a line separates two boxes, which is along a side of one of them."""
    for box in (one, other):
        for side in (box[1] - box[0], box[2] - box[0]):
            size = np.linalg.norm(side)
            if size == 0.0:
                continue
            a, b = one @ side / size, other @ side / size
            if a.max() <= b.min() or b.max() <= a.min():
                return True
    return False


def words_of(figure: Figure) -> list[tuple[str, np.ndarray]]:
    """Return the texts that a figure shows, and where; ticks beyond an axis are never drawn."""
    drawn: list[Text] = []
    with pytest.MonkeyPatch.context() as patch:
        draw_text = Text.draw
        patch.setattr(
            Text, "draw", lambda text, renderer: drawn.append(text) or draw_text(text, renderer)
        )
        with said_once():
            figure.draw_without_rendering()
    seen = {id(text): text for text in drawn if text.get_visible() and text.get_text().strip()}
    return [(text.get_text(), corners(text)) for text in seen.values()]


def check(figure: Figure, what: str) -> None:
    """Demand that no text covers another and none leaves the paper."""
    words = words_of(figure)
    assert len(words) > 4, what
    for (one, here), (other, there) in combinations(words, 2):
        assert apart(here, there), f"{what}: {one!r} covers {other!r}"
    for text, box in words:
        low, high = box.min(axis=0), box.max(axis=0)
        assert low.min() >= -CLEAR, f"{what}: {text!r} leaves the paper"
        assert (high <= figure.bbox.max + CLEAR).all(), f"{what}: {text!r} leaves the paper"


def strange(seed: int) -> Recipe:
    """Return a robot with names of all lengths and in several scripts."""
    rng = np.random.default_rng(seed)

    def name(most: int, letters: tuple[str, ...] = SYLLABLES) -> str:
        parts = [str(rng.choice(letters)) for _ in range(int(rng.integers(1, most)))]
        return re.sub(r"_+", "_", "_".join(parts)).strip("_") + f"_{rng.integers(1000)}"

    height, turn = name(7, PLAIN), name(7, PLAIN)
    unit = str(rng.choice(["mm", "m", "cm", "1"]))
    size = float(10.0 ** rng.uniform(-2.0, 4.0))
    chart = rng.choice(['chart = "cone"\nmax_tilt = 70.0', 'chart = "sphere"'])
    feet = "\n".join(
        f'[[robot.contact]]\nname = "{name(5)}"\nlink = "{link}"\nposition = '
        f"[{x * size * rng.uniform(0.5, 2.0)}, {y * size}, {-rng.uniform(0.3, 1.0) * size}]"
        for link, x, y in (("body", 1, 1), ("arm", 1, -1), ("body", -1, 1), ("leg", -1, -1))
    )
    return parse_recipe(f"""
[robot]
name = "{name(8)}"
length_unit = "{unit}"
friction = {rng.uniform(0.2, 0.9):.2f}
[[robot.parameter]]
name = "{height}"
min = 0.0
max = {0.3 * size}
unit = "{unit}"
[[robot.parameter]]
name = "{turn}"
min = -{rng.integers(5, 180)}.0
max = 40.0
unit = "deg"
[[robot.link]]
name = "body"
[[robot.link]]
name = "leg"
parent = "body"
joint = {{ type = "prismatic", axis = [0, 0, -1], parameter = "{height}" }}
[[robot.link]]
name = "arm"
parent = "body"
joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{turn}" }}
{feet}
[sweep]
samples = {{ "{height}" = 5, "{turn}" = 5 }}
[sweep.gravity]
{chart}
nodes = 9
channels = ["sdg", "tip_angle"]
""")


@pytest.mark.filterwarnings("error:Glyph")
@pytest.mark.parametrize("seed", range(STRANGE))
def test_words_of_figures_of_strange_robots_cover_nothing(seed: int) -> None:
    recipe, kind = strange(seed), KINDS[seed % len(KINDS)]
    check(draw(kind, recipe), f"robot {seed}, {kind}")


def test_words_stay_apart_at_the_narrowest_size() -> None:
    recipe = strange(3)
    with on_sheet("85"):
        for kind in ("contour", "polar"):
            check(draw(kind, recipe), kind)


def test_lines_on_colours_are_told_from_them() -> None:
    from matplotlib import colormaps

    for count in range(3, 14):
        steps = np.linspace(0.0, 1.0, count)
        fills = colormaps["viridis"](np.linspace(0.0, 1.0, count - 1))[:, :3]
        linear = np.where(fills <= 0.04045, fills / 12.92, ((fills + 0.055) / 1.055) ** 2.4)
        bright = linear @ [0.2126, 0.7152, 0.0722]
        for at, ink in enumerate(inks(steps)):
            own = 1.0 if ink == "white" else 0.0
            middle = (bright[at] + bright[at + 1]) / 2.0
            contrast = (max(own, middle) + 0.05) / (min(own, middle) + 0.05)
            assert contrast >= 4.5, (count, at, contrast)


def test_long_words_are_cut_behind_what_joins_them_and_formulas_never() -> None:
    assert folded("front_left_wheel_carrier", 12) == "front_left_\nwheel_\ncarrier"
    assert folded(r"$|SD_g|$ and $\alpha$", 3) == "$|SD_g|$\nand\n$\\alpha$"
    assert printed(r"$\alpha$ = 3") == 5
    for longest in range(1, 30):
        lines = folded("one_two three-four fivesixseven\neight", longest).split("\n")
        assert max(map(printed, lines)) <= longest
