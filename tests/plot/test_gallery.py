"""Every recipe of the gallery has figures of its own and a place on the gallery's page."""

from tests.fixtures.places import MAPS
from tools import gallery


def test_every_recipe_of_the_project_has_its_own_figures_and_a_place_on_the_page():
    page = (MAPS / "README.md").read_text(encoding="utf-8")
    for path in sorted(MAPS.glob("*.toml")):
        assert path.stem in gallery.SHOTS
        assert f"## {path.stem}\n" in page
        assert f"<!-- gallery {path.stem} -->" in page
        for shot in gallery.SHOTS[path.stem]:
            picture = MAPS / path.stem / f"{shot.name}.png"
            assert picture.stat().st_size < 265_000
            assert f'src="{path.stem}/{shot.name}.png"' in page
