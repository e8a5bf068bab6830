"""Recipes, URDFs, terrains, maps and command lines, sound and not, and who reads them."""

import io
import json
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import click
import h5py
import numpy as np
import trimesh
from click.testing import CliRunner
from hypothesis import strategies as st

from lutgen.cli import main
from proofs.fuzzing.run import Case, ended
from proofs.fuzzing.values import WORDS, damaged, mutated
from proofs.toml import toml_text
from tests.fixtures.recipes import rover, tripod
from tests.fixtures.robots import collision, joint, link, robot

STARTS = Path(__file__).resolve().parent.parent.parent / "lutgen" / "recipe" / "starts"
RECIPES = [tripod(nodes=5), rover(nodes=5), *(one.read_text() for one in STARTS.glob("*.toml"))]
INPUT = frozenset((0, 2, 3))
SCHEMA = json.loads(CliRunner().invoke(main, ["schema"]).stdout)
READ_RECIPE = ("check", "eval", "limits", "metrics", "wheels -v 0.1,0", "optimum --levels 2")
MESH = bytes(trimesh.creation.box((0.1, 0.1, 0.3)).export(file_type="stl"))
NAMES = st.sampled_from(("base", "a", "b", "c", "wheel"))
JOINTS = st.sampled_from(("revolute", "fixed", "continuous", "prismatic", "floating", "planar"))
PLACES = st.sampled_from(("0 0 0", "0.3 0.2 -0.1", "-0.3 -0.2 -0.1", "0.3 -0.2 -0.1", "0 1 0"))
FILES = ("mast.stl", "../../etc/passwd", "/dev/zero", "package://x/y.stl", "r.urdf", "")
SHAPES = ('box size="0.1 0.3 0.1"', 'sphere radius="0.1"', 'cylinder radius="0.1" length="0.2"')
SHAPE = st.sampled_from((*SHAPES, *(f'mesh filename="{name}"' for name in FILES)))
COLLISIONS = st.lists(st.builds(collision, SHAPE, PLACES, PLACES), max_size=3).map("".join)
LIMIT = '<axis xyz="0 1 0"/><limit lower="-1" upper="1"/>'
INSIDE = st.just(LIMIT) | NAMES.map((LIMIT + '<mimic joint="{}_joint"/>').format)
TERRAIN = "x,y,z,heading,nx,ny,nz\n" + "0,0.1,0,0.3,0,0.1,1\n" * 6
READ_MAP = ("info m.h5 --json --unsealed", "info m.h5 --verify", "eval m.h5 --json -g 0.1,0,-1")
VALUES = ("", b"\xff\xfe", 0, 2**63 - 1, float("nan"), "[" * 50_000, np.ones((3, 2)))
LINKS = (h5py.SoftLink("/nowhere"), h5py.SoftLink("/sdg"), h5py.ExternalLink("other.h5", "/sdg"))
# What takes longer than a run may, where it succeeds, is only tried with what cannot.
SLOW = ("paper", "export", "policy", "explore")
MORE = {"path": ("--points", "5"), **dict.fromkeys(SLOW, ("--no-such-option",))}
UNTRIED = frozenset(("--engine", "--scheduler", "--workers", "--animate", "--xacro"))
PATHS = ("r.toml", "m.h5", "t.csv", "nowhere", ".", "", "-", "/dev/zero")
OUTPUTS = ("out.toml", "out.h5", "out.csv", "out.svg", "out.png", "r.toml")
KNOWN = ("front", "reach=0.3", "reach", "0,0,-1", "0.1,0", "sdg", "sdg+height", "1%", "16KiB", "3")


def allowed(schema: dict[str, Any]) -> st.SearchStrategy[Any]:
    """Return the tables that a JSON schema allows, with the examples of its keys."""
    if schema.get("type") == "object":
        keys = {key: allowed(value) for key, value in schema.get("properties", {}).items()}
        need = {key: keys.pop(key) for key in schema.get("required", ()) if key in keys}
        return st.fixed_dictionaries(need, optional=keys)
    if "properties" in schema.get("items", {}):
        return st.lists(allowed(schema["items"]), min_size=schema.get("minItems", 0), max_size=4)
    return st.sampled_from(schema.get("enum") or schema.get("examples") or ["a"])


@st.composite
def recipe_cases(draw: st.DrawFn) -> Case:
    """Draw a recipe and a command that reads it."""
    known = st.sampled_from(RECIPES)
    must, data = INPUT, draw((known | allowed(SCHEMA).map(toml_text)).flatmap(mutated))
    if draw(st.integers(0, 9)) == 0:
        # Nobody may accept a key that there is not.
        must, data = frozenset((2,)), b"no_such_key = 1\n" + draw(known).encode()
    name, *options = draw(st.sampled_from(READ_RECIPE)).split()
    # The code that examples name must not run unasked: it would leave a file behind.
    files = {"r.toml": data, "rover.py": b'open("it ran", "w")'}
    return Case((name, "r.toml", "--json", *options), files, must)


@st.composite
def urdf_cases(draw: st.DrawFn) -> Case:
    """Draw a description, its import, and a check of the recipe that this wrote."""
    parts = [link("base", 1.0, inside=draw(COLLISIONS))]
    for name in draw(st.lists(NAMES, max_size=6)):
        ends = draw(st.just("base") | NAMES), draw(st.just(name) | NAMES)
        parts.append(link(name, 0.3, draw(PLACES), draw(COLLISIONS)))
        parts.append(joint(f"{name}_joint", draw(JOINTS), *ends, draw(INSIDE), draw(PLACES)))
    files = {
        "r.urdf": draw(mutated(robot(*parts))),
        "mast.stl": draw(damaged(MESH) | st.just(MESH)),
    }
    words, then = ("import", "r.urdf", "-o", "out.toml"), ("check", "out.toml", "--json")
    return Case(words, files, frozenset((0, 2)), then)


@st.composite
def terrain_cases(draw: st.DrawFn) -> Case:
    """Draw a drive over a terrain that no robot has seen."""
    how = draw(st.sampled_from((["--no-control"], ["--method", "search"])))
    words = ("path", "r.toml", "--terrain", "t.csv", "--json", *how)
    recipe = draw(st.sampled_from(RECIPES[:2])).encode()
    return Case(words, {"r.toml": recipe, "t.csv": draw(mutated(TERRAIN))}, INPUT)


@cache
def swept() -> bytes:
    """Return the map of a recipe as the bytes of its file."""
    with tempfile.TemporaryDirectory() as scratch, tempfile.TemporaryDirectory(dir=scratch) as one:
        Path(one, "r.toml").write_text(RECIPES[0], "utf-8")
        ended(("sweep", "r.toml", "-o", "m.h5"), Path(one))
        return Path(one, "m.h5").read_bytes()


@st.composite
def edited(draw: st.DrawFn, data: bytes) -> bytes:
    """Draw a map in which an attribute or a dataset is another one."""
    memory = io.BytesIO(data)
    with h5py.File(memory, "r+") as file:
        places = [(owner.attrs, key) for owner in (file, file["sdg"]) for key in owner.attrs]
        place, key = draw(st.sampled_from(places) | st.just((file, "sdg")))
        kinds = (np.nan_to_num(file["sdg"][...]).astype(kind) for kind in (">f4", "i4", "S4", "c8"))
        values = st.sampled_from((*VALUES, *LINKS, *kinds) if place is file else VALUES)
        del place[key]
        place[key] = draw(values)
    return memory.getvalue()


@st.composite
def map_cases(draw: st.DrawFn) -> Case:
    """Draw a damaged map and a command that reads it."""
    if draw(st.integers(0, 3)) == 0:
        # Every byte of a sealed map is under its digest.
        data = draw(damaged(swept()).filter(lambda made: made != swept()))
        return Case(("info", "m.h5", "--verify"), {"m.h5": data}, frozenset((1, 2)))
    # HDF5 may edit a map without a digest.  Its own bytes, damaged, may crash it: not read so.
    sound = swept().replace(b"lutgen-digest-", b"Lutgen-digest-")
    words = draw(st.sampled_from((*READ_MAP, "limits m.h5 --json", "optimum m.h5 --method map")))
    made = edited(sound) if "--unsealed" in words else edited(sound) | damaged(sound)
    files = {"m.h5": draw(made), "other.h5": swept()}
    return Case(tuple(words.split()), files)


@st.composite
def command_cases(draw: st.DrawFn) -> Case:
    """Draw a command line of any command and option that there is."""
    name = draw(st.sampled_from(sorted(main.commands)))
    words = [name, *MORE.get(name, ())]
    for option in main.commands[name].params:
        kind, values = option.type, st.sampled_from(KNOWN) | WORDS
        if isinstance(kind, click.Choice):
            values = st.sampled_from([*map(str, kind.choices), "none of them"])
        elif isinstance(kind, click.Path):
            values = st.sampled_from(OUTPUTS if "output" in str(option.name) else PATHS)
        if isinstance(option, click.Argument):
            words.append(draw(st.just("r.toml") | st.sampled_from(PATHS)))
        elif not UNTRIED & set(option.opts) and (draw(st.integers(0, 4)) == 0 or option.required):
            words.append(draw(st.sampled_from(option.opts)))
            # No system hands a NUL over.
            words += [] if getattr(option, "is_flag", 0) else [draw(values).replace("\x00", "0")]
    return Case(tuple(words), {"r.toml": RECIPES[0].encode(), "m.h5": swept(), "t.csv": b"x,y,z"})


KINDS = {"recipe": recipe_cases(), "urdf": urdf_cases(), "terrain": terrain_cases()}
KINDS |= {"map": map_cases(), "command": command_cases()}
