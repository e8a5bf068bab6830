"""The drawings of the explanations: each file is its script's, and what it shows is so."""

import math
from xml.etree import ElementTree

import numpy as np
import pytest

import lutgen
from tests.fixtures.places import ROOT
from tools import flow_drawing, frames_drawing

DRAWINGS = {**frames_drawing.DRAWINGS, **flow_drawing.DRAWINGS}


@pytest.mark.parametrize("name", DRAWINGS)
def test_each_file_is_what_its_script_draws_and_is_named_for_readers(name: str) -> None:
    text = (ROOT / "docs/explanation" / name).read_text(encoding="utf-8")
    assert text == DRAWINGS[name]()
    title = ElementTree.fromstring(text).find("{http://www.w3.org/2000/svg}title")
    assert title is not None
    assert title.text


def test_the_outline_on_the_chart_is_where_that_robot_tips() -> None:
    feet = np.array([[(x, y, -frames_drawing.DROP) for x, y in frames_drawing.FEET]])
    corners = frames_drawing.outline()
    sides = [
        (0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]))
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)
    ]
    down = [(share * u, share * v, -1.0) for u, v in sides for share in (0.999, 1.001)]
    found = lutgen.stability(feet, down)["tip_angle"][0]
    assert (found[::2] > 0.0).all()
    assert (found[1::2] < 0.0).all()
    assert math.hypot(*corners[0]) < math.tan(frames_drawing.MAX_TILT)
