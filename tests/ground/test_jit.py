"""The project's decorator: flags, cache and its staleness, and life without a compiler."""

import ast
import functools
import gc
import os
import re
import shutil
import subprocess
import sys

import numba
import numpy as np
import pytest

from lutgen.jit import in_threads, njit
from tests.fixtures.places import ROOT

CALLER = (
    "from lutgen.jit import njit\n"
    "from house.far.codec import inner\n"
    "@njit()\n"
    "def outer(x):\n"
    "    return 10.0 * inner(x)\n"
)
CALLEE = "from lutgen.jit import njit\n@njit()\ndef inner(x):\n    return x + {}\n"
OUTER = (
    "import sys; from pathlib import Path; import lutgen.jit as jit;"
    "jit._PACKAGES += (Path('house').resolve(),);"
    "from house.near.codec import outer; print(outer(1.0), sum(outer.stats.cache_hits.values()))"
)


@pytest.fixture
def house(tmp_path):
    """Write a package with a caller and a callee in files of the same name, in two rooms."""
    for room in ("", "near", "far"):
        (tmp_path / "house" / room).mkdir()
        (tmp_path / "house" / room / "__init__.py").write_text("")
    (tmp_path / "house" / "near" / "codec.py").write_text(CALLER)
    (tmp_path / "house" / "far" / "codec.py").write_text(CALLEE.format(1))
    return tmp_path / "house"


def run(folder, code, **variables):
    """Run Python in another process in a folder, with the project on the path."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")}
    environment |= {"PYTHONPATH": f".{os.pathsep}{ROOT}", "XDG_CACHE_HOME": "cache"}
    # Sources of one test are written within the same second: no stale byte code either.
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**environment, **{k: str(v) for k, v in variables.items()}},
        cwd=folder,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()


def test_machine_code_is_kept_until_a_file_with_kernels_changes(house, tmp_path):
    cache = tmp_path / "cache"
    (tmp_path / "copy").mkdir()
    shutil.copytree(house, tmp_path / "copy" / "house")
    (house / "notes.py").write_text("x = 1\n")
    code = f"import sys; sys.stderr = sys.stdout; {OUTER}; print(outer(1))"
    told = [run(place, code, XDG_CACHE_HOME=cache) for place in (tmp_path, tmp_path / "copy")]
    # One line says that kernels are compiled, and only the first time.
    assert re.sub("compiling.*", "compiling", told[0]) == "compiling\n20.0 0\n20.0"
    assert told[1] == "20.0 1\n20.0"
    (house / "notes.py").write_text("x = 2\n")
    assert run(tmp_path, OUTER, XDG_CACHE_HOME=cache) == "20.0 1"
    (house / "far" / "codec.py").write_text(CALLEE.format(2))
    assert run(tmp_path, OUTER, XDG_CACHE_HOME=cache) == "30.0 0"
    assert len(list((cache / "lutgen").iterdir())) == 2


def test_what_is_cut_short_in_the_folder_of_numba_s_own_variable_is_compiled_anew(house, tmp_path):
    chosen, user = tmp_path / "chosen", tmp_path / "user"
    folders = {"NUMBA_CACHE_DIR": chosen, "XDG_CACHE_HOME": user}
    assert run(tmp_path, OUTER, **folders) == "20.0 0"
    assert not user.exists()
    for suffix, share in ((".nbi", 0), (".nbc", 2)):
        assert list(chosen.rglob(f"*{suffix}"))
        for path in chosen.rglob(f"*{suffix}"):
            kept = path.read_bytes()
            path.write_bytes(kept[: len(kept) // share] if share else b"")
        assert run(tmp_path, OUTER, **folders).startswith("20.0")
    assert run(tmp_path, OUTER, **folders) == "20.0 1"


def test_a_folder_that_cannot_be_written_costs_time_and_nothing_else(house, tmp_path):
    # A file where the folder should be stops even the superuser.
    (tmp_path / "blocked").write_text("")
    warnings = f"import warnings; warnings.simplefilter('error'); {OUTER}"
    assert run(tmp_path, warnings, XDG_CACHE_HOME=tmp_path / "blocked") == "20.0 0"
    assert not list(tmp_path.rglob("*.nbi"))


# What marks a file whose bytes the cache's digest covers, see `lutgen.jit`.
MARK = "lutgen.jit"
# Imports of a file with kernels that only its plain Python needs.
PLAIN = {"TOLERANCE"}


@functools.cache
def imported(path):
    """Return what a file imports, each name with its module and its name there."""
    found = {}
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.ImportFrom) and node.module.split(".")[0] in PACKAGES:
            found |= {one.asname or one.name: (node.module, one.name) for one in node.names}
    return found


def origin(path, name):
    """Return the file in which a name is defined that another file imports."""
    while name in imported(path):
        module, name = imported(path)[name]
        place = ROOT.joinpath(*module.split("."))
        path = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    return path


PACKAGES = ("lutgen", "firmware_export")


def test_every_constant_of_a_file_with_kernels_is_in_a_file_that_the_digest_covers():
    sources = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
    marked = {path for path in sources if MARK in path.read_text()}
    assert len(marked) > 20
    unseen = {
        f"{path.name} reads {name}"
        for path in marked
        for name in imported(path)
        if name.isupper() and name not in PLAIN and origin(path, name) not in marked
    }
    assert unseen == set()


def test_work_is_shared_among_threads():
    before = numba.get_num_threads()
    done = np.zeros(1000)

    def fill(span, memory, out):
        assert not memory, "a part has a memory of its own"
        memory.append(span)
        out[slice(*span)] += 1.0

    try:
        for threads in range(1, numba.config.NUMBA_NUM_THREADS + 1):
            numba.set_num_threads(threads)
            done[:] = 0.0
            in_threads(fill, 1000, list, done, least=100)
            assert (done == 1.0).all()
        in_threads(fill, 0, list, done)
        assert (done == 1.0).all()
    finally:
        numba.set_num_threads(before)


def test_an_error_in_a_thread_is_raised_where_the_work_was_asked_for():
    def fail(span, memory):
        raise ValueError(f"{span[0]} to {span[1]}")

    with pytest.raises(ValueError, match="0 to"):
        in_threads(fail, 1000, list)


def test_kernels_run_as_plain_python_when_the_compiler_is_switched_off(tmp_path):
    code = "from lutgen.vector import dot; print(dot((1, 2, 3), (4, 5, 6)), type(dot).__name__)"
    assert run(tmp_path, code, NUMBA_DISABLE_JIT=1) == "32 function"


@njit()
def strict(x, y, values):
    """Return what freedoms of a compiler alter: a quotient, whether it is NaN, and a sum."""
    total, ratio = 0.0, x / y
    for i in range(values.size):
        total += values[i]
    return ratio, ratio != ratio, total


def test_kernels_divide_by_zero_keep_nan_and_add_in_the_order_of_the_source():
    values = np.tile([1e16, 1.0, -1e16], 100)
    assert strict(1.0, 0.0, values) == (np.inf, False, sum(values.tolist()))
    assert strict(0.0, 0.0, values)[1]
    assert strict.targetoptions["nogil"]


def test_garbage_is_collected_again_after_compiling_fails():
    with pytest.raises(numba.TypingError):
        strict("one", 1.0, None)
    assert gc.isenabled()
