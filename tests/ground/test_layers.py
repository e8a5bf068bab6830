"""Rooms along the way of the data: what may import what, and the size of files."""

import ast
import graphlib
import re
from pathlib import Path

import pytest

from tests.fixtures.places import ROOT

# A room sees only rooms before it.  Files of the ground floor are rooms of one file.
ORDER = {
    "lutgen": "errors _version bounds files cache interrupts jit vector rotation grid bracket "
    "chart parts quantities urdf recipe support channels mapping analysis search plot paper cli",
    "firmware_export": "quantity host truth protocol contacts grid verdict codecs emit "
    "certify choose exporter device control explore",
}
# Distinct imports from one room to another, and the longest chain of them, at most.
MOST_ARROWS = {"lutgen": 100, "firmware_export": 53}
MOST_LEVELS = {"lutgen": 11, "firmware_export": 9}
PACKAGES = tuple(ORDER)
# A package's own face and door are no rooms.
NO_ROOMS = ("__init__.py", "__main__.py")
FILES = sorted(
    path
    for package in PACKAGES
    for path in (ROOT / package).rglob("*.py")
    if path.parent.name != "runtime" and path not in [ROOT / package / name for name in NO_ROOMS]
)


def dotted(path: Path) -> str:
    """Return the name by which a file is imported."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def room_of(module: str) -> str:
    """Return the room that holds a module, with its package."""
    return ".".join(module.split(".")[:2])


def rooms(package: str) -> list[str]:
    """Return the rooms of a package, in order."""
    return [f"{package}.{name}" for name in ORDER[package].split()]


def imported(path: Path) -> set[tuple[str, str]]:
    """Return each (module, name) that a file imports of these packages, also inside functions."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports hide the room"
            found |= {(node.module or "", alias.name) for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {(alias.name, "") for alias in node.names}
    return {(module, name) for module, name in found if module.split(".")[0] in PACKAGES}


def arrows(package: str) -> set[tuple[str, str]]:
    """Return which room of a package imports which."""
    return {
        (room_of(dotted(path)), room_of(module))
        for path in FILES
        for module, _ in imported(path)
        if dotted(path).startswith(f"{package}.") and module.startswith(f"{package}.")
    } - {(room, room) for room in rooms(package)}


def exported(room: str) -> set[str]:
    """Return the names that a room's `__init__` gives to others."""
    tree = ast.parse((ROOT / room.replace(".", "/") / "__init__.py").read_text(encoding="utf-8"))
    names = [
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__"
    ]
    return set(*names)


def is_folder(room: str) -> bool:
    return (ROOT / room.replace(".", "/")).is_dir()


FOLDERS = [room for package in PACKAGES for room in rooms(package) if is_folder(room)]


@pytest.mark.parametrize("package", PACKAGES)
def test_every_room_has_its_place_in_the_order(package: str) -> None:
    there = {room_of(dotted(path)) for path in FILES if dotted(path).startswith(f"{package}.")}
    assert there == set(rooms(package))


@pytest.mark.parametrize("package", PACKAGES)
def test_a_room_sees_only_rooms_before_it(package: str) -> None:
    order = rooms(package)
    assert [(a, b) for a, b in arrows(package) if order.index(b) > order.index(a)] == []


@pytest.mark.parametrize("package", PACKAGES)
def test_there_are_few_imports_between_rooms_and_few_levels_of_them(package: str) -> None:
    found = arrows(package)
    above = {room: {b for a, b in found if a == room} for room in rooms(package)}
    level: dict[str, int] = {}
    for room in graphlib.TopologicalSorter(above).static_order():
        level[room] = 1 + max((level[other] for other in above[room]), default=0)
    assert len(found) <= MOST_ARROWS[package]
    assert max(level.values()) <= MOST_LEVELS[package]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_room_is_entered_by_its_door(path: Path) -> None:
    for module, name in imported(path):
        room = room_of(module)
        if room != room_of(dotted(path)) and module not in PACKAGES and is_folder(room):
            assert module == room, f"{name} comes from inside {room}"
            assert name in exported(room), f"{room} does not give {name}"


@pytest.mark.parametrize("room", FOLDERS)
def test_the_head_of_a_room_lists_its_files_in_reading_order(room: str) -> None:
    folder = ROOT / room.replace(".", "/")
    head = ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))) or ""
    listed = re.findall(r"`(\w+)`", head.partition("In reading order:")[2])
    files = {path.stem: path for path in folder.glob("*.py") if path.stem != "__init__"}
    assert sorted(listed) == sorted(files)
    for place, name in enumerate(listed):
        later = {f"{room}.{other}" for other in listed[place + 1 :]}
        assert not later & {module for module, _ in imported(files[name])}, name


@pytest.mark.parametrize("room", FOLDERS)
def test_no_file_of_a_room_is_called_like_a_name_that_the_room_gives(room: str) -> None:
    # Either would replace the other in the package.
    stems = {path.stem for path in (ROOT / room.replace(".", "/")).glob("*.py")}
    assert not stems & exported(room)


def test_the_reader_of_imports_finds_what_there_is() -> None:
    sweeper = {module for module, _ in imported(ROOT / "lutgen/mapping/sweeper.py")}
    assert {"lutgen.errors", "lutgen.mapping.part", "lutgen.recipe"} <= sweeper
    # Inside a function:
    assert ("lutgen.mapping", "sweep") in imported(ROOT / "lutgen/cli/sweep.py")


def roots(path: Path) -> set[str]:
    """Return the packages that a file imports at all."""
    return {
        name.split(".")[0]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in (
            [node.module or ""]
            if isinstance(node, ast.ImportFrom)
            else [alias.name for alias in node.names]
        )
    }


@pytest.mark.parametrize(
    ("library", "homes"),
    [
        ("matplotlib", {"lutgen.plot", "firmware_export.emit"}),
        ("click", {"lutgen.cli"}),
        ("h5py", {"lutgen.mapping"}),
        ("firmware_export", {"lutgen.cli"}),
        ("tests", set()),
    ],
)
def test_a_library_is_known_in_few_rooms(library: str, homes: set[str]) -> None:
    for path in FILES:
        room = room_of(dotted(path))
        own = library == "firmware_export" and room.startswith("firmware_export")
        assert own or library not in roots(path) or room in homes, path


def test_the_firmware_export_imports_neither_figures_nor_the_command_line() -> None:
    assert not {"lutgen.plot", "lutgen.cli", "lutgen.paper"} & {
        room_of(module)
        for path in FILES
        if dotted(path).startswith("firmware_export.")
        for module, _ in imported(path)
    }


def test_no_module_is_longer_than_400_lines() -> None:
    for path in FILES:
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 400, path


# What users call, most of it by keyword; nobody else has to name them all.
PUBLIC = {
    "lutgen.mapping.sweeper.sweep",
    "lutgen.search.driving.drive",
    "lutgen.search.optima.optimum",
    "firmware_export.exporter.export",
}


def test_no_function_has_more_than_seven_parameters_but_what_users_call_with_keywords() -> None:
    long = set()
    for path in FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
                given = node.args
                named = [one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
                if len([name for name in named if name not in ("self", "cls")]) > 7:
                    long.add(f"{dotted(path)}.{getattr(node, 'name', 'lambda')}")
    assert long == PUBLIC
