"""`lutgen export` and `lutgen policy`: a map as C, and the policy that steers a robot by it."""

import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import click

from lutgen.cli import options as given
from lutgen.cli.lazy import exports, folders, maps, onboard
from lutgen.cli.options import RecipeOptions, command, log, open_source, option, stored_values
from lutgen.cli.output import entries, show
from lutgen.quantities import EXPORTABLE


@dataclass(frozen=True)
class FolderOptions(RecipeOptions):
    """Options of every command that writes a folder of C."""

    output: str = given.output("The folder; it appears when whole.", required=True)
    name: str | None = option("C identifier of the map.  [default: the robot's name]")


@dataclass(frozen=True)
class ExportOptions(FolderOptions):
    force: bool = given.force()
    flash: str | None = option(
        "Most bytes of tables and code: 16KiB, 64k (of 1000), 4096.", metavar="SIZE"
    )
    max_error: str | None = option(
        "Largest error of |SD_g|: 1% of its range, or 0.05 in the length unit.", metavar="X"
    )
    channels: str | None = option(
        f"Of {', '.join(EXPORTABLE)}; tip_angle is always there.  [default: the recipe's]",
        metavar="A,B",
    )
    # Their names come from `codecs` below: importing that takes longer than --help may.
    codec: str = option(
        "auto, or the only one that may be used; any other name is answered with all.",
        metavar="NAME",
        default="auto",
    )
    arithmetic: Literal["float", "integer"] = option(
        "integer: for processors without floating point.", default="float"
    )


@dataclass(frozen=True)
class PolicyOptions(FolderOptions):
    objective: str = option(
        "tip_angle; tip_angle-X*move2, less a price of moving from home; move, the smallest "
        "that keeps --margin; sdg, as the paper has it.",
        default="tip_angle",
    )
    within: float = option(
        "Take the smoothest of all postures within so many deg of the best.", default=1.0
    )
    nodes: int = option("Nodes of the table along either slope.", low=2, high=65, default=9)
    slope: float = option("Steepest slope of the table, deg.", above=0.0, high=89.0, default=45.0)
    home: tuple[tuple[str, float], ...] = option(
        "Posture where nothing else matters; repeat for each."
    )
    rate: tuple[tuple[str, float], ...] = option(
        "How fast a parameter changes, per second; repeat."
    )
    delta: tuple[tuple[str, float], ...] = option("How far from the driver's request; repeat.")
    cycle: float = option("Time of a cycle, s.", above=0.0, default=0.02)
    latency: float = option("From sample to motion, s.", above=0.0, default=0.06)
    margin: float = option("Tip angle that every way is to keep, deg.", above=0.0, default=3.0)
    convention: str = given.convention(
        "plane", "body", "The robot leans as its shape makes it, or keeps its attitude."
    )
    poses: int = option(
        "Poses that a cycle may make of many contacts, 1 or 2.", low=1, high=2, default=1
    )


@command("source", ExportOptions)
def export(source: str, options: ExportOptions) -> None:
    """Write SOURCE, a map or a recipe, as C tables with a runtime.

    With a flash size the most exact export that fits, with a largest error the smallest that
    keeps it, with both one that does both; without either, what the recipe's [export] says.

    \b
    $ lutgen export paper_two.h5 -o firmware
    $ cd firmware && cc -std=c99 -I. paper_two.c examples/read.c && ./a.out
    """
    # Faults of the folder are said before the source is opened.
    folders.check_directory(options.output, options.force)
    quiet = bool(click.get_current_context().find_root().params.get("quiet"))
    watched = not quiet and sys.stderr.isatty()

    def progress(text: str) -> None:
        if watched:
            click.echo(f"\r\033[K{text}", nl=False, err=True)
        log.info("%s", text)

    try:
        report = exports.export(
            open_source(source, options.allow_python),
            options.output,
            progress=progress,
            **entries(options, "name flash max_error channels codec arithmetic force"),
        )
    except KeyboardInterrupt:
        raise click.ClickException("interrupted; nothing is left behind") from None
    finally:
        if watched:
            click.echo("\r\033[K", nl=False, err=True)
    show({"directory": options.output, **report}, export_lines)


def export_lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    yield f"{report['name']}: {report['spec']}, {report['arithmetic']} arithmetic"
    yield "flash", folders.bytes_text(report["bytes"])
    for name, errors in folders.errors_of(report).items():
        said = "largest error {}, p99 {}, RMS {}".format(*errors) if errors else ""
        yield name, said or "errors not measured"
    unsafe, guard = report["false_safe"], f"guard {report['guard_deg']:.3g} deg"
    given_up = f"{folders.share(report['false_tip'])} of the stable configurations reported unsafe"
    tested = "not certified" if unsafe is None else f"{unsafe} points said to stand that tip"
    yield "verdict", f"{guard}, {given_up}, {tested}"
    for note in (report["certificate"] or {}).get("text", ()):
        yield "note", note
    yield "folder", report["directory"]


@command("source", PolicyOptions)
def policy(source: str, options: PolicyOptions) -> None:
    """Write on-board control: the best posture for each slope.

    SOURCE, a map or a recipe, is written as `lutgen export` does, with a policy beside it.  The
    map decides on board what is safe, never the table.

    \b
    $ lutgen policy absolem.toml -o firmware --rate front=45 --rate rear=45
    $ cd firmware && cc -std=c99 -I. absolem.c examples/control.c && ./a.out
    """
    folders.check_directory(options.output)
    opened = open_source(source, options.allow_python)
    recipe = opened.recipe if isinstance(opened, maps.StabilityMap) else opened
    policy_options = onboard.PolicyOptions(
        **entries(options, "objective nodes cycle latency convention poses"),
        within=math.radians(options.within),
        slope=math.radians(options.slope),
        margin=math.radians(options.margin),
        home=stored_values(recipe, options.home, "--home"),
        rate=stored_values(recipe, options.rate, "--rate"),
        delta=stored_values(recipe, options.delta, "--delta"),
    )
    report, found = onboard.policy(
        opened, options.output, policy_options, lambda text: log.info("%s", text), name=options.name
    )
    loss = found.loss._asdict()
    show({"directory": options.output, **report, "loss": loss}, policy_lines)


def policy_lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    policy, loss = report["policy"], report["loss"]
    yield f"{report['name']}: {report['spec']}, steered by a table of {policy['table_bytes']} bytes"
    losses = f"{loss['mean']:.2g} deg mean, {loss['p95']:.2g} p95, {loss['largest']:.2g} largest"
    steps = f"{loss['step']:.3g} deg between nodes at most; the best alone jumps"
    yield "loss", f"{losses}, against the best posture on {loss['slopes']} slopes"
    yield "steps", f"{steps} {loss['best_step']:.3g}"
    tips = f"on {100.0 * loss['tips']:.2g} % of slopes on which another posture stands"
    yield "tips over", tips
    yield "state", f"{4 * policy['state_words']} bytes of RAM and those of an address"
    yield "folder", report["directory"]
