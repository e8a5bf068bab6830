"""Rules about several keys of a recipe, and about names, each a generator of faults."""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

import numpy as np
from pydantic import BaseModel

from lutgen import bounds
from lutgen.errors import suggestion
from lutgen.quantities import CHANNELS, UNLOADED
from lutgen.recipe.load import NOTHING, Fault, example
from lutgen.recipe.robot import knots_of
from lutgen.recipe.schema import ANGLE_UNITS, File, Gravity, Parameter, Robot, Sweep

# Names of a map file's other dimensions and variables, which no parameter may take.
RESERVED = ("face", "v", "u", *CHANNELS)


def given(table: BaseModel, key: str, names: Iterable[str], what: str, way: str) -> Iterator[Fault]:
    """Yield a fault for each of these keys that a table has."""
    for name in names:
        if name in table.model_fields_set:
            got = table.model_dump(include={name}, exclude_unset=True)[name]
            yield Fault(f"{key}.{name}", what, got, way)


def absent(table: BaseModel, key: str, *names: str) -> Iterator[Fault]:
    """Yield a fault for each of these keys that a table does not have."""
    for name in names:
        if getattr(table, name) is None:
            way_out = example(name, type(table).model_fields[name])
            yield Fault(f"{key}.{name}", "is missing", NOTHING, way_out)


def known_name(key: str, name: str | None, known: Collection[str], noun: str) -> Iterator[Fault]:
    """Yield a fault for a name that is there, but none of those that are known."""
    if name is not None and name not in known:
        what, way_out = f"is not a {noun} of the robot", suggestion(name, known, "use one of")
        yield Fault(key, what, name, way_out)


def twice(key: str, names: Iterable[Sequence[str]], taken: Iterable[str] = ()) -> Iterator[Fault]:
    """Yield a fault for each entry of an array that has a name which was given before."""
    there = set(taken)
    for place, some in enumerate(names, 1):
        again = [name for name in some if name in there]
        if again:
            yield Fault(f"{key}[{place}].name", "is given twice", again[0], "choose another name")
        there.update(some)


def head_faults(file: File) -> Iterator[Fault]:
    """Yield the faults of everything but links and what is on them."""
    robot = file.robot
    yield from twice("robot.parameter", [[one.name] for one in robot.parameter])
    for place, parameter in enumerate(robot.parameter, 1):
        yield from _parameter_faults(robot, parameter, f"robot.parameter[{place}]")
    known = {one.name: one for one in robot.parameter}
    for name, value in robot.home.items():
        key = f"robot.home.{name}"
        yield from known_name(key, name, known, "parameter")
        if name in known:
            yield from _outside(key, value, known[name], "correct the posture")
    yield from _sample_faults(file.sweep, known)
    yield from _gravity_faults(file.sweep, file.sweep.gravity)
    yield from _map_faults(file)
    if robot.urdf is not None:
        what = "cannot be combined with `robot.urdf`"
        yield from given(robot, "robot", ("python", "link"), what, "remove it")
        if robot.length_unit != "m":
            what, way_out = "of a robot description is m", 'write length_unit = "m"'
            yield Fault("robot.length_unit", what, robot.length_unit, way_out)
    elif robot.python is not None:
        # Code gives places only: which way an axle on them points is not known.
        parts = ("link", "contact", "axle", "wheel", "group", "payload", "force", "mass")
        yield from given(
            robot, "robot", parts, "cannot be combined with `robot.python`", "remove it"
        )


def _parameter_faults(robot: Robot, parameter: Parameter, key: str) -> Iterator[Fault]:
    if robot.urdf is None:
        way_out = "remove it; links that share a parameter have a joint with a scale each"
        what = "means nothing without `robot.urdf`"
        yield from given(parameter, key, ("joint", "drive"), what, way_out)
    elif parameter.drive is not None:
        way_out = "keep one of them"
        yield from given(parameter, key, ("joint",), "cannot be combined with `drive`", way_out)
    if parameter.name in RESERVED:
        what = "is reserved for the map file"
        yield Fault(f"{key}.name", what, parameter.name, "choose another name")
    if parameter.unit not in (*ANGLE_UNITS, robot.length_unit):
        what = "is neither an angle nor the robot's length_unit"
        way_out = f"use one of: {', '.join((*ANGLE_UNITS, robot.length_unit))}"
        yield Fault(f"{key}.unit", what, parameter.unit, way_out)
    if not parameter.min < parameter.max:
        what = f"must be below max = {parameter.max:g}"
        yield Fault(f"{key}.min", what, parameter.min, "swap or widen the limits")


def _outside(key: str, value: float, parameter: Parameter, way_out: str) -> Iterator[Fault]:
    if value < parameter.min < parameter.max or parameter.min < parameter.max < value:
        what = "lies outside the parameter's min and max"
        yield Fault(key, what, value, f"widen the limits or {way_out}")


def _sample_faults(sweep: Sweep, known: Mapping[str, Parameter]) -> Iterator[Fault]:
    key = "sweep.samples"
    if sweep.samples is None:
        if known:
            way_out = f"give the nodes of each parameter: {', '.join(known)}"
            yield Fault(key, "is missing", NOTHING, way_out)
        return
    for name in sweep.samples:
        yield from known_name(f"{key}.{name}", name, known, "parameter")
    for name, parameter in known.items():
        here = f"{key}.{name}"
        if name not in sweep.samples:
            way_out = "give a number of nodes or a list of knots"
            yield Fault(here, "is missing", NOTHING, way_out)
            continue
        samples = sweep.samples[name]
        steady = np.diff(knots_of(parameter, samples)) > 0.0
        if isinstance(samples, int):
            if not steady.all():
                what = "has nodes that are one and the same number, so close are the limits"
                yield Fault(here, what, samples, "move min and max apart, or use fewer nodes")
            continue
        for place, (knot, rises) in enumerate(zip(samples, [True, *steady], strict=True), 1):
            if not rises:
                yield Fault(f"{here}[{place}]", "does not increase", knot, "sort the knots")
            yield from _outside(f"{here}[{place}]", knot, parameter, "remove the knot")


def _gravity_faults(sweep: Sweep, gravity: Gravity) -> Iterator[Fault]:
    key = "sweep.gravity"
    if gravity.chart == "sphere":
        if gravity.nodes < 2:
            what = "must be 2 or more for the sphere"
            yield Fault(f"{key}.nodes", what, gravity.nodes, "use more nodes")
        what = "belongs to the cone only"
        yield from given(gravity, key, ("max_tilt",), what, "remove it")
    else:
        yield from absent(gravity, key, "max_tilt")
    if gravity.channels is not None:
        what = "is given in [sweep.gravity] too"
        yield from given(sweep, "sweep", ("channels",), what, "keep one of them")
    if sweep.channels is None:
        yield from absent(gravity, key, "channels")
    where = "sweep" if gravity.channels is None else key
    channels = gravity.channels or sweep.channels or []
    for place, channel in enumerate(channels):
        if channel in channels[:place]:
            yield Fault(f"{where}.channels[{place + 1}]", "is given twice", channel, "remove one")


def _map_faults(file: File) -> Iterator[Fault]:
    """Yield the faults of a map: of its size, and of channels that a load leaves undefined."""
    samples, gravity = file.sweep.samples or {}, file.sweep.gravity
    nodes = math.prod(len(one) if isinstance(one, list) else one for one in samples.values())
    nodes *= gravity.nodes**2 * (6 if gravity.chart == "sphere" else 1)
    if nodes > bounds.NODES.most:
        what = f"is beyond the limit of {bounds.NODES.most:,} {bounds.NODES.what}"
        yield Fault("sweep.samples", what, nodes, "use fewer")
    robot, channels = file.robot, gravity.channels or file.sweep.channels or []
    acts = any(any(force.force) or any(force.moment) for force in robot.force)
    for channel in UNLOADED if acts or robot.com_uncertainty > 0.0 else ():
        if channel in channels:
            what = f"{channel} is not defined under a force or with com_uncertainty"
            yield Fault("sweep.channels", what, channels, "leave it out")
