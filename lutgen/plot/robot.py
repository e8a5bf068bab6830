"""Robot: what it stands on, and over which edge it goes first."""

import math

from matplotlib.figure import Figure

from lutgen.analysis import Diagnosis
from lutgen.plot.labels import angle, counted, gravity_text, named
from lutgen.plot.scene import Label, callouts, draw_scene
from lutgen.plot.style import bare, colours, new_figure
from lutgen.plot.view import View
from lutgen.quantities import QUANTITIES

# Inches: the width of the picture between the labels, its greatest height, and the room below it.
WIDE, TALLEST, BELOW = 4.3, 4.6, 0.25


def draw_robot(view: View) -> Figure:
    """Return the figure."""
    down = view.in_bodies(view.params[None], view.gravity_dir[None])[0, 0]
    # Its height follows from the robot, so the robot is drawn once beforehand.
    probe = draw_scene(bare(new_figure((1.0, 1.0)).add_subplot()), view.recipe, view.params, down)
    across, up = probe.high - probe.low
    tall = min(WIDE * up / across, TALLEST)
    box = ((8.0 - WIDE) / 2.0, BELOW, WIDE, tall)
    note = named(view.recipe, view.params, (), gravity_text(view.gravity_dir, view.convention))
    figure, axes = view.page(tall + BELOW, box, _verdict(probe.state), note)
    scene = draw_scene(bare(axes), view.recipe, view.params, down)
    state, look = scene.state, colours()
    labels: list[Label] = [("centre of mass", scene.com, look.ink)]
    if scene.support is not None:
        words = "stands on" if state.standing else "would stand on"
        labels.append((f"{words}\n{_carrying(state)}", scene.support, look.blue))
    if scene.red is not None:
        tip = math.degrees(state.channels["tip_angle"])
        words = f"tips over this\nedge first,\nafter {angle(tip)}"
        labels.append((words if tip >= 0.0 else "tips over\nthis edge", scene.red, look.red))
    labels.append(("gravity", 0.3 * scene.com + 0.7 * scene.hit, look.ink))
    if scene.force is not None:
        labels.append(("force", scene.force, look.red))
    callouts(axes, labels, scene)
    return figure


def _verdict(state: Diagnosis) -> str:
    tip = math.degrees(state.channels["tip_angle"])
    if abs(tip) > 179.99:
        return "It never tips over" if state.standing else "It has nothing to stand on"
    if not state.standing:
        return f"Tips over: it leans {angle(math.ceil(-tip))} too far"
    rocks = QUANTITIES["status"].word(state.channels["status"]) == "rocks"
    words = "Rocks between its contacts" if rocks else f"Stands on {_carrying(state)}"
    return f"{words}, {angle(tip)} from tipping over"


def _carrying(state: Diagnosis) -> str:
    corners = dict.fromkeys(state.facet.contacts if state.facet is not None else ())
    return counted([state.posture.recipe.contacts[i].kind for i in corners])
