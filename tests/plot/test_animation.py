"""The film of `lutgen path --animate`: frames, size, the same bytes twice, and what is red."""

import math
from functools import partial
from itertools import pairwise

import numpy as np
from PIL import Image

from lutgen.plot import animate
from lutgen.search.driving import drive
from lutgen.search.terrain import paper_path, turned
from tests.fixtures import commands
from tests.fixtures.places import MAPS

NOMINAL = [math.atan(0.6)] * 2
# Dots.
SIZE = (640, 448)


def by_hand(two, points, **options):
    path = turned(paper_path(points), math.radians(30.0))
    return drive(two, path, params0=NOMINAL, **options)


def frames(path):
    """Return the pictures of a GIF, (height, width, 3)."""
    with Image.open(path) as film:
        result = []
        for i in range(getattr(film, "n_frames", 1)):
            film.seek(i)
            result.append(np.asarray(film.convert("RGB")))
    return result


run = partial(commands.run, "path")


def is_red(picture):
    """Tell whether there is red in the line of the titles."""
    r, g, b = picture[:40].astype(int).transpose(2, 0, 1)
    return bool(((r > 150) & (g < 110) & (b < 110)).any())


def test_the_title_is_red_where_the_robot_tips_and_nowhere_else(two, tmp_path):
    fixed = by_hand(two, 4, control=False)
    changing = by_hand(two, 4)
    animate(two, {"fixed shape": fixed, "changing shape": changing}, tmp_path / "film.gif")
    pictures = frames(tmp_path / "film.gif")
    half = SIZE[0] // 2
    for film, drawn in ((slice(None, half), fixed), (slice(half, None), changing)):
        assert [is_red(picture[:, film]) for picture in pictures] == drawn.tips.tolist()
    # Both sides show both, and not the same.
    assert 0 < changing.tips.sum() < fixed.tips.sum() < 4


def test_the_command_writes_the_film_of_the_library(two, tmp_path):
    recipe, film = MAPS / "paper_two.toml", tmp_path / "film.gif"
    angles = [f"{name}={math.degrees(NOMINAL[0])!r}" for name in ("alpha", "gamma")]
    given = ("-p", angles[0], "-p", angles[1], "--turn", 30, "--points", 3)
    result = run(recipe, *given, "--animate", film)
    # With control it still tips over at one of these three points.
    assert result.exit_code == 3, result.stderr
    assert "changing shape" in result.stdout
    runs = {"fixed shape": by_hand(two, 3, control=False), "changing shape": by_hand(two, 3)}
    animate(two, runs, tmp_path / "same.gif")
    assert film.read_bytes() == (tmp_path / "same.gif").read_bytes()
    with Image.open(film) as shown:
        # 7.2 s for 3 frames would be slow: half a second each is the longest.
        found = (shown.size, shown.info["duration"], shown.info["loop"], shown.format)
    assert found == (SIZE, 500, 0, "GIF")
    assert all((one != other).any() for one, other in pairwise(frames(film)))


def test_an_mp4_gets_the_frames_that_a_film_may_have_where_there_is_ffmpeg(
    two, tmp_path, monkeypatch
):
    # It stands in for ffmpeg: what comes in goes to the file that is named last.
    program = tmp_path / "ffmpeg"
    program.write_text('#!/bin/sh\nfor last; do :; done\nexec /bin/cat > "$last"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path / "none"))
    none = run(two.source, "--points", 2, "--animate", tmp_path / "other.mp4")
    assert (none.exit_code, "an MP4 needs the program ffmpeg" in none.stderr) == (2, True)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("lutgen.plot.path.MOST_FRAMES", 3)
    film = tmp_path / "film.mp4"
    assert animate(two, {"fixed": by_hand(two, 90, control=False)}, film) == 3
    # Red, green, blue and opacity.
    assert film.stat().st_size == 3 * SIZE[0] * SIZE[1] * 4
    program.write_text("#!/bin/sh\nexit 1\n")
    result = run(two.source, "--points", 2, "--animate", tmp_path / "other.mp4")
    assert result.exit_code == 2
    assert "ffmpeg made no film" in result.stderr
    assert not (tmp_path / "other.mp4").exists()
