"""Terrains, maps and command lines, and the kinds of all cases."""

import io
from typing import Any

import click
import h5py
import numpy as np
from hypothesis import strategies as st

from lutgen.cli import main
from proofs.fuzzing.robots import INPUT, MESH, recipe_cases, urdf_cases
from proofs.fuzzing.run import Case
from proofs.fuzzing.values import NAMES, SPY, TEXTS, damaged, recipes, swept

COLUMNS = ("x", "y", "z", "heading", "nx", "ny", "nz")
SEAL, OTHER = b"lutgen-digest-", b"Lutgen-digest-"
VALUES: tuple[Any, ...] = (
    *("", "x", b"\xff\xfe", 0, -1, 2**63 - 1, float("nan"), 1e308, "a" * 60_000, "[" * 50_000),
    *(np.zeros(0, np.uint8), np.ones((3, 3)), np.array([b"ab", b"c"]), h5py.Empty("f")),
)
# What takes longer than a run may, where it succeeds, is only tried with what cannot.
SLOW = frozenset(("paper", "export", "policy", "explore", "prove"))
UNTRIED = frozenset(("--engine", "--scheduler", "--workers", "--animate", "--xacro"))
PATHS = ("r.toml", "m.h5", "t.csv", "r.urdf", "folder", "nowhere", ".", "", "-", "/dev/zero")
OUTPUTS = ("out.toml", "out.h5", "out.csv", "out.svg", "out.png", "r.toml")
WORDS = ("front", "reach=0.3", "reach", "0,0,-1", "0.1,0", "sdg", "sdg+height", "1%", "16KiB")


@st.composite
def terrain_cases(draw: st.DrawFn) -> Case:
    """Draw a drive over a terrain that no robot has seen."""
    head = draw(
        st.just(list(COLUMNS)) | st.permutations(COLUMNS) | st.lists(st.sampled_from(NAMES))
    )
    cells = st.sampled_from(("0", "0.1", "1"))
    cells = draw(st.sampled_from((cells, cells | TEXTS)))
    rows = draw(st.lists(st.lists(cells, min_size=len(head), max_size=len(head)), max_size=8))
    rows = [head, *rows, *rows * draw(st.sampled_from((0, 0, 0, 300)))]
    separator = draw(st.sampled_from((",", ",", ",", ";", "\t", " ")))
    ending = draw(st.sampled_from(("\n", "\n", "\r\n", "\r", "\n\n", "\x00\n", "\u2028")))
    coding = draw(st.sampled_from(("utf-8", "utf-8", "utf-16", "utf-8-sig")))
    data = ending.join(separator.join(row) for row in rows).encode(coding, "replace")
    if draw(st.integers(0, 9)) == 0:
        data = draw(damaged(data))
    how = draw(st.sampled_from((("--no-control",), ("--no-control",), ("--method", "search"))))
    words = ("path", "r.toml", "--terrain", "t.csv", "--json", *how)
    robot = recipes()[draw(st.sampled_from(("tripod", "rover")))]
    return Case(words, {"r.toml": robot.encode(), "t.csv": data}, INPUT)


def unsealed(data: bytes) -> bytes:
    """Return a map without a digest, which HDF5 may edit."""
    assert SEAL in data
    return data.replace(SEAL, OTHER)


@st.composite
def edited(draw: st.DrawFn, data: bytes) -> bytes:
    """Draw a map without a seal in which an attribute or a dataset is changed."""
    memory = io.BytesIO(unsealed(data))
    with h5py.File(memory, "r+") as file:
        node = file[draw(st.sampled_from(["/", "sdg", "tip_angle"]))]
        name = draw(st.sampled_from(["sdg", "tip_angle"]))
        match draw(st.sampled_from(("value", "value", "drop", "type", "shape", "link", "outside"))):
            case "value":
                node.attrs[draw(st.sampled_from(sorted(node.attrs)))] = draw(
                    st.sampled_from(VALUES)
                )
            case "drop":
                del file[name]
            case "link":
                del file[name]
                targets = (h5py.SoftLink("/nowhere"), h5py.ExternalLink("other.h5", "/sdg"))
                file[name] = draw(st.sampled_from((*targets, h5py.SoftLink(f"/{name}"))))
            case "outside":
                shape, dtype = file[name].shape, file[name].dtype
                del file[name]
                file.create_dataset(name, shape, dtype, external=[("secret", 0, 4 * 10**4)])
            case how:
                values = file[name][...]
                del file[name]
                if how == "type":
                    kind = draw(st.sampled_from(("f8", ">f4", "i4", "S4", "c8", "?", "u8")))
                    file[name] = np.nan_to_num(values).astype(kind)
                else:
                    file[name] = np.resize(values, draw(st.sampled_from(((0,), (3, 2), (100,)))))
    return memory.getvalue()


@st.composite
def map_cases(draw: st.DrawFn) -> Case:
    """Draw a damaged map and a command that reads it."""
    sound = swept()
    files = {"other.h5": swept("rover"), "secret": b"\x2a\x00\x80\x3f" * 10_000}
    if draw(st.integers(0, 3)) == 0:
        # Every byte of a sealed map is under its digest.
        data = draw(damaged(sound).filter(lambda made: made != sound))
        return Case(("info", "m.h5", "--verify"), files | {"m.h5": data}, frozenset((1, 2)))
    data = draw(edited(sound) | damaged(unsealed(sound)))
    lines = ("info m.h5 --json --unsealed", "info m.h5 --json --unsealed", "info m.h5 --verify")
    more = ("eval m.h5 --json -g 0.1,0,-1", "limits m.h5 --json", "optimum m.h5 --method map")
    words = tuple(draw(st.sampled_from((*lines, *more))).split())
    if draw(st.integers(0, 19)) == 0:
        files |= {"r.toml": recipes()["tripod"].encode(), "m.h5.part": data}
        words = ("sweep", "r.toml", "-o", "m.h5", "--resume", "--threads", "1")
        then = ("info", "m.h5", "--verify", "--json")
        return Case(words, files, written=("m.h5", "m.h5.part"), then=then)
    return Case(words, files | {"m.h5": data})


@st.composite
def command_cases(draw: st.DrawFn) -> Case:
    """Draw a command line of any command and option that there is."""
    assert isinstance(main, click.Group)
    name = draw(st.sampled_from(sorted(main.commands)))
    words = [name]
    for option in main.commands[name].params:
        if isinstance(option, click.Argument):
            words.append(draw(st.just("r.toml") | st.sampled_from(PATHS)))
        elif draw(st.integers(0, 4)) == 0 or option.required:
            assert isinstance(option, click.Option)
            kind, values = option.type, st.sampled_from(WORDS) | TEXTS | st.sampled_from(NAMES)
            if UNTRIED & set(option.opts):
                continue
            if isinstance(kind, click.Choice):
                values = st.sampled_from([*map(str, kind.choices), "none of them"])
            elif isinstance(kind, click.Path):
                output = "output" in (option.name or "")
                values = st.sampled_from(OUTPUTS if output else PATHS)
            elif "int" in kind.name or "float" in kind.name:
                values = st.integers(-3, 40).map(str) | TEXTS
            words.append(draw(st.sampled_from(option.opts)))
            # No system hands a NUL over.
            words += [] if option.is_flag else [draw(values).replace("\x00", "0")]
    if name in SLOW:
        words.append("--no-such-option")
    if name == "path":
        words += ["--points", "5"]
    files = {name: text.encode() for name, text in (("t.csv", ",".join(COLUMNS)), ("s.toml", ""))}
    files |= {"r.toml": recipes()["tripod"].encode(), "m.h5": swept(), "mast.stl": MESH}
    return Case(tuple(words), files | {"spy.py": SPY}, written=(*OUTPUTS[:-1], "m.h5"))


KINDS = {
    "recipe": recipe_cases(),
    "urdf": urdf_cases(),
    "terrain": terrain_cases(),
    "map": map_cases(),
    "command": command_cases(),
}
