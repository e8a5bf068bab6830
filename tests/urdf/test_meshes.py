"""Meshes: found by their names, read within bounds, and what is recognised in their corners."""

import io
import math
import time
import zipfile

import numpy as np
import pytest

from lutgen.bounds import Bound
from lutgen.errors import InputError
from lutgen.urdf.description import Collision
from lutgen.urdf.feet import foot_of, wheel_of
from lutgen.urdf.meshes import Meshes
from lutgen.urdf.sources import Sources
from lutgen.vector import rotation
from tests.fixtures.meshes import ball, box, capsule, cylinder, dae, stl, write

DOWN = np.array([0.0, 0.0, -1.0])
SIDEWAYS = np.array([0.0, 1.0, 0.0])
HERE = np.zeros(3)


def mesh(file, scale=(1.0, 1.0, 1.0), **place):
    return Collision("mesh", (), file=file, scale=scale, **place)


def corners(folder, shape):
    return Meshes(Sources(folder)).corners(shape)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".dae"])
def test_a_mesh_of_any_format_has_the_corners_of_its_hull(suffix, tmp_path):
    # A corner inside is none of the hull's.
    write(tmp_path / f"a{suffix}", np.vstack([box(0.2, 0.4, 0.6), [[0.01, 0.02, 0.03]]]))
    found = corners(tmp_path, mesh(f"a{suffix}"))
    wanted = [[x, y, z] for x in (-0.1, 0.1) for y in (-0.2, 0.2) for z in (-0.3, 0.3)]
    assert found.tolist() == wanted


def test_scale_turn_and_place_are_those_of_the_shape(tmp_path):
    write(tmp_path / "a.stl", box(200.0, 400.0, 600.0))
    shape = mesh("a.stl", (0.001, 0.001, -0.002), origin=(1.0, 0.0, 0.0), rpy=(0.5 * math.pi, 0, 0))
    found = corners(tmp_path, shape)
    # By hand: z is doubled to 1.2 m, and a quarter turn about x takes y to z and z to -y.
    wanted = [[1 + x, y, z] for x in (-0.1, 0.1) for y in (-0.6, 0.6) for z in (-0.2, 0.2)]
    assert found == pytest.approx(np.array(wanted), abs=1e-6)
    # A file is read once, whatever the scale of a shape is.
    meshes = Meshes(Sources(tmp_path))
    first = meshes.corners(mesh("a.stl"))
    (tmp_path / "a.stl").unlink()
    assert meshes.corners(mesh("a.stl", (2.0, 2.0, 2.0))) == pytest.approx(2.0 * first)


def test_collada_is_in_the_unit_that_it_declares_and_its_axes_stay(tmp_path):
    place = "1 0 0 100  0 1 0 0  0 0 1 0  0 0 0 1"
    (tmp_path / "a.dae").write_bytes(dae(box(0.2, 0.4, 0.6), 0.01, place))
    found = corners(tmp_path, mesh("a.dae"))
    # A node 100 cm away; y is up in the file, and stays y.
    assert found.min(axis=0).tolist() == [0.9, -0.2, -0.3]
    assert found.max(axis=0).tolist() == [1.1, 0.2, 0.3]


def test_a_file_is_found_by_path_by_address_and_by_package(tmp_path):
    package = tmp_path / "legs"
    (package / "meshes").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>legs</name></package>")
    file = write(package / "meshes" / "a b.stl", box(1, 1, 1))
    start = package / "urdf"
    start.mkdir()
    names = ["../meshes/a b.stl", f"file://{file}", "package://legs/meshes/a b.stl"]
    names += [name.replace(" ", "%20") for name in names] + ["..\\meshes\\a b.stl"]
    for name in names:
        assert len(corners(start, mesh(name))) == 8
    with pytest.raises(InputError, match=r"no such file, but 'a b\.stl', which differs in case"):
        corners(start, mesh("package://legs/Meshes/A%20b.STL"))
    elsewhere = Meshes(Sources(tmp_path / "none", {"other": package}))
    assert len(elsewhere.corners(mesh("package://other/meshes/a b.stl"))) == 8


def test_twenty_thousand_materials_are_read_in_seconds_and_corners_of_no_face_are_not(tmp_path):
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in box(1, 1, 1)) + "v 9 9 9\n"
    face = "usemtl m{0}\no p{0}\nf {1} {2} {3}\n"
    faces = "".join(face.format(i, i % 6 + 1, i % 6 + 2, i % 6 + 3) for i in range(20_000))
    (tmp_path / "a.obj").write_text(points + faces)
    begin = time.process_time()
    found = corners(tmp_path, mesh("a.obj"))
    # Measured 0.2 s; with materials the reader takes 100 s.
    assert time.process_time() - begin < 10.0
    assert np.abs(found).max() == 0.5


def packed():
    """Return an archive that does not begin like one."""
    buffer = io.BytesIO(b"<COLLADA>")
    buffer.seek(0, io.SEEK_END)
    with zipfile.ZipFile(buffer, "a") as archive:
        archive.writestr("doc.dae", dae(box(1, 1, 1)))
    return buffer.getvalue()


def nested(leaf):
    """Return a Collada file of nodes that instantiate ten of the next, 30 levels deep."""
    nodes = f'<node id="n0">{leaf}</node>'
    for i in range(1, 30):
        inside = f'<instance_node url="#n{i - 1}"/>' * 10
        nodes += f'<node id="n{i}">{inside}</node>'
    text = dae(box(1, 1, 1)).decode().replace('<instance_geometry url="#g"/>', INNER, 1)
    libraries = f"<library_nodes>{nodes}</library_nodes><library_visual_scenes>"
    return text.replace("<library_visual_scenes>", libraries).encode()


INNER = '<instance_node url="#n29"/>'


# The reader takes it for text then, and finds none, where a package is installed that guesses in
# which encoding it is.
BROKEN = "cannot be read as STL|has no triangle"
HEADER = stl(box(1, 1, 1), claimed=10_000_000)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("none.stl", None, "there is no such file"),
        ("a.mesh", b"", ".mesh is none of .stl, .obj, .dae"),
        ("a", b"", "no ending is none of"),
        ("a.stl", b"", "has no triangle"),
        ("a.stl", HEADER, BROKEN),
        ("a.stl", stl(box(1, 1, 1))[:200], BROKEN),
        ("a.obj", b"nothing\n", "has no triangle"),
        ("a.dae", b"<COLLADA", "cannot be read as DAE"),
        ("a.dae", packed(), "is an archive"),
        ("a.dae", nested('<instance_geometry url="#g"/>'), "instantiates more than 10000 nodes"),
        ("a.dae", nested(""), "instantiates more than 10000 nodes"),
        ("a.dae", b'<!DOCTYPE a [<!ENTITY b "c">]><a/>', "document type declaration"),
        ("a.dae", dae(box(1, 1, 1)).replace(b"<instance_geometry", b"<x"), "has no triangle"),
        ("a.stl", b"\0" * 84, "has no triangle"),
        ("http://a/b.stl", None, "is neither a path nor file:// nor package://"),
        ("package://nowhere/b.stl", None, "give --package nowhere=DIR"),
    ],
)
def test_what_is_no_mesh_is_named_with_its_cause(name, content, said, tmp_path):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=rf"\A.*({said}).*\Z"):
        corners(tmp_path, mesh(name))


def test_a_scale_that_is_none_a_folder_and_a_file_that_is_too_long_are_refused(
    tmp_path, monkeypatch
):
    write(tmp_path / "a.stl", box(1, 1, 1))
    for scale in ((), (1.0, 1.0), (1.0, 0.0, 1.0), (1.0, math.nan, 1.0)):
        with pytest.raises(InputError, match="has no scale"):
            corners(tmp_path, mesh("a.stl", scale))
    (tmp_path / "b.stl").mkdir()
    with pytest.raises(InputError, match="there is no such file"):
        corners(tmp_path, mesh("b.stl"))
    size = (tmp_path / "a.stl").stat().st_size
    monkeypatch.setattr("lutgen.bounds.MESH_BYTES", Bound(size, "bytes"))
    assert len(corners(tmp_path, mesh("a.stl"))) == 8
    monkeypatch.setattr("lutgen.bounds.MESH_BYTES", Bound(size - 1, "bytes"))
    with pytest.raises(InputError, match=f"is too long .got more than {size - 1} bytes"):
        corners(tmp_path, mesh("a.stl"))


@pytest.mark.parametrize("sides", [12, 16, 33, 100])
def test_a_cylinder_anywhere_about_any_axle_is_a_wheel_of_its_radius_and_width(sides):
    turn, origin = rotation((0.3, -0.7, 1.1)), np.array([0.5, -0.2, 0.1])
    axle = turn @ SIDEWAYS
    # The joint may be beside the middle of the wheel.
    found = wheel_of(cylinder(0.1, 0.04, sides) @ turn.T + origin, origin + 0.3 * axle, axle)
    assert found.kind == "cylinder"
    assert found.origin == pytest.approx(tuple(origin), abs=1e-6)
    assert found.size == pytest.approx((0.1, 0.04), abs=1e-6)
    # Its z is along the axle.
    assert np.abs(rotation(found.rpy)[:, 2] @ axle) == pytest.approx(1.0)
    # The only error is the facets' sagitta, printed in mm with two digits, seen from directions
    # that are 0.25 deg apart.
    said = float(found.note.split("off by at most ")[1].split()[0])
    half = math.pi / sides
    missed = 100.0 * math.sin(half) * math.radians(0.125)
    assert said == pytest.approx(100.0 * (1.0 - math.cos(half)), abs=0.006 + missed)


@pytest.mark.parametrize(
    "body",
    [
        box(0.2, 0.04, 0.2),
        cylinder(0.1, 0.04, 6),
        cylinder(0.1, 0.04) * [1.0, 1.0, 1.1],
        cylinder(0.1, 0.04) + np.array([0.01, 0.0, 0.0]),
        cylinder(0.01, 0.1),
    ],
)
def test_what_is_not_round_about_its_axle_is_no_wheel(body):
    assert wheel_of(body, HERE, SIDEWAYS) is None


@pytest.mark.parametrize("body", [ball(0.02), capsule(0.02, 0.3)])
def test_a_ball_and_the_end_of_a_capsule_are_a_sphere(body):
    low = body[:, 2].min()
    found = foot_of(body, DOWN)
    assert found.kind == "sphere"
    # 24 sides and 12 rings: a sagitta of 0.9 % of the radius.
    assert found.size[0] == pytest.approx(0.02, rel=0.02)
    assert found.origin == pytest.approx((0.0, 0.0, low + 0.02), abs=4e-4)
    assert found.size[0] - found.origin[2] == pytest.approx(-low, abs=2e-4)


def test_an_oval_sole_loses_at_most_what_is_said_and_lies_inside():
    turn = np.linspace(0.0, 2.0 * math.pi, 60, endpoint=False)
    rim = np.stack([0.12 * np.cos(turn), 0.05 * np.sin(turn), 0.0 * turn], axis=1)
    body = np.vstack([rim, 0.8 * rim + np.array([0.0, 0.0, 0.06])])
    found = foot_of(body, DOWN)
    chosen = np.array(found.size).reshape(-1, 3)
    assert 4 <= len(chosen) <= 8
    assert {tuple(point) for point in chosen} <= {tuple(point) for point in np.round(body, 6) + 0.0}
    said = float(found.note.split("at most ")[1].split()[0])
    angles = np.linspace(0.0, 2.0 * math.pi, 1000)
    ways = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
    lost = (rim @ ways.T).max(axis=0) - (chosen @ ways.T).max(axis=0)
    assert 1000.0 * lost.max() == pytest.approx(said, abs=0.02)
    assert lost.min() >= -1e-6
    assert said < 10.0


def test_what_is_neither_ball_nor_sole_is_its_lowest_corners():
    # A wedge that stands on its edge, and a pyramid on its tip.
    wedge = np.array(
        [[x, y, z] for x in (-0.1, 0.1) for y, z in ((0, -0.1), (0.05, 0), (-0.05, 0))]
    )
    found = foot_of(wedge, DOWN)
    assert found.kind == "points"
    lower = np.array(found.size).reshape(-1, 3)
    assert {(-0.1, 0.0, -0.1), (0.1, 0.0, -0.1)} <= {tuple(point) for point in lower.tolist()}
    tip = foot_of(
        np.vstack([box(0.01, 0.01, 0.0)[::2] + np.array([0, 0, 0.1]), [[0.0, 0.0, 0.0]]]), DOWN
    )
    assert (tip.kind, tip.size) == ("points", (0.0, 0.0, 0.0))
