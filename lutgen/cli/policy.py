"""`lutgen policy`: the table of best postures, and the C that follows it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import (
    Assignment,
    Assignments,
    Named,
    RecipeOptions,
    asks,
    log,
    option,
    output,
)
from lutgen.cli.sources import open_source
from lutgen.cli.table import show
from lutgen.parts import to_internal

if TYPE_CHECKING:
    from lutgen.recipe import Recipe


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    output: str = output(required=True, help="The folder; it appears when whole.")
    name: str | None = option(help="C identifier of the map.  [default: the robot's name]")
    objective: str = option(
        default="tip_angle",
        help="tip_angle; tip_angle-X*move2, less a price of moving from home; move, the smallest "
        "that keeps --margin; sdg, as the paper has it.",
    )
    within: float = option(
        default=1.0, help="Of all postures within so many deg of the best the smoothest is taken."
    )
    nodes: int = option(default=9, help="Nodes of the table along either slope.")
    slope: float = option(default=45.0, help="Steepest slope of the table, deg.")
    home: Assignments = option(  # noqa: RUF009
        type=Assignment(),
        multiple=True,
        help="Posture where nothing else matters; repeat for each.",
    )
    rate: Assignments = option(  # noqa: RUF009
        type=Assignment(), multiple=True, help="How fast a parameter changes, per second; repeat."
    )
    delta: Assignments = option(  # noqa: RUF009
        type=Assignment(), multiple=True, help="How far from what the driver asks for; repeat."
    )
    cycle: float = option(default=0.02, help="Of a cycle, s.")
    latency: float = option(default=0.06, help="From sample to motion, s.")
    margin: float = option(default=3.0, help="Tip angle that every way is to keep, deg.")
    convention: str = option(
        type=click.Choice(("plane", "body")),
        default="plane",
        help="Whether the robot leans as its shape makes it, or keeps its attitude.",
    )
    poses: int = option(default=1, help="Poses that a cycle may make of many contacts, 1 or 2.")


@click.command(short_help="Write on-board control: the best posture for each slope, and its C.")
@click.argument("source", type=Named())
@asks(Asked)
def policy(source: str, asked: Asked) -> None:
    """Write SOURCE, a map or a recipe, as `lutgen export` does, with a policy that steers it.

    The map decides on board what is safe, never the table.

    \b
    $ lutgen policy absolem.toml -o firmware --rate front=45 --rate rear=45
    $ cd firmware && cc -std=c99 -I. absolem.c examples/control.c && ./a.out
    """
    from firmware_export.control import Wishes
    from firmware_export.control import policy as run
    from firmware_export.emit import check_directory
    from lutgen.mapping import StabilityMap

    check_directory(asked.output)
    opened = open_source(source, asked.allow_python)
    recipe = opened.recipe if isinstance(opened, StabilityMap) else opened
    wishes = Wishes(
        objective=asked.objective,
        within=math.radians(asked.within),
        nodes=asked.nodes,
        slope=math.radians(asked.slope),
        home=_stored(recipe, asked.home),
        rate=_stored(recipe, asked.rate),
        delta=_stored(recipe, asked.delta),
        cycle=asked.cycle,
        latency=asked.latency,
        margin=math.radians(asked.margin),
        convention=asked.convention,
        poses=asked.poses,
    )
    report, found = run(
        opened, asked.output, wishes, lambda text: log.info("%s", text), name=asked.name
    )
    told = {
        "directory": asked.output,
        **report,
        "loss": {**found.loss._asdict(), "slopes": found.slopes, "best_step": found.plain_step},
    }
    show(told, lines(told), asked.as_json)


def _stored(recipe: "Recipe", given: Assignments) -> dict[str, float]:
    """Return assigned values in rad or the recipe's length; unknown names as they are."""
    units = {p.name: p.display_unit for p in recipe.parameters}
    return {name: to_internal(value, units.get(name, "1")) for name, value in given}


def lines(told: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    policy, loss = told["policy"], told["loss"]
    yield f"{told['name']}: {told['spec']}, steered by a table of {policy['table_bytes']} bytes"
    yield (
        f"loss        {loss['mean']:.2g} deg mean, {loss['p95']:.2g} p95, {loss['largest']:.2g} "
        f"largest, against the best posture on {loss['slopes']} slopes"
    )
    yield (
        f"steps       {loss['step']:.3g} deg between nodes at most; the best alone jumps "
        f"{loss['best_step']:.3g}"
    )
    yield f"tips        on {100.0 * loss['tips']:.2g} % of slopes on which another posture stands"
    yield f"state       {4 * policy['state_words']} bytes of RAM and those of an address"
    yield f"folder      {told['directory']}"
