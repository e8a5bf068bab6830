"""The film of `lutgen path --animate`: frames, size, the same bytes twice, and what is red."""

import math
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray
from PIL import Image

from lutgen.plot import animate
from lutgen.plot.animation import MOST_FRAMES, to_world
from lutgen.plot.ground import HALF, THICK, eye, lay
from lutgen.recipe.recipe import Recipe, load_recipe, parse_recipe
from lutgen.search.driving import Drive, drive
from lutgen.search.terrain import along, paper_path, turned
from tests.fixtures import commands
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid, rover

NOMINAL = [math.atan(0.6)] * 2
# Dots.
SIZE = (640, 450)


@pytest.fixture(scope="module")
def two() -> Recipe:
    """Return the paper's robot."""
    return load_recipe(MAPS / "paper_two.toml")


def by_hand(two: Recipe, points: int, **options: bool) -> Drive:
    path = turned(paper_path(points), math.radians(30.0))
    return drive(two, path, params0=NOMINAL, **options)  # type: ignore[arg-type]


def frames(path: Path) -> list[NDArray[np.uint8]]:
    """Return the pictures of a GIF, (height, width, 3)."""
    with Image.open(path) as film:
        result = []
        for i in range(getattr(film, "n_frames", 1)):
            film.seek(i)
            result.append(np.asarray(film.convert("RGB")))
    return result


run = partial(commands.run, "path")


def test_a_short_path_has_a_frame_for_each_point_and_repeats_to_the_byte(
    two: Recipe, tmp_path: Path
) -> None:
    runs = {"fixed shape": by_hand(two, 7, control=False), "changing shape": by_hand(two, 7)}
    for name in ("a.gif", "b.gif"):
        assert animate(two, runs, tmp_path / name) == 7
    content = (tmp_path / "a.gif").read_bytes()
    assert content == (tmp_path / "b.gif").read_bytes()
    assert content.startswith(b"GIF89a")
    with Image.open(tmp_path / "a.gif") as film:
        assert film.size == SIZE
        # 7.2 s for 7 frames would be slow: half a second each is the longest.
        assert film.info["duration"] == 500
        assert film.info["loop"] == 0
    pictures = frames(tmp_path / "a.gif")
    assert len(pictures) == 7
    assert all((one != other).any() for one, other in pairwise(pictures))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.gif", "b.gif"]


def test_a_long_path_has_no_more_frames_and_stays_small(two: Recipe, tmp_path: Path) -> None:
    film = tmp_path / "long.gif"
    assert animate(two, {"fixed": by_hand(two, 150, control=False)}, film) == MOST_FRAMES
    assert len(frames(film)) == MOST_FRAMES
    assert film.stat().st_size < 2_000_000


def test_ground_is_seen_from_every_side_and_never_as_a_line() -> None:
    rng, to_eye = np.random.default_rng(5), eye(28.0, -40.0)
    slab = Poly3DCollection([])
    edge_on = np.cross(to_eye, [0.0, 0.0, 1.0])
    for normal in (*rng.normal(size=(200, 3)), edge_on, to_eye, -to_eye):
        down = normal / np.linalg.norm(normal)
        along = np.cross(down, rng.normal(size=3))
        along /= np.linalg.norm(along)
        lay(slab, np.stack([down, along, np.cross(down, along), down]), 1.0, rng.random(), to_eye)
        # Of each face the part of its area that the eye sees.
        faces = [np.cross(f[1:-1] - f[0], f[2:] - f[0]).sum(axis=0) / 2.0 for f in slab._faces]
        seen = sum(abs(float(face @ to_eye)) for face in faces)
        assert seen > 0.99 * 2.0 * HALF * THICK
        top = 4.0 * HALF**2 * abs(float(down @ to_eye))
        assert seen >= top - 1e-9


def is_red(picture: NDArray[np.uint8]) -> bool:
    """Tell whether there is red in the line of the titles."""
    r, g, b = picture[:20].astype(int).transpose(2, 0, 1)
    return bool(((r > 150) & (g < 110) & (b < 110)).any())


def test_the_title_is_red_where_the_robot_tips_and_nowhere_else(
    two: Recipe, tmp_path: Path
) -> None:
    fixed = by_hand(two, 24, control=False)
    changing = by_hand(two, 24)
    animate(two, {"fixed shape": fixed, "changing shape": changing}, tmp_path / "film.gif")
    pictures = frames(tmp_path / "film.gif")
    half = SIZE[0] // 2
    for film, drawn in ((slice(None, half), fixed), (slice(half, None), changing)):
        assert [is_red(picture[:, film]) for picture in pictures] == drawn.tips.tolist()
    # Both sides show both, and not the same.
    assert 0 < changing.tips.sum() < fixed.tips.sum() < 24


@pytest.mark.parametrize(
    "gravity",
    [[0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [-0.3, 0.5, -0.81], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]],
)
def test_gravity_points_down_the_page_and_the_nose_to_its_heading(gravity: list[float]) -> None:
    down = np.array(gravity) / np.linalg.norm(gravity)
    turn = to_world(down, 0.7)
    # A few products of unit vectors.
    np.testing.assert_allclose(turn @ down, [0.0, 0.0, -1.0], atol=1e-12)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    nose = turn @ np.array([1.0, 0.0, 0.0])
    if np.linalg.norm(nose[:2]) > 1e-9:
        assert math.atan2(nose[1], nose[0]) == pytest.approx(0.7)


@pytest.mark.parametrize("text", [rover(), rigid(feet([(1, 0, 1), (-1, 1, 1), (-1, -1, 1)]))])
def test_wheels_and_robots_without_support_are_drawn(text: str, tmp_path: Path) -> None:
    robot = parse_recipe(text)
    path = along([[0.0, 0.0, 0.0], [0.0, 1.0, 0.1], [0.0, 1.0, 2.0]])
    still = drive(robot, path, control=False)
    assert animate(robot, {"still": still}, tmp_path / "film.gif") == 3


def test_the_command_writes_the_film_of_the_library(two: Recipe, tmp_path: Path) -> None:
    recipe, film = MAPS / "paper_two.toml", tmp_path / "film.gif"
    angles = [f"{name}={math.degrees(NOMINAL[0])!r}" for name in ("alpha", "gamma")]
    given = ("-p", angles[0], "-p", angles[1], "--turn", 30, "--points", 4)
    result = run(recipe, *given, "--animate", film)
    # With control it still tips over at one of these four points.
    assert result.exit_code == 3, result.stderr
    assert "changing shape" in result.stdout
    runs = {"fixed shape": by_hand(two, 4, control=False), "changing shape": by_hand(two, 4)}
    animate(two, runs, tmp_path / "same.gif")
    assert film.read_bytes() == (tmp_path / "same.gif").read_bytes()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("film.avi", "unknown kind of film (got '.avi')"),
        ("film", "unknown kind of film (got 'no suffix')"),
        ("film.mp4", "an MP4 needs the program ffmpeg"),
        ("missing/film.gif", "cannot be written"),
    ],
)
def test_what_cannot_be_written_is_said_in_one_sentence(
    name: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    result = run(MAPS / "paper_two.toml", "--points", 2, "--animate", name)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith("Error: ")
    assert said in line
    assert list(tmp_path.iterdir()) == []


def test_an_mp4_gets_every_frame_where_there_is_ffmpeg(
    two: Recipe, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # It stands in for ffmpeg: what comes in goes to the file that is named last.
    program = tmp_path / "ffmpeg"
    program.write_text('#!/bin/sh\nfor last; do :; done\nexec /bin/cat > "$last"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    film = tmp_path / "film.mp4"
    assert animate(two, {"fixed": by_hand(two, 3, control=False)}, film) == 3
    # Red, green, blue and opacity.
    assert film.stat().st_size == 3 * SIZE[0] * SIZE[1] * 4
    program.write_text("#!/bin/sh\nexit 1\n")
    result = run(two.source, "--points", 2, "--animate", tmp_path / "other.mp4")
    assert result.exit_code == 2
    assert "ffmpeg made no film" in result.stderr
    assert not (tmp_path / "other.mp4").exists()
