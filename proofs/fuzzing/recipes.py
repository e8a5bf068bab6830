"""Recipes (and stances) with keys dropped, doubled and renamed, and with hostile values.

A document is changed as a tree, so that what comes out is TOML that means something, and then
now and then as text.
"""

import copy
import json
import random
import tomllib
from collections.abc import Callable, Iterator
from typing import Any

from proofs.fuzzing import hostile
from proofs.fuzzing.case import Case
from proofs.fuzzing.hostile import pick
from proofs.fuzzing.seeds import SPY, STANCE, recipes
from proofs.toml import Raw, toml_text

__all__ = ["make", "mutated"]

Place = tuple[Any, Any]  # a table and a key of it, or a list and a place in it
INPUT = frozenset((0, 2, 3))
REFUSED = frozenset((2,))


def places(value: Any) -> Iterator[Place]:
    """Return every place of a document."""
    keys = value.keys() if isinstance(value, dict) else range(len(value))
    for key in list(keys):
        yield value, key
        if isinstance(value[key], dict | list):
            yield from places(value[key])


def _of(tree: dict[str, Any], *kinds: type) -> list[Place]:
    return [place for place in places(tree) if type(place[0][place[1]]) in kinds]


def _drop(rng: random.Random, tree: dict[str, Any]) -> None:
    table, key = pick(rng, list(places(tree)))
    del table[key]


def _value(rng: random.Random, tree: dict[str, Any]) -> None:
    table, key = pick(rng, list(places(tree)))
    table[key] = hostile.anything(rng)


def _number(rng: random.Random, tree: dict[str, Any]) -> None:
    found = _of(tree, int, float)
    if found:
        table, key = pick(rng, found)
        old = float(table[key])
        table[key] = hostile.number(rng) if rng.random() < 0.5 else hostile.scaled(rng, old)


def _name(rng: random.Random, tree: dict[str, Any]) -> None:
    found = _of(tree, str)
    if found:
        table, key = pick(rng, found)
        # Names that are there make cycles of links, and things that are there twice.
        there = pick(rng, found)
        table[key] = pick(rng, hostile.NAMES) if rng.random() < 0.5 else there[0][there[1]]


def _rename(rng: random.Random, tree: dict[str, Any]) -> None:
    found = [(table, key) for table, key in places(tree) if isinstance(table, dict)]
    table, key = pick(rng, found)
    table[key[1:] + key[:1] if rng.random() < 0.5 else pick(rng, hostile.NAMES)] = table.pop(key)


def _swap(rng: random.Random, tree: dict[str, Any]) -> None:
    (one, i), (other, k) = (pick(rng, list(places(tree))) for _ in range(2))
    first, second = copy.deepcopy(one[i]), copy.deepcopy(other[k])
    one[i], other[k] = second, first


def _list(rng: random.Random, tree: dict[str, Any]) -> None:
    found = _of(tree, list)
    if found:
        table, key = pick(rng, found)
        many = pick(rng, (0, 1, 2, 2, 3, 30, 300)) if len(table[key]) < 100 else 1
        table[key] = copy.deepcopy(table[key]) * many
        rng.shuffle(table[key])


def _chain(rng: random.Random, tree: dict[str, Any]) -> None:
    """Put many links, contacts or forces, each on the one before it."""
    robot = tree.get("robot")
    what = pick(rng, ("link", "contact", "payload", "force", "parameter", "wheel"))
    rows = robot.get(what) if isinstance(robot, dict) else None
    if isinstance(rows, list) and rows and isinstance(rows[0], dict):
        count = pick(rng, (3, 20, 120, 1500))
        names = [f"many{i}" for i in range(count)]
        for name, before in zip(names, ["body", *names], strict=False):
            row = copy.deepcopy(rows[0])
            row.update({"name": name} | ({"parent": before} if what == "link" else {}))
            rows.append(row)


def _deep(rng: random.Random, tree: dict[str, Any]) -> None:
    table, key = pick(rng, list(places(tree)))
    depth = pick(rng, (20, 500, 5000, 100_000))
    how = rng.randrange(3)
    open_, close = (("[", "]"), ("{ a = ", " }"), ("[[", ""))[how]
    table[key] = Raw(open_ * depth + "1" + close * depth)


CHANGES: tuple[Callable[[random.Random, dict[str, Any]], None], ...] = (
    *(_drop, _value, _value, _number, _number, _number, _number, _name, _name, _rename, _swap),
    *(_list, _chain),
)


def mutated(rng: random.Random, text: str, most: int = 3) -> tuple[str, str]:
    """Return a recipe with up to so many changes, and what was changed."""
    tree = tomllib.loads(text)
    done = []
    for _ in range(rng.randrange(1, most + 1)):
        change = pick(rng, CHANGES) if rng.random() < 0.97 else _deep
        done.append(change.__name__.strip("_"))
        if not tree:
            break
        change(rng, tree)
    text = toml_text(tree)
    how = rng.random()
    if how < 0.06:
        done.append("bytes")
        damaged = hostile.damaged(rng, text.encode("utf-8", "surrogatepass"))
        return damaged.decode("utf-8", "surrogateescape"), " ".join(done)
    if how < 0.08:
        done.append("line")
        lines = text.splitlines()
        lines.insert(0, pick(rng, lines) if lines else "=")
        text = "\n".join(lines)
    return text, " ".join(done)


def surely_wrong(rng: random.Random, text: str) -> tuple[str, str]:
    """Return a recipe that nobody may accept: a key that there is not, or a number that is none."""
    tree = tomllib.loads(text)
    if rng.random() < 0.5:
        # `home` and `samples` are keyed by names of parameters, which would be unknown, too.
        table = pick(rng, [table for table, _ in places(tree) if isinstance(table, dict)])
        table["no_such_key"] = 1
        return toml_text(tree), "unknown key"
    table, key = pick(rng, _of(tree, int, float))
    table[key] = float(pick(rng, ("nan", "inf", "-inf")))
    return toml_text(tree), "not finite"


def _words(rng: random.Random, names: list[str]) -> tuple[str, ...]:
    down = ",".join(f"{rng.uniform(-1, 1):.3g}" for _ in range(3))
    chosen = [
        ("check", "r.toml", "--json"),
        ("check", "r.toml", "--json"),
        ("check", "r.toml"),
        ("eval", "r.toml", "--json", "-g", down),
        ("limits", "r.toml", "--json"),
        ("metrics", "r.toml", "--json"),
        ("wheels", "r.toml", "--json", "-v", "0.1,0"),
        ("optimum", "r.toml", "--json", "--levels", "2", "-g", down),
    ]
    words: tuple[str, ...] = pick(rng, chosen)
    if names and words[0] == "eval":
        words += ("-p", f"{pick(rng, names)}={hostile.text_number(rng)}")
    return words


def make(rng: random.Random) -> Case:
    """Return a case of a recipe, one time in twelve of a stance."""
    if rng.random() < 1 / 12:
        text, label = mutated(rng, STANCE)
        words: tuple[str, ...] = ("stance", "r.toml", "--json")
        return Case(label, {"r.toml": text.encode("utf-8", "surrogateescape")}, words, INPUT)
    name = pick(rng, list(recipes()))
    seed = recipes()[name]
    wrong = rng.random() < 0.1
    text, label = surely_wrong(rng, seed) if wrong else mutated(rng, seed)
    names = [p["name"] for p in tomllib.loads(seed)["robot"].get("parameter", ())]
    files = {"r.toml": text.encode("utf-8", "surrogateescape"), "spy.py": SPY}
    words = _words(rng, names)
    if rng.random() < 0.01:
        code = f"python = {json.dumps('spy.py:contacts')}\n"
        files["r.toml"] = files["r.toml"].replace(b"\n[[robot.link]]", f"\n{code}".encode(), 1)
    return Case(f"{name}: {label}", files, words, REFUSED if wrong else INPUT)
