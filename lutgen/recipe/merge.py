"""Bring an edited recipe up to date with the robot description that it came from."""

import tomllib
from typing import Any

from lutgen.errors import optional
from lutgen.recipe.recipe import parse_recipe

# Keys that a description sets in a link wherever it hangs, and those of its place.
OWN, PLACED = ("mass", "com"), ("origin", "rpy")
OF_JOINT = ("type", "axis")


def merged_recipe(text: str, source: str, fresh: str) -> tuple[str, tuple[str, ...]]:
    """Write what a description says of its links into a recipe, which keeps all else.

    `text` is the recipe, edited by hand, and `fresh` the one that the description alone gives.
    Mass, com, origin and rpy of each link become the latter's, and type and axis of its joint; a
    link that is fixed in one and moves in the other keeps its place and joint.  Returned with the
    new text is a sentence for each value that was changed, and for each link that only one of them
    has, which stays as it is.  RecipeError is raised where the recipe is bad, before or after.
    """
    parse_recipe(text, source)
    tomlkit = optional(source, "tomlkit", "lutgen[merge]", "write another file")
    document = tomlkit.parse(text)
    wanted = {link["name"]: link for link in tomllib.loads(fresh)["robot"].get("link", [])}
    changes: list[str] = []
    there = set()
    for link in document["robot"].get("link", []):
        name = str(link["name"])
        there.add(name)
        if name in wanted:
            changes += _bring(link, wanted[name])
        else:
            changes.append(f"link {name}: is not in what was imported, stays")
    new = [name for name in wanted if name not in there]
    changes += [f"link {name}: is in what was imported only, left out" for name in new]
    result = tomlkit.dumps(document)
    parse_recipe(result, source)
    return result, tuple(changes)


def _bring(link: Any, wanted: dict[str, Any]) -> list[str]:
    moves = link.get("joint", {}).get("type", "none") != "none"
    same_kind = moves == ("joint" in wanted)
    changes = _copy(link, wanted, (*OWN, *PLACED) if same_kind else OWN, f"link {link['name']}")
    if not same_kind:
        kind = "moves in the description" if "joint" in wanted else "is fixed in the description"
        changes.append(f"link {link['name']}: {kind}, stays as it is")
    elif moves:
        changes += _copy(link["joint"], wanted["joint"], OF_JOINT, f"joint of {link['name']}")
    return changes


def _copy(table: Any, wanted: dict[str, Any], keys: tuple[str, ...], what: str) -> list[str]:
    """Write values that differ; one that `wanted` does not have stays."""
    changes = []
    for key in keys:
        if key in wanted and table.get(key) != wanted[key]:
            changes.append(f"{what}: {key} was {table.get(key, 'not given')}, is {wanted[key]}")
            table[key] = wanted[key]
    return changes
