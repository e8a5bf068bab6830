"""The node of ROS 2, compiled and run with a stub of rclcpp in the place of ROS."""

from dataclasses import replace

import numpy as np
import pytest

from firmware_export.emit import package
from firmware_export.protocol import Joint, Policy
from tests.fixtures.compiled import compile_c, run
from tests.fixtures.exports import tripod_export
from tests.fixtures.places import ROOT

STUB = ROOT / "tests/fixtures/rclcpp_stub.hpp"
HEADERS = (
    *("rclcpp/rclcpp", "sensor_msgs/msg/imu", "sensor_msgs/msg/joint_state"),
    *("std_msgs/msg/float64_multi_array", "std_msgs/msg/u_int8"),
    *("diagnostic_msgs/msg/diagnostic_array", "visualization_msgs/msg/marker"),
)
JOINTS = (Joint(0.0, 0.002, 0.01, 1.0, 1e-4, 1.0, 0.1, 0.1),) * 2
POLICY = Policy(
    *(np.full((2, 2, 2), 100, np.uint8), 1.0, JOINTS, 0.02, 0.06, 0.05, (0.3, 0.2, 0.1), 0.5)
)


@pytest.mark.needs("c++")
@pytest.mark.parametrize("policy", [None, POLICY], ids=["read", "policy"])
def test_the_node_tells_how_the_robot_stands_and_steers_it_with_a_policy(tmp_path, policy):
    export = replace(tripod_export("feet"), policy=policy)
    package.write(export, tmp_path / "feet")
    for name in HEADERS:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / f"{name}.hpp").write_text(f'#include "{STUB}"\n')
    compile_c(["-Ifeet", "-c", "feet/feet.c", "-o", "map.o"], tmp_path)
    words = "-std=c++17 -Wall -Wextra -Werror -Ifeet -I. feet/examples/ros2_node.cpp map.o -o node"
    run(tmp_path, "c++", *words.split())
    said = run(tmp_path, "./node").splitlines()
    assert said[0] == "node feet_stability"
    assert [line for line in said if line.startswith("level")] == [
        "level 3: no samples of the IMU or the joints",
        "level 0: stands",
        "level 2: unknown: the map holds no such direction",
    ]
    params = np.array([[0.3, 0.1]])
    exact = export.model.exact(params, np.array([[[0.0, 0.0, -1.0]]]))
    angles = [float(line.split()[1]) for line in said if line.startswith("tip_angle_deg")]
    assert angles[0] == pytest.approx(np.degrees(exact.tip_angle[0, 0]), abs=0.01)
    assert angles[1] < 0.0
    assert [line for line in said if line.startswith("marker")] == [
        *("marker  1 0", "marker base_link 0 1", "marker base_link 1 0")
    ]
    # One cycle on level ground, no faster than a joint may go.
    commands = [float(line.split()[1]) for line in said if line.startswith("command")]
    assert len(commands) == (4 if policy else 0)
    if policy:
        assert np.abs(np.array(commands) - [*params[0], *params[0]]).max() <= 0.0201
        assert np.abs(np.array(commands[:2]) - params[0]).max() > 0.005
    assert any(line.startswith("fatal") for line in said) is False
