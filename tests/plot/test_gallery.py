"""The gallery's page and pictures are a function of recipe and map, and never drift."""

import importlib.util
import sys

import pytest

import lutgen
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


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """Return a recipe without an entry in the gallery's table, and its small map."""
    folder = tmp_path_factory.mktemp("swept")
    text = (MAPS / "paper_two.toml").read_text(encoding="utf-8")
    text = text.replace("alpha = 50, gamma = 50", "alpha = 6, gamma = 5")
    text = text.replace('"paper_two"', '"newcomer"').replace("nodes = 33", "nodes = 7")
    recipe = folder / "newcomer.toml"
    recipe.write_text(text, encoding="utf-8")
    lutgen.sweep(lutgen.load_recipe(recipe), folder / "newcomer.h5")
    return recipe, folder / "newcomer.h5"


def test_a_new_recipe_gets_figures_and_a_part_of_the_page(gallery, swept, tmp_path):
    recipe, map_path = swept
    page = tmp_path / "README.md"
    page.write_text("# Mine\n\nWritten by hand.\n", encoding="utf-8")
    assert gallery.main([str(recipe), str(map_path), "--output", str(tmp_path)]) == 0
    pictures = sorted(path.name for path in (tmp_path / "newcomer").iterdir())
    assert pictures == ["contour.png", "polar.png", "robot.png", "sphere.png"]
    assert all((tmp_path / "newcomer" / name).stat().st_size < 265_000 for name in pictures)
    text = page.read_text(encoding="utf-8")
    assert text.startswith("# Mine\n\nWritten by hand.\n\n## newcomer\n")
    assert lutgen.load_recipe(recipe).digest[:12] in text
    assert "6 x 5 x 7 x 7 = 1,470" in text
    assert all(f'src="newcomer/{name}"' in text for name in pictures)


def test_only_the_lines_between_the_markers_change(gallery):
    page = (
        "a\n<!-- gallery x -->\nold\n<!-- end of x -->\nb\n<!-- gallery y -->\n<!-- end of y -->\n"
    )
    assert gallery.with_block(page, "x", "new") == page.replace("old", "new")
    assert gallery.with_block(page, "y", "new").count("new\n<!-- end of y -->") == 1
    grown = gallery.with_block(page, "z", "new")
    assert grown.startswith(page.rstrip())
    assert gallery.with_block(grown, "z", "new") == grown


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
