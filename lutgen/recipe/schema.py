"""Every key of a recipe, once: its type, unit, interval, meaning and an example."""

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Strict, Tag
from pydantic_core import PydanticCustomError

from lutgen import bounds
from lutgen.quantities import CHANNELS

MAX_CONTACTS = bounds.CONTACTS.most
ZEROS = [0.0, 0.0, 0.0]
# Patterns of texts, and the words for a text that does not match.
TEXT = r"\S"
IDENTIFIER = r"^[A-Za-z][A-Za-z0-9_]*$(?!\n)"
SIZE = r"^(?=[^eE]*[1-9])\s*[0-9]+(\.[0-9]+)? ?(B|[kK]i?B|Mi?B)?\s*$"
SHARE = r"^(?=[^eE]*[1-9])\s*[0-9]*\.?[0-9]+([eE][-+]?[0-9]+)? ?%?\s*$"
PATTERNS = {TEXT: "must not be empty", IDENTIFIER: "is not an identifier"}
_BIG = float(bounds.MAGNITUDE.most)
_NOT_ZERO: dict[str, Any] = {"not": {"const": 0}}


def _directed(values: list[float]) -> list[float]:
    if not 0.0 < math.hypot(*values) < math.inf:
        raise PydanticCustomError("direction", "must have a length above 0")
    return values


def _acting(value: float) -> float:
    if value == 0.0:
        raise PydanticCustomError("factor", "must not be zero")
    return value


def _either(kind: type) -> Discriminator:
    """Return what chooses from a union; its tags are no keys, and messages leave them out."""
    return Discriminator(lambda value: "|yes" if isinstance(value, kind) else "|no")


def _in(unit: str) -> Any:
    return Field(json_schema_extra={"x-unit": unit})


LengthUnit = Literal["m", "cm", "mm", "1"]
ANGLE_UNITS = ("deg", "rad")
Unit = Literal["deg", "rad", LengthUnit]
Channel = Literal[CHANNELS]  # type: ignore[valid-type]
Channels = Annotated[list[Channel], Field(min_length=1, json_schema_extra={"uniqueItems": True})]
Text = Annotated[str, Field(pattern=TEXT)]
Flag = Annotated[bool, Strict()]
Finite = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Number = Annotated[Finite, Field(ge=-_BIG, le=_BIG)]
Positive = Annotated[Finite, Field(gt=0, le=_BIG)]
NotNegative = Annotated[Finite, Field(ge=0, le=_BIG)]
Factor = Annotated[Number, AfterValidator(_acting), Field(json_schema_extra=_NOT_ZERO)]
OfParameter = Annotated[Number, _in("in its `unit`")]
Length = Annotated[NotNegative, _in("length_unit")]
Mass = Annotated[NotNegative, _in("kg")]
Radius = Annotated[Positive, _in("length_unit")]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Place = Annotated[Vector, _in("length_unit")]
Sides = Annotated[list[Positive], Field(min_length=3, max_length=3), _in("length_unit")]
Direction = Annotated[
    Vector, AfterValidator(_directed), Field(json_schema_extra={"contains": _NOT_ZERO})
]
Nodes = Annotated[int, Strict(), Field(ge=2, le=bounds.KNOTS.most)]
Knots = Annotated[list[Number], Field(min_length=2)]
Sampled = Annotated[Annotated[Knots, Tag("|yes")] | Annotated[Nodes, Tag("|no")], _either(list)]
Size = Annotated[str, Field(pattern=SIZE), Tag("|yes")]
Share = Annotated[str, Field(pattern=SHARE), Tag("|yes")]
Bytes = Annotated[Finite, Field(ge=1, le=_BIG), Tag("|no")]


def key(meaning: str, example: object, default: object = ...) -> Any:
    """Return a key that a table needs: its meaning, and a value that it may have."""
    return Field(default, description=meaning, examples=None if example is None else [example])


def may(meaning: str, example: object, default: object = None) -> Any:
    """Return a key that a table may have."""
    return key(meaning, example, default)


def tables(meaning: str) -> Any:
    """Return a key of an array of tables."""
    return Field([], description=meaning, max_length=bounds.ENTRIES.most)


class Table(BaseModel):
    """A table, which has the keys that are listed and no other."""

    model_config = ConfigDict(extra="forbid", regex_engine="python-re", defer_build=True)


class Step(Table):
    """How a joint follows a parameter."""

    scale: Factor = may("Radians or metres for one of the parameter; not 0.", -1.0, 1.0)
    offset: OfParameter = may("Where the joint is at parameter 0.", 10.0, 0.0)


Driven = Annotated[Annotated[Step, Tag("|yes")] | Annotated[Factor, Tag("|no")], _either(dict)]


class Parameter(Table):
    """A joint or a length that the robot can change: an axis of the map."""

    name: Annotated[str, Field(pattern=IDENTIFIER)] = key("Letters, digits and _.", "lift")
    min: OfParameter = key("Where the map begins.", -10.0)
    max: OfParameter = key("Where the map ends, above `min`.", 50.0)
    unit: Unit = key("An angle, or the robot's `length_unit`.", "deg")
    joint: Text | None = may("The joint of the URDF, else that of its own name.", "hinge")
    drive: Annotated[dict[str, Driven], Field(min_length=1)] | None = may(
        "Several joints of the URDF that it moves: of each its scale, or scale and offset.",
        {"left_hip": 1.0, "right_hip": {"scale": -1.0, "offset": 10.0}},
    )
    meaning: Text | None = may("The meaning of its values, for figures.", "0: ahead, 90: up")


class Joint(Table):
    """How a link moves against its parent."""

    type: Literal["revolute", "prismatic", "none"] = key(
        "It turns about its axis, is pushed along it, or does not move.", "revolute"
    )
    axis: Direction | None = may("In the link's frame; needed where it moves.", [0, 1, 0])
    parameter: Text | None = may("Its parameter; several joints may share one.", "lift")
    scale: Factor = may("The joint is at `scale` times the parameter plus `offset`.", -1.0, 1.0)
    offset: OfParameter = may("Where the joint is at parameter 0.", 90.0, 0.0)


class Link(Table):
    """A rigid part; all make a tree with the root `body`."""

    name: Text = key("A name of its own; `body` is the root.", "leg")
    parent: Text | None = may("The link that carries it; every link but `body` has one.", "body")
    origin: Place = may("Where it is in its parent.", [0.3, 0, 0], ZEROS)
    rpy: Annotated[Vector, _in("deg")] = may(
        "How it is turned in its parent: roll, pitch, yaw about fixed axes.", [0, 0, 180], ZEROS
    )
    joint: Joint | None = may(
        "How it moves against its parent; without it, it is fixed.",
        {"type": "revolute", "axis": [0, 1, 0], "parameter": "lift"},
    )
    mass: Mass = may("Any unit will do where no force acts.", 0.75, 0.0)
    com: Place = may(
        "Its centre of mass; without any masses that of all is the origin.", [0.08, 0, 0], ZEROS
    )
    shape: Sides | None = may("Sides of a box about its com, for figures.", [0.5, 0.3, 0.1])
    shape_at: Place | None = may("Middle of that box, if it is not the com.", [0.1, 0, 0])


class Contact(Table):
    """A place that can touch the ground: a point, a sphere or a disc."""

    name: Text | None = may("Its own; for the shapes of a link the first part.", "front_left")
    link: Text = key("The link that it is on.", "body")
    position: Place | None = may(
        "Its centre in the link's frame; under a `urdf` else by the link's shapes.", [0.25, 0.2, 0]
    )
    radius: Length = may(
        "Above 0 it is a sphere, with an `axis` a disc: a wheel, or one end of a track.", 0.09, 0.0
    )
    axis: Direction | None = may("The axle of a disc, in the link's frame.", [0, 1, 0])
    rolling: Flag = may(
        "It turns freely, without a brake; changes no map and no export.", True, False
    )
    width: Radius | None = may("Width of a disc along its axle, for figures.", 0.1)
    belt: Text | None = may("Discs of one belt are drawn as a track, for figures.", "left")


class Axle(Table):
    """An axle that swings freely about a pivot, as a tractor's front axle does."""

    name: Text = key("A name of its own.", "front")
    contacts: Annotated[list[Text], Field(min_length=2, max_length=2)] = key(
        "The two that it carries, one on either side.", ["front_left", "front_right"]
    )
    pivot: Place = key("A point of the line about which it swings.", [2.3, 0, 0.5])
    axis: Direction = may("Along that line.", [1, 0, 0], [1, 0, 0])
    link: Text = may("The link with the pivot, and its frame.", "chassis", "body")
    stops: Annotated[Finite, Field(gt=0, le=90), _in("deg")] | None = may(
        "How far it swings to either side; changes no verdict.", 11.0
    )


class Wheel(Table):
    """A contact that is driven, for `lutgen wheels`."""

    contact: Text = key("The contact with which it touches the ground.", "front_left")
    axis: Direction | None = may("Its axle, in the link's frame; of a disc its own.", [0, 1, 0])
    radius: Radius | None = may("The rolling radius; of a disc its own.", 0.09)
    steered: Flag = may("It may turn about the ground's normal.", True, False)
    rollers: Annotated[Finite, Field(gt=-90, lt=90), _in("deg")] | None = may(
        "From the rolling direction to its rollers' axes: 0 omniwheel, 45 mecanum wheel.", 45.0
    )


class Group(Table):
    """Contacts that carry together, for `least_share`."""

    name: Text = key("A name of its own.", "front")
    contacts: Annotated[list[Text], Field(min_length=1)] = key(
        "The contacts.", ["front_left", "front_right"]
    )


class Payload(Table):
    """A load on the robot."""

    name: Text = key("A name that no link has.", "load")
    link: Text = key("The link that carries it.", "body")
    position: Place = key("In the link's frame.", [0, 0, 0.3])
    mass: Annotated[Positive, _in("kg")] = key("In the unit of the links' masses.", 5.0)


class Force(Table):
    """A force on the robot."""

    name: Text = key("A name of its own.", "rope")
    link: Text = key("The link that it pulls at.", "body")
    position: Place = key("Where it acts, in the link's frame.", [-0.3, 0, 0])
    force: Annotated[Vector, _in("N")] = key("Along the body's axes.", [-20, 0, 0])
    moment: Annotated[Vector, _in("N length_unit")] = may(
        "Along the body's axes.", [0, 0, 1], ZEROS
    )


class Robot(Table):
    """The robot."""

    name: Text = key("The name of the robot.", "rover")
    length_unit: LengthUnit = key("The unit of all lengths, 1 for ratios.", "m")
    friction: Positive | None = may(
        "Coefficient of all braked contacts; says what slides, changes no verdict.", 0.6
    )
    upright: Annotated[Finite, Field(gt=0, le=180), _in("deg")] = may(
        "A facet counts when its normal is less than this from the body's -z.", 180.0, 80.0
    )
    rock_angle: Annotated[Finite, Field(ge=0, le=45), _in("deg")] = may(
        "The largest turn of a roll from rest to rest over which it may rock.", 0.0, 30.0
    )
    rest_width: Length | None = may(
        "How wide a facet's polygon must be to be a rest; by default 1 % of the size.", 0.005
    )
    contact_tolerance: Length | None = may(
        "Contacts this far from a facet's plane carry; by default 1e-4 of the size.", 0.0001
    )
    mass: Annotated[Positive, _in("kg")] | None = may(
        "The whole mass as weighed, with payloads; the links' masses are scaled to it.", 31.5
    )
    com_offset: Place = may(
        "Where the com is from the computed one, along the body's axes, as weighed.",
        [0.01, 0, 0.02],
        ZEROS,
    )
    com_uncertainty: Length = may(
        "The com lies within this of the computed one; no `energy_margin` then.", 0.02, 0.0
    )
    home: dict[str, OfParameter] = may(
        "The posture to stand in; what it leaves out is amid its range.", {"lift": 20.0}, {}
    )
    urdf: Text | None = may("A description beside the recipe, instead of links.", "robot.urdf")
    python: Text | None = may(
        "Code that places the contacts, module:function; needs `--allow-python`.", "rover:postures"
    )
    title: Text | None = may("The name in figures, if another.", "Rover, 2nd")
    parameter: list[Parameter] = tables("The changes of the robot, in the order of the axes.")
    link: list[Link] = tables("Rigid parts, a tree with the root `body`.")
    contact: list[Contact] = tables(f"Places that can touch the ground, 3 to {MAX_CONTACTS}.")
    axle: list[Axle] = tables("Pairs of contacts that swing about a pivot.")
    wheel: list[Wheel] = tables("Contacts that are driven, for `lutgen wheels`.")
    group: list[Group] = tables("Contacts that carry together; without any each alone.")
    payload: list[Payload] = tables("Point masses that the robot carries.")
    force: list[Force] = tables("Pulls at it; no export and no `energy_margin` then.")


class Gravity(Table):
    """The directions of the map."""

    chart: Literal["cone", "sphere"] = key("Tilts up to `max_tilt`, or every direction.", "cone")
    max_tilt: Annotated[Finite, Field(gt=0, le=85), _in("deg")] | None = may(
        "The largest tilt of a cone, which needs it; a sphere has none.", 60.0
    )
    nodes: Annotated[int, Strict(), Field(ge=1, le=bounds.SIDE.most)] = key(
        "Along a side of a face; 2 or more of a sphere, which has six faces.", 33
    )
    channels: Channels | None = may("Its quantities; here or in `[sweep]`.", ["sdg"])


class Sweep(Table):
    """The contents of the map."""

    samples: dict[str, Sampled] | None = may(
        "Nodes of each parameter, both ends included, or its knots.",
        {"lift": 37, "reach": [0.0, 0.1, 0.4]},
    )
    gravity: Gravity = key("Which directions the map has.", None)
    channels: Channels | None = may("Its quantities; here or in `[sweep.gravity]`.", ["sdg"])


class Export(Table):
    """Defaults of the options of `lutgen export`."""

    flash: Annotated[Size | Bytes, _either(str)] | None = may(
        "The most bytes of tables and code: a number, or a text with B, kB, KiB or MiB.", "16KiB"
    )
    max_error: Annotated[Share | Annotated[Positive, Tag("|no")], _either(str)] | None = may(
        "The largest error of the stability factor: a length, or with % a share of its range.", "1%"
    )


class File(Table):
    """A recipe of lutgen."""

    robot: Robot = key("The robot.", None)
    sweep: Sweep = key("Nodes and channels of its map.", None)
    export: Export | None = may("Defaults of `lutgen export`.", None)
