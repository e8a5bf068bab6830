"""No command replaces what lutgen did not make, and its own it replaces without a word."""

import shutil
from pathlib import Path

import pytest

import lutgen
from lutgen.errors import InputError
from lutgen.files import is_ours
from lutgen.plot.style import new_figure, save
from tests.fixtures.commands import good, run
from tests.fixtures.places import VECTORS
from tests.fixtures.recipes import tripod

MINE = b"my thesis"
DRIVE = ("path", "r.toml", "--points", "3", "--no-control")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with a recipe, made the working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.toml").write_text(tripod("reach = 2, swing = 2", nodes=3))
    return tmp_path


def held() -> list[str]:
    return sorted(path.name for path in Path().iterdir())


def refused(name: str, *arguments: object) -> None:
    """Run a command that must refuse to replace a file, and leave it as it is."""
    before, names = Path(name).read_bytes(), held()
    result = run(*arguments)
    assert result.exit_code == 2, result.stderr
    assert name in result.stderr
    assert Path(name).read_bytes() == before
    assert held() == names


def test_a_sweep_replaces_maps_and_nothing_else(folder: Path) -> None:
    refused("r.toml", "sweep", "r.toml", "-o", "r.toml")
    Path("thesis.txt").write_bytes(MINE)
    refused("thesis.txt", "sweep", "r.toml", "-o", "thesis.txt")
    for _ in range(2):
        good("sweep", "r.toml", "-o", "a.h5")
    good("sweep", "r.toml", "-o", "thesis.txt", "--force")
    assert is_ours("thesis.txt")
    Path("link.h5").symlink_to("r.toml")
    refused("link.h5", "sweep", "r.toml", "-o", "link.h5", "--force")


def test_an_unfinished_sweep_of_somebody_else_is_neither_cut_nor_followed(folder: Path) -> None:
    Path("a.h5.part").write_bytes(MINE)
    for more in ((), ("--resume",)):
        refused("a.h5.part", "sweep", "r.toml", "-o", "a.h5", *more)
    Path("b.h5.part").symlink_to("r.toml")
    for more in ((), ("--resume",), ("--force",)):
        refused("b.h5.part", "sweep", "r.toml", "-o", "b.h5", *more)
    good("sweep", "r.toml", "-o", "a.h5", "--force")
    assert not Path("a.h5.part").exists()


def test_unfinished_work_is_never_thrown_away_without_a_word(folder: Path) -> None:
    recipe = lutgen.load_recipe("r.toml")

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(recipe, "a.h5", progress=stop)
    refused("a.h5.part", "sweep", "r.toml", "-o", "a.h5")
    with pytest.raises(InputError, match=r"--resume, or begin anew with --force"):
        lutgen.sweep(recipe, "a.h5")
    shutil.copy("a.h5.part", "b.h5.part")
    good("sweep", "r.toml", "-o", "a.h5", "--resume")
    good("sweep", "r.toml", "-o", "b.h5", "--force")
    assert Path("a.h5").read_bytes() == Path("b.h5").read_bytes()


def test_a_figure_replaces_figures_of_lutgen_alone(folder: Path) -> None:
    Path("a.png").write_bytes(MINE)
    ask = ("plot", "r.toml", "--kind", "robot", "-o", "a.png")
    refused("a.png", *ask)
    good(*ask, "--force")
    good(*ask)


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_a_figure_of_any_kind_carries_a_mark_and_is_the_same_twice(
    folder: Path, suffix: str
) -> None:
    for _ in range(2):
        save(new_figure((1.0, 1.0)), f"a.{suffix}")
        assert is_ours(f"a.{suffix}")
    save(new_figure((1.0, 1.0)), f"b.{suffix}")
    assert Path(f"a.{suffix}").read_bytes() == Path(f"b.{suffix}").read_bytes()


def test_a_film_carries_a_mark_and_a_table_of_a_path_has_no_place_for_one(folder: Path) -> None:
    for _ in range(2):
        run(*DRIVE, "-o", "a.csv", "--animate", "a.gif")
    assert is_ours("a.gif")
    assert not is_ours("a.csv")
    refused("a.csv", *DRIVE, "-p", "swing=1", "-o", "a.csv")
    Path("b.gif").write_bytes(MINE)
    refused("b.gif", *DRIVE, "--animate", "b.gif")


def test_an_import_leaves_alone_what_was_edited_by_hand(folder: Path) -> None:
    shutil.copy(VECTORS / "rover.urdf", "robot.urdf")
    ask = ("import", "robot.urdf", "-o", "rover.toml")
    for _ in range(2):
        good(*ask)
    made = Path("rover.toml").read_text(encoding="utf-8")
    Path("rover.toml").write_text(f"{made}# mine\n", encoding="utf-8")
    refused("rover.toml", *ask)
    assert "--merge" in run(*ask).stderr
    good(*ask, "--merge")
    assert Path("rover.toml").read_text(encoding="utf-8").endswith("# mine\n")
    good(*ask, "--force")
    assert Path("rover.toml").read_text(encoding="utf-8") == made


def test_a_report_refuses_a_page_of_somebody_else_before_it_computes(folder: Path) -> None:
    Path("out").mkdir()
    Path("out/paper.html").write_bytes(MINE)
    result = run("paper", "-o", "out")
    assert result.exit_code == 2
    assert [path.name for path in Path("out").iterdir()] == ["paper.html"]
