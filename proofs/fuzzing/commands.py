"""Command lines of every command and option that there is, with values that nobody types.

The commands are those of the program itself, so a new one is tried without a word here.
"""

import functools
import itertools
import random

import click

from lutgen.cli.group import main
from proofs.fuzzing import hostile
from proofs.fuzzing.case import ANSWERS, Case
from proofs.fuzzing.hostile import pick
from proofs.fuzzing.seeds import DESCRIPTIONS, MESH, SPY, STANCE, TERRAIN, recipes, swept

__all__ = ["commands", "make"]

# What takes longer than a case may, where it succeeds, is only tried with what cannot: half a
# minute of computing, a C compiler's runs, other processes.
SLOW = frozenset(("paper", "export", "policy", "explore", "prove"))
UNTRIED = ("--engine", "--scheduler", "--workers", "--animate", "--xacro")
# A map that lutgen made is replaced by another one without a word.
OWN = "m.h5"
FILES = ("r.toml", "rover.toml", OWN, "t.csv", "s.toml", "r.urdf", "r.srdf", "empty", "folder")
# Nothing outside of the case's folder: a program that is run as root could replace it.
PATHS = (*FILES, "nowhere", ".", "", "nowhere/out", "-", "empty/x")
OUTPUTS = (*("out.toml", "out.h5", "out.csv", "out.svg", "out.png", "out", "out.gif"), *PATHS)
TEXTS = ("front", "reach=0.3", "swing=1", "reach", "0,0,-1", "sdg", "sdg+height", "1%", "16KiB")
WORDS = ("--json", "-h", "--", "-", "--no-such", "-vvv", "r.toml", "", "\udcff", "é", "-p")


@functools.cache
def commands() -> tuple[tuple[str, click.Command], ...]:
    """Return every command with its name."""
    assert isinstance(main, click.Group)
    return tuple(sorted(main.commands.items()))


def _value(rng: random.Random, option: click.Parameter) -> str:
    kind = option.type
    if rng.random() < 0.06:
        return str(pick(rng, hostile.NAMES)).replace("\x00", "0")
    if isinstance(kind, click.Choice):
        return str(pick(rng, [*kind.choices, "none of them"]))
    if isinstance(kind, click.Path):
        return str(pick(rng, OUTPUTS if "output" in (option.name or "") else PATHS))
    if kind is click.INT or isinstance(kind, click.IntRange):
        wild = rng.random() < 0.5
        return hostile.text_number(rng) if wild else str(rng.randrange(-3, 40))
    if kind is click.FLOAT or isinstance(kind, click.FloatRange):
        wild = rng.random() < 0.5
        return hostile.text_number(rng) if wild else f"{rng.uniform(-40, 40):.3g}"
    shape = kind.name or ""
    if "," in shape:
        parts = [_number(rng) for _ in range(shape.count(",") + pick(rng, (1, 1, 1, 1, 0, 2)))]
        return ",".join(parts)
    if "=" in shape:
        name = pick(rng, ("reach", "swing", "front", "", "no such"))
        return f"{name}={':'.join(_number(rng) for _ in range(shape.count(':') + 1))}"
    return str(pick(rng, (*TEXTS, _number(rng))))


def _number(rng: random.Random) -> str:
    return hostile.text_number(rng) if rng.random() < 0.3 else f"{rng.uniform(-1, 1):.3g}"


def _words(rng: random.Random, command: click.Command) -> list[str]:
    words: list[str] = []
    for option in command.params:
        if isinstance(option, click.Argument):
            first = pick(rng, FILES[:6]) if rng.random() < 0.5 else _value(rng, option)
            words.append("r.toml" if rng.random() < 0.5 else str(first))
            continue
        assert isinstance(option, click.Option)
        flag = pick(rng, option.opts)
        likely = 0.97 if option.required else 0.2
        if rng.random() > likely or set(UNTRIED) & set(option.opts):
            continue
        words.append(str(flag))
        if not option.is_flag:
            words.append(_value(rng, option))
    if rng.random() < 0.1:
        words.insert(rng.randrange(len(words) + 1), pick(rng, WORDS))
    if rng.random() < 0.05:
        rng.shuffle(words)
    return words


@functools.cache
def _files() -> dict[str, bytes]:
    texts = {"t.csv": TERRAIN, "s.toml": STANCE, "r.urdf": DESCRIPTIONS["crane.urdf"], "empty": ""}
    texts |= {"r.toml": recipes()["tripod"], "rover.toml": recipes()["rover"]}
    own = {name: text.encode() for name, text in texts.items()}
    return own | {OWN: swept("tripod"), "mast.stl": MESH, "spy.py": SPY}


def _is_output(flag: str, command: click.Command) -> bool:
    """Return whether a file that is written stands behind a flag."""
    named = (option for option in command.params if flag in option.opts)
    return any("output" in (option.name or "") for option in named)


def make(rng: random.Random) -> Case:
    """Return a case of a command line; what it writes is called out, whatever stands behind -o."""
    name, command = pick(rng, commands())
    if name in SLOW and rng.random() < 0.5:  # not as often as the others
        name, command = pick(rng, [each for each in commands() if each[0] not in SLOW])
    words = [name, *_words(rng, command)]
    if name in SLOW:
        words.append("--no-such-option")
    if name == "path" and "multistart" in words:
        # Which takes half a second a point.
        words += ["--points", "5"]
    if rng.random() < 0.1:
        words.insert(0, pick(rng, ("-q", "-v", "-vv", "--version", "--no-such", "")))
    files = _files()
    written = tuple(
        word.rstrip("/")
        for before, word in itertools.pairwise(words)
        if word.startswith("out")
        or "nowhere" in word
        or (
            _is_output(before, command) and (word not in files or word == OWN or "--force" in words)
        )
    )
    return Case(name, files, tuple(words), ANSWERS, written)
