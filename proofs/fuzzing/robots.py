"""Recipes and URDFs: what the schema and a grammar allow, and what they do not."""

import copy
import json
import tomllib
from typing import Any

import trimesh
from click.testing import CliRunner
from hypothesis import strategies as st

from lutgen.cli import main
from proofs.fuzzing.run import Case
from proofs.fuzzing.values import ANYTHING, NAMES, SPY, TEXTS, damaged, recipes
from proofs.toml import Raw, toml_text

INPUT, REFUSED = frozenset((0, 2, 3)), frozenset((2,))
READ = ("check", "check", "eval", "limits", "metrics", "wheels -v 0.1,0", "optimum --levels 2")
FEW = {"allow_nan": False, "allow_infinity": False}

Tree = dict[str, Any]


def allowed(schema: Tree) -> st.SearchStrategy[Any]:
    """Return the values that a JSON schema allows by types, bounds and keys, rules left out."""
    if "enum" in schema:
        return st.sampled_from(schema["enum"])
    if "anyOf" in schema and "type" not in schema:
        return st.one_of(*map(allowed, schema["anyOf"]))
    low, high = schema.get("minimum", schema.get("exclusiveMinimum")), schema.get("maximum")
    match schema.get("type"):
        case "object":
            keys = {key: allowed(value) for key, value in schema.get("properties", {}).items()}
            need = {key: keys.pop(key) for key in schema.get("required", ()) if key in keys}
            return st.fixed_dictionaries(need, optional=keys)
        case "array":
            least = schema.get("minItems", 0)
            most = schema.get("maxItems", least + 3)
            return st.lists(allowed(schema.get("items", {})), min_size=least, max_size=most)
        case "integer":
            return st.integers(int(low or 0), 40)
        case "number":
            return st.floats(low, high, **FEW)  # type: ignore[arg-type]
        case "boolean":
            return st.booleans()
    return st.sampled_from(schema.get("examples") or ["a", "b"])


def places(value: Any) -> list[tuple[Any, Any]]:
    """Return every place of a document: a table and a key, or a list and an index."""
    found = []
    for key in value if isinstance(value, dict) else range(len(value)):
        found.append((value, key))
        if isinstance(value[key], dict | list):
            found += places(value[key])
    return found


@st.composite
def mutated(draw: st.DrawFn, tree: Tree) -> Tree:
    """Draw a document that is changed in up to three places."""
    tree = copy.deepcopy(tree)
    for _ in range(draw(st.integers(0, 3))):
        if not (spots := places(tree)):
            break
        table, key = draw(st.sampled_from(spots))
        other, there = draw(st.sampled_from(spots))
        match draw(st.sampled_from(("value", "value", "drop", "other", "rename", "many", "deep"))):
            case "value":
                table[key] = draw(ANYTHING)
            case "drop":
                del table[key]
            case "other":  # names that are there make cycles of links
                table[key] = copy.deepcopy(other[there])
            case "rename" if isinstance(table, dict):
                table[draw(st.sampled_from(NAMES))] = table.pop(key)
            case "many" if isinstance(table[key], list):
                table[key] = table[key] * draw(st.sampled_from((0, 2, 30, 300)))
            case "deep":
                open_, close = draw(st.sampled_from((("[", "]"), ("{ a = ", " }"), ("[[", ""))))
                depth = draw(st.sampled_from((20, 5000, 100_000)))
                table[key] = Raw(open_ * depth + "1" + close * depth)
    return tree


SCHEMA = json.loads(CliRunner().invoke(main, ["schema"]).stdout)


@st.composite
def recipe_cases(draw: st.DrawFn) -> Case:
    """Draw a recipe, sound or not, and a command that reads it."""
    known = [tomllib.loads(text) for text in recipes().values()]
    tree = draw(st.one_of(*map(mutated, known), allowed(SCHEMA).flatmap(mutated)))
    must = INPUT
    if draw(st.integers(0, 9)) == 0:
        # Nobody may accept a key that there is not.
        tree, must = copy.deepcopy(draw(st.sampled_from(known))) | {"no_such_key": 1}, REFUSED
    data = toml_text(tree).encode("utf-8", "replace")
    if must is INPUT and draw(st.integers(0, 9)) == 0:
        data = draw(damaged(data))
    name, *options = draw(st.sampled_from(READ)).split()
    return Case((name, "r.toml", "--json", *options), {"r.toml": data, "spy.py": SPY}, must)


MESH = bytes(trimesh.creation.box((0.1, 0.1, 0.3)).export(file_type="stl"))
ENTITIES = (
    '<!DOCTYPE r [<!ENTITY j "jjjjjjjjjj"><!ENTITY f "&j;&j;&j;&j;&j;&j;&j;&j;&j;&j;">]>',
    '<!DOCTYPE r [<!ENTITY j SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE r SYSTEM "http://127.0.0.1:1/x.dtd">',
)
LINKS = st.sampled_from(("base", "a", "b", "c", "wheel", *NAMES[:6]))
JOINTS = ("revolute", "fixed", "continuous", "prismatic", "floating", "planar", "ball")
FILES = ("mast.stl", "mast.stl", "../../etc/passwd", "/dev/zero", "package://x/y.stl", "r.urdf", "")
LENGTH = st.sampled_from(("0.1", "0.3", "0.05")) | TEXTS


@st.composite
def element(draw: st.DrawFn, /, tag: str, inside: str = "", **attributes: Any) -> str:
    """Draw an element whose attributes are drawn; now and then one is missing."""
    text = "".join(
        f" {name}={json.dumps(draw(value)).replace('&', '').replace('<', '')}"
        for name, value in attributes.items()
        if draw(st.integers(0, 19))
    )
    return f"<{tag}{text}>{inside}</{tag}>"


@st.composite
def link(draw: st.DrawFn, name: str) -> str:
    """Draw a link with a mass and up to three shapes."""
    three = st.tuples(LENGTH, LENGTH, LENGTH).map(" ".join)
    mass = draw(element("mass", value=LENGTH))
    origin = element("origin", xyz=three, rpy=st.just("0 0 0") | three)
    shapes = st.one_of(
        element("box", size=three),
        element("sphere", radius=LENGTH),
        element("cylinder", radius=LENGTH, length=LENGTH),
        element("mesh", filename=st.sampled_from(FILES), scale=three),
    )
    parts = f"<inertial>{draw(origin)}{mass}</inertial>"
    for shape in draw(st.lists(shapes, max_size=3)):
        parts += f"<collision>{draw(origin)}<geometry>{shape}</geometry></collision>"
    return draw(element("link", parts, name=st.just(name)))


@st.composite
def joint(draw: st.DrawFn, name: str) -> str:
    """Draw a joint, mostly to the link of its own name."""
    three = st.sampled_from(("0 1 0", "0.3 0.2 -0.1", "-0.3 -0.2 -0.1"))
    parts = draw(element("parent", link=st.just("base") | LINKS))
    parts += draw(element("child", link=st.just(name) | LINKS))
    parts += draw(element("origin", xyz=three)) + draw(element("axis", xyz=three))
    parts += draw(element("limit", lower=st.just("-1") | TEXTS, upper=st.just("1") | TEXTS))
    parts += draw(st.just("") | element("mimic", joint=LINKS, multiplier=TEXTS))
    return draw(
        element("joint", parts, name=st.just(f"{name}_joint"), type=st.sampled_from(JOINTS))
    )


@st.composite
def urdf_cases(draw: st.DrawFn) -> Case:
    """Draw a description, its import, and a check of the recipe that this wrote."""
    names = draw(st.lists(LINKS, max_size=6))
    text = draw(link("base")) + "".join(draw(link(name)) + draw(joint(name)) for name in names)
    text = f'<robot name="crane">{text}</robot>'
    if draw(st.integers(0, 19)) == 0:
        text = draw(st.sampled_from(ENTITIES)) + text.replace("</link>", "&j;&f;</link>", 1)
    data, mesh = text.encode("utf-8", "replace"), MESH
    if draw(st.integers(0, 9)) == 0:
        data = draw(damaged(data))
    if draw(st.integers(0, 4)) == 0:
        mesh = draw(damaged(MESH))
    words = ("import", "r.urdf", "-o", "out.toml")
    then = ("check", "out.toml", "--json")
    files = {"r.urdf": data, "mast.stl": mesh}
    return Case(words, files, frozenset((0, 2)), ("out.toml",), then)
