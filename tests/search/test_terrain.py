"""Paths: attitudes known by hand, the paper's slopes, and files that are refused with a line."""

import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lutgen.errors import InputError
from lutgen.search.terrain import along, paper_path, read_path, turned

SLOPE = math.radians(25.0)
SIN, COS = math.sin(SLOPE), math.cos(SLOPE)
# The ground z = x tan(25 deg), and gravity on it for a robot that looks up, left, down and right.
UPHILL = (-SIN, 0.0, COS)
BY_HEADING = {0: (-SIN, 0, -COS), 90: (0, SIN, -COS), 180: (SIN, 0, -COS), 270: (0, -SIN, -COS)}


def on_slope(xy):
    return np.column_stack([xy, xy[:, 0] * math.tan(SLOPE)])


def test_the_papers_path_has_its_equations_and_no_gap_at_zero():
    path = paper_path(5, span=(-2.0, 2.0))
    s = np.array([-2.0, -1.0, 1.0, 2.0])
    others = path.position[[0, 1, 3, 4]]
    np.testing.assert_allclose(others[:, 0], s)
    np.testing.assert_allclose(others[:, 1], 0.8 * np.sin(s) / s)
    np.testing.assert_allclose(others[:, 2], 15.0 * np.sin(s) ** 2 / s)
    np.testing.assert_allclose(path.position[2], [0.0, 0.8, 0.0], atol=1e-15)
    # dz/dx by the power rule; 15 at 0.
    climb = 15.0 * (np.sin(2.0 * s) / s - (np.sin(s) / s) ** 2)
    gravity = path.gravity[[0, 1, 3, 4]]
    np.testing.assert_allclose(gravity[:, 0] / gravity[:, 2], climb)
    assert (path.gravity[:, 1] == 0.0).all()
    np.testing.assert_allclose(path.gravity[2, 0] / path.gravity[2, 2], 15.0)


@pytest.mark.parametrize("heading", BY_HEADING)
def test_on_a_slope_gravity_is_as_the_heading_says(heading):
    yaw, expected = np.full(3, math.radians(heading)), np.tile(BY_HEADING[heading], (3, 1))
    crooked = on_slope(np.array([[0.0, 0.0], [1.0, 2.0], [0.5, 3.0]]))
    path = along(crooked, yaw, np.tile(np.multiply(UPHILL, 7.0), (3, 1)))
    np.testing.assert_allclose(path.gravity, expected, atol=1e-15)
    assert (path.heading == yaw).all()
    # Straight up the fall line, unevenly spaced: the plane is known from the path alone.
    straight = on_slope(np.array([[0.0, 4.0], [0.1, 4.0], [2.0, 4.0]]))
    np.testing.assert_allclose(along(straight, yaw).gravity, expected, atol=1e-14)
    # Without a heading the robot looks along the path, and has that slope under its nose.
    way = np.array([math.cos(yaw[0] + 0.6), math.sin(yaw[0] + 0.6)])
    path = along(on_slope(np.outer([0.0, 1.0, 3.0], way)))
    np.testing.assert_allclose(np.exp(1j * path.heading), complex(*way), atol=1e-14)
    climb = math.tan(SLOPE) * way[0]
    ahead = np.array([-climb, 0.0, -1.0]) / math.hypot(climb, 1.0)
    np.testing.assert_allclose(path.gravity, np.tile(ahead, (3, 1)), atol=1e-14)
    assert path.distance == pytest.approx(np.array([0.0, 1.0, 3.0]) * math.hypot(climb, 1.0))


def test_a_circle_has_its_own_tangents_although_the_points_are_uneven():
    # Neighbouring steps of 1 to 5: the direction between both neighbours would be 2.3 deg off.
    angle = np.cumsum([0.0, *(0.02, 0.1) * 7])
    path = along(np.column_stack([np.sin(angle), 0.0 * angle, 1.0 - np.cos(angle)]))
    pitch = np.arctan2(-path.gravity[:, 0], -path.gravity[:, 2])
    np.testing.assert_allclose(pitch[1:-1], angle[1:-1], atol=1e-13)
    # At the ends the chord: half a step aside.
    np.testing.assert_allclose(pitch[[0, -1]], [0.01, angle[-1] - 0.05], atol=1e-13)


def test_a_wall_is_as_steep_as_a_wall_and_the_heading_before_it_holds():
    up = [[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 1, 2], [0, 1, 3], [0, 2, 3]]
    path = along(up)
    np.testing.assert_allclose(path.heading, np.pi / 2)
    np.testing.assert_allclose(path.gravity[3], [-1.0, 0.0, 0.0], atol=1e-15)
    down = along(np.array(up)[::-1])
    np.testing.assert_allclose(down.heading, -np.pi / 2)
    np.testing.assert_allclose(down.gravity[2], [1.0, 0.0, 0.0], atol=1e-15)
    # A path that begins on the wall, and one that is nothing else.
    np.testing.assert_allclose(along(up[2:]).gravity[0], [-1.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(along([[0, 0, 0], [0, 0, 1]]).gravity, [[-1, 0, 0]] * 2, atol=1e-15)
    # Along a wall the robot lies on its side.
    side = along([[0, 0, 0], [0, 1, 0]], normal=[[-1, 0, 0]] * 2)
    np.testing.assert_allclose(side.gravity, [[0, 1, 0]] * 2, atol=1e-15)


@given(
    slope=st.floats(0.0, 1.5),
    fall=st.floats(-3.0, 3.0),
    heading=st.floats(-3.0, 3.0),
    turn=st.floats(-3.0, 3.0),
)
def test_a_turned_robot_has_the_gravity_of_its_new_heading(slope, fall, heading, turn):
    up = np.array(
        [math.sin(slope) * math.cos(fall), math.sin(slope) * math.sin(fall), math.cos(slope)]
    )
    points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    path = along(points, [heading] * 2, [up] * 2)
    there = turned(path, turn)
    again = along(points, there.heading, [up] * 2)
    # On ground of 86 deg a yaw is known to 1e-16 / cos(86 deg).
    np.testing.assert_allclose(there.gravity, again.gravity, atol=1e-12)
    # The turn is about the normal: gravity turns by it the other way, seen from above.
    before, after = (complex(*p.gravity[0, :2]) for p in (path, there))
    assert abs(after - before * np.exp(-1j * turn)) < 1e-14
    np.testing.assert_allclose(turned(there, -turn).gravity, path.gravity, atol=1e-14)


TWO = [[0, 0, 0], [1, 0, 0]]


def test_what_is_no_path_is_refused():
    for arguments, said in (
        ({"position": [*TWO, [0, 0, 0]]}, "turns back on itself at point 1"),
        ({"position": TWO, "normal": [[0, 0, 1], [0, 0, -1]]}, "normal at point 1 points down"),
        ({"position": TWO, "normal": [[0, 0, 1], [0, 0, 0]]}, "longer than 0"),
    ):
        with pytest.raises(InputError, match=said):
            along(**arguments)


def written(folder, text):
    file = folder / "path.csv"
    file.write_bytes(text.encode())
    return read_path(file)


def test_columns_come_in_any_order_and_headings_in_degrees(tmp_path):
    # A byte order mark, spaces, and line ends of another system.
    path = written(
        tmp_path, "\ufeffnz, nx,ny,heading,z,y,x\r\n1,0,0,90,3,2,1\r\n1,1,0,-90,3,2,2\r\n"
    )
    np.testing.assert_allclose(path.position, [[1, 2, 3], [2, 2, 3]])
    np.testing.assert_allclose(path.heading, [np.pi / 2, -np.pi / 2])
    np.testing.assert_allclose(path.gravity[1], [0, 0.5**0.5, -(0.5**0.5)], atol=1e-15)


def test_a_faulty_file_is_refused_with_its_place(tmp_path):
    for text, said in (
        ("", "line 1 names no column x (got nothing)"),
        ("x,y,z,yaw\n0,0,0,0\n", "the unknown column 'yaw'"),
        ("x,y,z,x\n0,0,0,0\n", "line 1 names a column twice"),
        ("x,y,z,nx\n0,0,0,0\n", "line 1 names no column ny (got x,y,z,nx)"),
        ("x,y,z\n0,0,0\n", "at least 2 points (got 1)"),
        ("x,y,z\n0,0,0\n1,0\n", "line 3: must have 3 cells"),
        ("x,y,z\n0,0,0\n\n1,0,up\n", "line 4, column z: is no finite number (got 'up')"),
        ("x,y,z\n0,0,0\n1,1e999,0\n", "line 3, column y: is no finite number (got '1e999')"),
        ("x,y,z\n0,0,0\n\n1,0,0\n1,0,0\n", "line 5 repeats the point before it"),
        ("x,y,z\n0,0,0\n1,0,\x00\n", "line 3"),
    ):
        with pytest.raises(InputError, match=rf"{tmp_path}/path.csv.*{re.escape(said)}"):
            written(tmp_path, text)
    (tmp_path / "utf16.csv").write_bytes("x,y,z\n".encode("utf-16"))
    with pytest.raises(InputError, match="line 1 is not UTF-8"):
        read_path(tmp_path / "utf16.csv")
    with pytest.raises(InputError, match="there is no such file"):
        read_path(tmp_path / "none.csv")
