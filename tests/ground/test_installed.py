"""The wheel, installed where no checkout is; what it depends on, and its licence."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
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
def python(tmp_path_factory):
    """Return the Python of an environment in which the built wheel is installed."""
    source = tmp_path_factory.mktemp("source")
    for name in PARTS:
        place = ROOT / name
        if place.is_dir():
            shutil.copytree(place, source / name, ignore=LEFT)
        else:
            shutil.copy(place, source / name)
    # How fast the C is nobody asks here.
    text = (source / "setup.py").read_text()
    (source / "setup.py").write_text(text.replace("-O2", "-O0"))
    (source / "maps").mkdir()
    for recipe in MAPS.glob("*.toml"):
        shutil.copy(recipe, source / "maps")
    subprocess.run([sys.executable, "-c", BUILD], cwd=source, capture_output=True, check=True)
    (wheel,) = (source / "dist").glob("*.whl")
    place = tmp_path_factory.mktemp("environment")
    venv.create(place, symlinks=True)
    (site,) = place.glob("lib/python*/site-packages")
    zipfile.ZipFile(wheel).extractall(site)
    # What lutgen needs is taken from here; links to a checkout are not followed from there.
    others = [path for path in sys.path if path.endswith("-packages") and Path(path).is_dir()]
    (site / "needed.pth").write_text("\n".join(others))
    return place / "bin" / "python"


def run(python, folder, *arguments):
    """Run Python in a folder, without any path of ours, and return what it printed."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    done = subprocess.run(
        [python, *arguments], cwd=folder, env=kept, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return done.stdout


# Prints the digest of each recipe of the gallery, as the package finds it.
DIGESTS = """
import lutgen
from lutgen.recipe import gallery_names
for name in gallery_names():
    print(name, lutgen.load_recipe(f"recipe:{name}").digest)
"""


def test_the_wheel_brings_every_recipe_of_the_gallery_as_it_is_in_the_checkout(python, tmp_path):
    found = dict(line.split() for line in run(python, tmp_path, "-c", DIGESTS).splitlines())
    recipes = sorted(MAPS.glob("*.toml"))
    assert found == {path.stem: lutgen.load_recipe(path).digest for path in recipes}
    said = run(python, tmp_path, "-m", "lutgen", "recipes")
    assert re.findall(r"^recipe:(\w+)", said, re.MULTILINE) == list(found)
    (site,) = python.parents[1].glob("lib/python*/site-packages")
    for package in ("lutgen", "firmware_export"):
        assert (site / package / "py.typed").is_file()


def test_type_checkers_find_an_editable_install_as_a_folder_on_the_path():
    # mypy follows no import hook.
    assert not [one for one in sys.meta_path if "editable" in repr(one).lower()]


def test_every_dependency_has_a_lower_and_an_upper_bound():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    extras = settings["project"]["optional-dependencies"].values()
    needs = [*settings["project"]["dependencies"], *(need for extra in extras for need in extra)]
    needs += settings["build-system"]["requires"]
    assert len(needs) > 20
    wrong = [need for need in needs if not re.fullmatch(r"[a-z0-9-]+>=[0-9.]+,<[0-9.]+", need)]
    assert wrong == []


def test_every_file_of_c_says_its_licence():
    rooms = [ROOT / room for room in ("benchmarks", "firmware_export", "proofs", "targets")]
    sources = [
        path for room in rooms for end in ("[chS]", "mjs") for path in room.rglob(f"*.{end}")
    ]
    assert len(sources) > 20
    lines = ["SPDX-License-Identifier: MIT", "Copyright (c) The lutgen authors"]
    for path in sources:
        head = path.read_text(encoding="utf-8").splitlines()[:2]
        assert [line.strip("/*# ") for line in head] == lines, path
