"""Robots of many parameters are exported from their recipe: no product of their axes is built."""

import math
import tracemalloc
from pathlib import Path
from typing import Any

import pytest

import lutgen
from firmware_export import choose
from firmware_export.exporter import Report, export
from firmware_export.truth import sample
from lutgen.errors import ExportError

MIB = 1 << 20


def parameter(name: str, span: float) -> str:
    return f'[[robot.parameter]]\nname = "{name}"\nmin = {-span}\nmax = {span}\nunit = "deg"\n'


def link(name: str, parent: str, origin: str, parameter: str, mass: float) -> str:
    return (
        f'[[robot.link]]\nname = "{name}"\nparent = "{parent}"\norigin = {origin}\n'
        f'joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{parameter}" }}\n'
        f"mass = {mass}\ncom = [0, 0, -0.13]\n"
    )


def walker(knees: tuple[bool, bool], nodes: int) -> str:
    """Return a robot with four legs, of one joint each or, with knees, of two."""
    parameters, links, feet, names = "", "", "", []
    for number, x in enumerate((0.35, -0.35)):
        for side, y in (("left", 0.2), ("right", -0.2)):
            leg = f"{side}_{number}"
            joints = [(f"{leg}_thigh", "body", f"[{x}, {y}, 0.0]", 30.0, 1.5)]
            if knees[number]:
                joints.append((f"{leg}_shin", f"{leg}_thigh", "[0.0, 0.0, -0.3]", 40.0, 0.8))
            for name, parent, origin, span, mass in joints:
                parameters += parameter(name, span)
                links += link(name, parent, origin, name, mass)
                names.append(name)
            foot = joints[-1][0]
            feet += f'[[robot.contact]]\nname = "{leg}"\nlink = "{foot}"\nposition = [0, 0, -0.3]\n'
    samples = ", ".join(f"{name} = {nodes}" for name in names)
    return (
        '[robot]\nname = "walker"\nlength_unit = "m"\nupright = 90.0\nrock_angle = 30.0\n'
        f'{parameters}[[robot.link]]\nname = "body"\nmass = 20.0\ncom = [0, 0, 0.05]\n'
        f"{links}{feet}[sweep]\nsamples = {{ {samples} }}\n[sweep.gravity]\n"
        'chart = "cone"\nmax_tilt = 40.0\nnodes = 33\nchannels = ["sdg", "tip_angle"]\n'
    )


EIGHT = lutgen.parse_recipe(walker((True, True), 61))


def fewer_points(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compare candidates on a fifth of the points: what is chosen is certified anyway.

    In as many postures, so with a fifth of the directions in each: where four feet are nearly on
    one plane, tables may fold them along the other diagonal and |SD_g| is another in the whole
    posture.  One such posture of 75 would be more than the hundredth that p99 leaves out.
    """
    monkeypatch.setattr(choose, "POINTS", 3000)
    monkeypatch.setattr(sample, "MANY", 8)


def certificate(report: Report) -> dict[str, Any]:
    content = report["certificate"]
    assert isinstance(content, dict)
    return content


def test_a_robot_whose_map_would_be_petabytes_is_exported_in_bounded_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recipe = EIGHT
    assert len(recipe.parameters) == 8
    # float32 of two channels: 10 to the 14 bytes and more.
    assert 8 * recipe.grid.size * math.prod(recipe.chart.shape) > 1e14
    fewer_points(monkeypatch)
    report = export(recipe, tmp_path / "out", codec="contacts", points=4000)
    # Again, because the compiler's own memory does not count and takes long to trace.
    tracemalloc.start()
    try:
        export(recipe, tmp_path / "traced", codec="contacts", points=4000)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    # 8 nodes along each of 8 axes would be 128 MiB for a single number per node.
    assert peak < 100 * MIB
    found = certificate(report)
    assert found["false_safe"] == 0
    assert found["channels"]["sdg"]["p99_percent"] <= 1.0
    assert found["false_tip"] < 0.1
    assert report.table_bytes <= 1024


def test_a_grid_of_eight_parameters_is_refused_for_their_number(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match=r"at most 6 parameters \(got 8\)") as caught:
        export(EIGHT, tmp_path / "out", codec="grid", points=1000)
    assert "\n" not in str(caught.value)
    assert "contacts" in str(caught.value)
    assert not (tmp_path / "out").exists()
