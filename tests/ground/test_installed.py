"""The wheel, installed where no checkout is: what it brings, and what a type checker sees of it."""

import os
import re
import shutil
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

import lutgen
from tests.fixtures.places import MAPS, ROOT

BUILD = "import setuptools.build_meta as b; b.build_wheel('dist')"
# What the build reads; the recipes without their pictures.
PARTS = ("pyproject.toml", "setup.py", "README.md", "LICENSE", "lutgen", "firmware_export")
LEFT = shutil.ignore_patterns("__pycache__", "*.so", "*.nb?")


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the Python of an environment in which the built wheel is installed."""
    source = tmp_path_factory.mktemp("source")
    for name in PARTS:
        place = ROOT / name
        if place.is_dir():
            shutil.copytree(place, source / name, ignore=LEFT)
        else:
            shutil.copy(place, source / name)
    (source / "maps").mkdir()
    for recipe in MAPS.glob("*.toml"):
        shutil.copy(recipe, source / "maps")
    subprocess.run([sys.executable, "-c", BUILD], cwd=source, capture_output=True, check=True)
    (wheel,) = (source / "dist").glob("*-py3-none-*.whl")
    place = tmp_path_factory.mktemp("environment")
    venv.create(place, symlinks=True)
    (site,) = place.glob("lib/python*/site-packages")
    zipfile.ZipFile(wheel).extractall(site)
    # What lutgen needs is taken from here; links to a checkout are not followed from there.
    others = [path for path in sys.path if path.endswith("-packages") and Path(path).is_dir()]
    (site / "needed.pth").write_text("\n".join(others))
    return place / "bin" / "python"


def run(python: Path, folder: Path, *arguments: str) -> str:
    """Run Python in a folder, without any path of ours, and return what it printed."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    done = subprocess.run(
        [python, *arguments], cwd=folder, env=kept, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return done.stdout


def test_the_wheel_runs_as_a_module_without_the_checkout(python: Path, tmp_path: Path) -> None:
    where = run(python, tmp_path, "-c", "import lutgen; print(lutgen.__file__)").strip()
    assert Path(where).is_relative_to(python.parents[1])
    said = run(python, tmp_path, "-m", "lutgen", "--version")
    assert said == f"lutgen, version {lutgen.__version__}\n"


# Prints the digest of each recipe of the gallery, as the package finds it.
DIGESTS = """
import lutgen
from lutgen.recipe import gallery_names
for name in gallery_names():
    print(name, lutgen.load_recipe(f"recipe:{name}").digest)
"""


def test_the_wheel_brings_every_recipe_of_the_gallery_as_it_is_in_the_checkout(
    python: Path, tmp_path: Path
) -> None:
    found = dict(line.split() for line in run(python, tmp_path, "-c", DIGESTS).splitlines())
    recipes = sorted(MAPS.glob("*.toml"))
    assert found == {path.stem: lutgen.load_recipe(path).digest for path in recipes}
    said = run(python, tmp_path, "-m", "lutgen", "recipes")
    assert re.findall(r"^recipe:(\w+)", said, re.MULTILINE) == list(found)


def test_the_wheel_says_that_it_is_typed_and_holds_no_pictures_of_the_gallery(
    python: Path,
) -> None:
    (site,) = python.parents[1].glob("lib/python*/site-packages")
    for package in ("lutgen", "firmware_export"):
        assert (site / package / "py.typed").is_file()
    assert {path.suffix for path in (site / "lutgen" / "gallery").iterdir()} == {".toml"}


# A user's program: every public function, and the type of what it gives.
RIGHT = """
from typing import Any, assert_type

import numpy as np
from numpy.typing import NDArray

import lutgen
from firmware_export import export

Values = dict[str, NDArray[np.float64]]
feet = np.array([[0.3, 0.2, -0.2], [-0.3, 0.2, -0.2], [0.0, -0.2, -0.2]])
assert_type(lutgen.stability(feet, [[0, 0, -1]]), Values)
assert_type(lutgen.__version__, str)
try:
    recipe = lutgen.load_recipe("recipe:paper_two", allow_python=False)
    recipe = lutgen.parse_recipe(recipe.text)
except lutgen.RecipeError as error:
    raise SystemExit(str(error)) from error
assert_type(recipe.contact_names, tuple[str, ...])
assert_type(recipe.digest, str)
assert_type(lutgen.evaluate(recipe, [[0.5, 0.5]], [[0, 0, -1]]), Values)
contacts, com = lutgen.postures(recipe, [[0.5, 0.5]])
assert_type(contacts, NDArray[np.float64])
best = lutgen.optimum(recipe, [0, 0, -1], method="search")
assert_type(best.params, NDArray[np.float64])
assert_type(best.standing, bool)
assert_type(lutgen.sweep(recipe, "map.h5", threads=2), None)
stability_map = lutgen.load_map("map.h5")
assert_type(stability_map.read([[0.5, 0.5]], [[0, 0, -1]]), Values)
assert_type(stability_map.channels, tuple[str, ...])
report: dict[str, Any] = export(stability_map, "firmware", flash="16KiB")
report.keys()
"""
# Each line but the first is a mistake.
WRONG = """import firmware_export, lutgen
lutgen.load_recipe(3)
lutgen.load_recip("robot.toml")
lutgen.sweep("robot.toml", "map.h5")
lutgen.optimum(lutgen.load_recipe("robot.toml"), [0, 0, -1], levels="six")
lutgen.load_map("map.h5").chan("sdg")
lutgen.stability([[0, 0, 1]], [[0, 0, -1]])["sdg"].no_such_method()
firmware_export.export("map.h5", "firmware").no_such_method()
"""


def test_a_program_against_the_wheel_is_checked_strictly_and_its_mistakes_are_found(
    python: Path, tmp_path: Path
) -> None:
    (tmp_path / "right.py").write_text(RIGHT)
    (tmp_path / "wrong.py").write_text(WRONG)
    # Of the wheel, not of a checkout: no path of ours, and none of the project's settings.
    asked = ("-m", "mypy", "--strict", "--config-file=", f"--python-executable={python}")
    done = subprocess.run(
        [sys.executable, *asked, "--cache-dir=cache", "right.py", "wrong.py"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    found = re.findall(r"^(\w+)\.py:(\d+): error", done.stdout, re.MULTILINE)
    lines = [("wrong", str(line)) for line in range(2, len(WRONG.splitlines()) + 1)]
    assert sorted(set(found)) == lines, done.stdout
