"""The gallery's page and pictures are a function of recipe and map, and never drift."""

import importlib.util
import sys

import pytest

from tests.fixtures.places import MAPS, ROOT


@pytest.fixture(scope="module")
def gallery():
    path = ROOT / "tools" / "gallery.py"
    spec = importlib.util.spec_from_file_location("gallery", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["gallery"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["gallery"]


def test_every_recipe_of_the_project_has_its_own_figures_and_a_place_on_the_page(gallery):
    page = (MAPS / "README.md").read_text(encoding="utf-8")
    for path in sorted(MAPS.glob("*.toml")):
        assert path.stem in gallery.SHOTS
        assert f"## {path.stem}\n" in page
        assert f"<!-- gallery {path.stem} -->" in page
        for shot in gallery.SHOTS[path.stem]:
            picture = MAPS / path.stem / f"{shot.name}.png"
            assert picture.stat().st_size < 265_000
            assert f'src="{path.stem}/{shot.name}.png"' in page
