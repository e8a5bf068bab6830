"""Solids are painted in the order in which they are seen, and every robot has its pictures."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.plot.painter import Camera, box, from_the_back
from lutgen.plot.solids import solids_of
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, rigid
from tools import gallery

UP = np.eye(3)


def depth_along(solid, start, look):
    """Return how near to the eye a ray meets a solid, -inf if it does not; by its half spaces."""
    along = solid.normals @ look
    reach = solid.offsets - solid.normals @ start
    with np.errstate(divide="ignore", invalid="ignore"):
        at = reach / along
    if (reach[np.abs(along) < 1e-12] < 0.0).any():
        return -np.inf
    low = at[along < -1e-12].max(initial=-np.inf)
    high = at[along > 1e-12].min(initial=np.inf)
    return float(high) if low < high else -np.inf


def test_of_two_solids_the_nearer_one_is_painted_later():
    rng = np.random.default_rng(8)
    compared = 0
    for _ in range(10):
        # A box cut in two, and one of its parts, and so on: small ones are beside long ones, so
        # that the order of their middles is wrong.
        cells = [(np.full(3, -1.0), np.ones(3))]
        for _ in range(9):
            low, high = cells.pop(rng.integers(len(cells)))
            end, begin, axis = high.copy(), low.copy(), rng.integers(3)
            end[axis] = begin[axis] = rng.uniform(low[axis], high[axis])
            cells += [(low, end), (begin, high)]
        turn = Rotation.random(random_state=rng).as_matrix()
        solids = [box(a, 0.1 * a + 0.9 * b, "#808080", turn, np.zeros(3)) for a, b in cells]
        camera = Camera(rng.uniform(0, 360), rng.uniform(-80, 80), UP)
        order = {id(solid): n for n, solid in enumerate(from_the_back(solids, camera))}
        points = np.concatenate([solid.points for solid in solids])
        for start in rng.uniform(points.min(0), points.max(0), (800, 3)):
            met = [(depth_along(s, start, camera.look), order[id(s)]) for s in solids]
            met = sorted(one for one in met if np.isfinite(one[0]))
            assert [n for _, n in met] == sorted(n for _, n in met)
            compared += len(met) > 1
    assert compared > 60


def test_a_wheel_is_as_wide_as_it_says_and_lies_inwards_of_its_rim():
    wheels = "".join(
        contact(f"w{i}", (x, y, -0.3), 0.1, (0.0, 1.0, 0.0)) + "width = 0.25\n"
        for i, (x, y) in enumerate([(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)])
    )
    solids = solids_of(lutgen.parse_recipe(rigid(wheels)), [])
    assert len(solids) == 5  # and the box between them
    for solid in solids[:4]:
        near, far = np.abs(solid.points[:, 1]).max(), np.abs(solid.points[:, 1]).min()
        assert (near, far) == (pytest.approx(0.4), pytest.approx(0.15))


def test_discs_of_one_belt_are_one_track_and_a_shape_is_a_box():
    belts = "".join(
        contact(f"w{i}", (x, y, -0.3), 0.1, (0.0, 1.0, 0.0)) + f'belt = "{side}"\n'
        for i, (x, y, side) in enumerate(
            [(0.5, 0.4, "left"), (-0.5, 0.4, "left"), (0.5, -0.4, "r"), (-0.5, -0.4, "r")]
        )
    )
    link = '[[robot.link]]\nname = "body"\nmass = 9.0\ncom = [0, 0, 0.2]\nshape = [0.8, 0.4, 0.3]\n'
    solids = solids_of(lutgen.parse_recipe(rigid(f"{link}shape_at = [0.1, 0, 0.3]\n{belts}")), [])
    spans = sorted(np.ptp(solid.points, axis=0).round(6).tolist() for solid in solids)
    assert spans[0] == [0.8, 0.4, 0.3]
    middles = [solid.points.mean(axis=0).round(6).tolist() for solid in solids]
    assert [0.1, 0.0, 0.1] in middles  # the origin is the com
    # From rim to rim: 1 m apart, and two radii of 0.1.
    assert [span[0] for span in spans[1:]] == [pytest.approx(1.2, abs=1e-3)] * 2


@pytest.mark.parametrize("name", [path.stem for path in sorted(MAPS.glob("*.toml"))])
def test_every_robot_of_the_gallery_has_solids_at_its_contacts(name):
    recipe = lutgen.load_recipe(MAPS / f"{name}.toml")
    middle = np.array([(p.minimum + p.maximum) / 2.0 for p in recipe.parameters])
    solids = solids_of(recipe, middle)
    contacts, _ = lutgen.postures(recipe, middle[None])
    points = np.concatenate([solid.points for solid in solids])
    radii = np.array([c.radius for c in recipe.contacts])
    for place, radius in zip(contacts[0], radii, strict=True):
        # A tube ends 0.035 sizes beside the point of a foot, a rim has 48 corners.
        away = np.linalg.norm(points - place, axis=1).min()
        assert away < 1.01 * radius + 0.05 * np.ptp(points)
    assert all(np.isfinite(solid.normals).all() for solid in solids)


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
