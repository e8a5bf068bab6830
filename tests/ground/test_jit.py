"""The project's decorator: flags, cache and its staleness, and life without a compiler."""

import ast
import functools
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

from lutgen.jit import cache_folder, in_threads, njit, prange
from tests.fixtures.places import ROOT

CALLEE = "from lutgen.jit import njit\n@njit()\ndef inner(x):\n    return x + {}\n"
CALLER = (
    "from lutgen.jit import njit\n"
    "from callee import inner\n"
    "@njit()\n"
    "def outer(x):\n"
    "    return 10.0 * inner(x)\n"
)


def run(folder, code, **variables):
    """Run Python in another process with `folder` and the project on the path."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")}
    environment["PYTHONPATH"] = os.pathsep.join([str(folder), str(ROOT)])
    # Sources of one test are written within the same second: no stale byte code either.
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**environment, **{k: str(v) for k, v in variables.items()}},
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()


OUTER = "from caller import outer; print(outer(1.0), sum(outer.stats.cache_hits.values()))"


def test_an_edited_callee_in_another_file_is_not_served_from_the_old_cache(tmp_path):
    (tmp_path / "caller.py").write_text(CALLER)
    (tmp_path / "callee.py").write_text(CALLEE.format(1))
    cache = tmp_path / "cache"
    assert run(tmp_path, OUTER, XDG_CACHE_HOME=cache) == "20.0 0"
    assert run(tmp_path, OUTER, XDG_CACHE_HOME=cache) == "20.0 1"
    (tmp_path / "callee.py").write_text(CALLEE.format(2))
    assert run(tmp_path, OUTER, XDG_CACHE_HOME=cache) == "30.0 0"
    assert sorted(path.name for path in cache.iterdir()) == ["lutgen"]
    assert len(list((cache / "lutgen").iterdir())) == 2


def test_what_is_loaded_from_the_cache_needs_nothing_that_only_compiling_needs(tmp_path):
    (tmp_path / "caller.py").write_text(CALLER)
    (tmp_path / "callee.py").write_text(CALLEE.format(1))
    tell = "import sys; print(outer(1.0), 'scipy.linalg' in sys.modules)"
    code = f"from caller import outer; {tell}"
    assert run(tmp_path, code, XDG_CACHE_HOME=tmp_path / "cache") == "20.0 True"
    assert run(tmp_path, code, XDG_CACHE_HOME=tmp_path / "cache") == "20.0 False"
    # What is not in the cache is compiled in the same process.
    code = f"{code}; print(outer(1), 'scipy.linalg' in sys.modules)"
    found = run(tmp_path, code, XDG_CACHE_HOME=tmp_path / "cache")
    assert found == "20.0 False\n20.0 True"


def test_a_file_without_kernels_does_not_cost_a_compilation(tmp_path):
    (tmp_path / "caller.py").write_text(CALLER)
    (tmp_path / "callee.py").write_text(CALLEE.format(1))
    assert run(tmp_path, OUTER, XDG_CACHE_HOME=tmp_path / "cache") == "20.0 0"
    (tmp_path / "notes.py").write_text("x = 1\n")
    assert run(tmp_path, OUTER, XDG_CACHE_HOME=tmp_path / "cache") == "20.0 1"


def two_rooms(folder):
    """Write a package with a caller and a callee in files of the same name, in two rooms."""
    package = folder / "house"
    for room in ("", "near", "far"):
        (package / room).mkdir()
        (package / room / "__init__.py").write_text("")
    near = CALLER.replace("from callee import inner", "from house.far.codec import inner")
    (package / "near" / "codec.py").write_text(near)
    (package / "far" / "codec.py").write_text(CALLEE.format(1))
    return package


def test_a_callee_edited_in_another_room_is_not_served_from_the_old_cache(tmp_path):
    package = two_rooms(tmp_path)
    outer = OUTER.replace("from caller import", "from house.near.codec import")
    cache = tmp_path / "cache"
    assert run(tmp_path, outer, XDG_CACHE_HOME=cache) == "20.0 0"
    assert run(tmp_path, outer, XDG_CACHE_HOME=cache) == "20.0 1"
    (package / "far" / "codec.py").write_text(CALLEE.format(2))
    assert run(tmp_path, outer, XDG_CACHE_HOME=cache) == "30.0 0"


def test_files_of_one_name_in_two_rooms_count_each(tmp_path):
    package = two_rooms(tmp_path)
    code = f"from lutgen.jit import cache_folder; print(cache_folder({str(package / 'near')!r}))"
    folders = [run(tmp_path, code, XDG_CACHE_HOME=tmp_path / "cache")]
    for room in ("far", "near"):
        path = package / room / "codec.py"
        path.write_text(path.read_text() + "# edited\n")
        folders.append(run(tmp_path, code, XDG_CACHE_HOME=tmp_path / "cache"))
    assert len(set(folders)) == 3


def test_equal_sources_of_ours_share_what_was_compiled_wherever_they_are(tmp_path):
    for place in ("one", "two", "else"):
        (tmp_path / place).mkdir()
        two_rooms(tmp_path / place)
    outer = OUTER.replace("from caller import", "from house.near.codec import")
    ours = "import lutgen.jit as jit; jit._OURS += ('house',); " + outer
    cache = tmp_path / "cache"
    assert run(tmp_path / "one", ours, XDG_CACHE_HOME=cache) == "20.0 0"
    assert run(tmp_path / "two", ours, XDG_CACHE_HOME=cache) == "20.0 1"
    # What somebody else's kernels read may be in files that no digest covers.
    assert run(tmp_path / "else", outer, XDG_CACHE_HOME=cache) == "20.0 0"
    # Another text is another kernel.
    path = tmp_path / "two" / "house" / "far" / "codec.py"
    path.write_text(CALLEE.format(2))
    assert run(tmp_path / "two", ours, XDG_CACHE_HOME=cache) == "30.0 0"


# What marks a file whose bytes the cache's digest covers, see `lutgen.jit`.
MARK = "lutgen.jit"


@functools.cache
def parsed(path):
    """Return the module-level definitions and imports of a file, and what its kernels read."""
    defined, imported, read = {}, {}, set()
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.ImportFrom):
            imported |= {one.asname or one.name: (node.module, one.name) for one in node.names}
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
            defined |= dict.fromkeys(names, names_in([node.value] if node.value else []))
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            defined[node.name] = set()
            if any("njit" in ast.unparse(one) for one in node.decorator_list):
                read |= names_in(node.body)
    return defined, imported, read


def names_in(nodes):
    """Return the names that are read below some nodes."""
    every = (n for node in nodes for n in ast.walk(node))
    return {n.id for n in every if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}


def unseen(root, package):
    """Return what kernels of a package read from files that the cache's digest does not cover."""
    found = []
    for path in sorted((root / package).rglob("*.py")):
        if MARK not in path.read_text():
            continue
        waiting = [(path, name) for name in sorted(parsed(path)[2])]
        followed = set()
        while waiting:
            place = waiting.pop()
            if place in followed:
                continue
            followed.add(place)
            where, name = place
            defined, imported, _ = parsed(where)
            if name in defined:
                waiting += [(where, value) for value in defined[name]]
                if MARK not in where.read_text():
                    found.append(f"{path.relative_to(root)} reads {name}")
            elif name in imported and imported[name][0].split(".")[0] in PACKAGES:
                module, original = imported[name]
                target = root.joinpath(*module.split("."))
                target = target / "__init__.py" if target.is_dir() else target.with_suffix(".py")
                waiting.append((target, original))
    return found


PACKAGES = {"lutgen", "firmware_export", "benchmarks", "house"}


@pytest.mark.parametrize("package", sorted(PACKAGES - {"house"}))
def test_all_that_a_kernel_reads_is_in_files_that_the_cache_s_digest_covers(package):
    assert unseen(ROOT, package) == []


def test_a_constant_from_a_file_without_kernels_would_be_found(tmp_path):
    package = two_rooms(tmp_path)
    (package / "numbers.py").write_text("STEP = 2\n")
    path = package / "near" / "codec.py"
    text = "from house.numbers import STEP\nHALF = STEP / 2\n" + path.read_text()
    path.write_text(text.replace("10.0 *", "HALF *"))
    assert unseen(tmp_path, "house") == ["house/near/codec.py reads STEP"]


def test_work_is_shared_among_threads():
    before = numba.get_num_threads()
    done = np.zeros(1000)

    def fill(begin, end, out):
        out[begin:end] += 1.0

    try:
        for threads in range(1, numba.config.NUMBA_NUM_THREADS + 1):
            numba.set_num_threads(threads)
            done[:] = 0.0
            in_threads(fill, 1000, done, least=100)
            assert (done == 1.0).all()
        in_threads(fill, 0, done)
        assert (done == 1.0).all()
    finally:
        numba.set_num_threads(before)


def test_an_error_in_a_thread_is_raised_where_the_work_was_asked_for():
    def fail(begin, end):
        raise ValueError(f"{begin} to {end}")

    with pytest.raises(ValueError, match="0 to"):
        in_threads(fail, 1000)


COUNTER = (
    "from lutgen.jit import njit\n"
    "@njit()\n"
    "def one_more(k):\n"
    "    return k + 1\n"
    "@njit()\n"
    "def steps(n):\n"
    "    k = 0\n"
    "    while k < n:\n"
    "        k = one_more(k)\n"
    "    return k\n"
)


def test_a_counter_that_starts_at_a_literal_compiles_its_callee_once(tmp_path):
    (tmp_path / "counter.py").write_text(COUNTER)
    # A cache of its own: what is loaded from one says nothing about callees.
    code = "from counter import *; print(steps(3), len(one_more.called.signatures))"
    assert run(tmp_path, code, XDG_CACHE_HOME=tmp_path / "cache") == "3 1"


def test_shared_machine_code_is_found_by_all_that_calls_it(tmp_path):
    """Also where its entry in the cache was lost, and it goes by another name."""
    callee = "import math\n" + CALLEE.replace("x + {}", "math.sqrt(x) + {}")
    (tmp_path / "caller.py").write_text(CALLER)
    (tmp_path / "callee.py").write_text(callee.format(1).replace("()", "(shared=True)", 1))
    cache = tmp_path / "cache"
    told = [run(tmp_path, OUTER, XDG_CACHE_HOME=cache, PYTHONHASHSEED=1) for _ in range(2)]
    for path in cache.rglob("*.shared.nbi"):
        path.unlink()
    told += [run(tmp_path, OUTER, XDG_CACHE_HOME=cache, PYTHONHASHSEED=2) for _ in range(2)]
    assert told == ["20.0 0", "20.0 1", "20.0 0", "20.0 1"]


def test_the_cache_goes_where_numba_s_own_variable_says(tmp_path):
    (tmp_path / "caller.py").write_text(CALLER)
    (tmp_path / "callee.py").write_text(CALLEE.format(1))
    chosen, user = tmp_path / "chosen", tmp_path / "user"
    assert run(tmp_path, OUTER, NUMBA_CACHE_DIR=chosen, XDG_CACHE_HOME=user) == "20.0 0"
    assert list(chosen.rglob("*.nbi"))
    assert not user.exists()


def test_a_cache_that_cannot_be_written_costs_time_and_nothing_else(tmp_path):
    (tmp_path / "caller.py").write_text(CALLER)
    (tmp_path / "callee.py").write_text(CALLEE.format(1))
    # A file where the folder should be stops even the superuser.
    (tmp_path / "blocked").write_text("")
    warnings = f"import warnings; warnings.simplefilter('error'); {OUTER}"
    for _ in range(2):
        assert run(tmp_path, warnings, XDG_CACHE_HOME=tmp_path / "blocked") == "20.0 0"
    assert not list(tmp_path.rglob("*.nbi"))


def test_kernels_run_as_plain_python_when_the_compiler_is_switched_off(tmp_path):
    code = (
        "from lutgen.jit import njit, prange\n"
        "@njit(parallel=True)\n"
        "def total(n):\n"
        "    s = 0\n"
        "    for i in prange(n):\n"
        "        s += i\n"
        "    return s\n"
        "print(total(5), type(total).__name__)"
    )
    assert run(tmp_path, code, NUMBA_DISABLE_JIT=1) == "10 function"


def test_numba_s_setting_is_put_back_after_decorating():
    before = numba.config.CACHE_DIR
    njit()(len_of)
    assert before == numba.config.CACHE_DIR


def len_of(x):
    """Return a length; decorated by a test."""
    return len(x)


@njit()
def ratio(x, y):
    """Divide without Python's exception."""
    return x / y


@njit()
def is_nan(x):
    """Compare in the way that an assumption of no NaN would remove."""
    return x != x


@njit()
def cancelling(values):
    """Add in order: any other order gives another result."""
    total = 0.0
    for i in range(values.size):
        total += values[i]
    return total


@njit(parallel=True)
def squares(out):
    """Fill in several threads."""
    for i in prange(out.size):
        out[i] = i * i


def test_kernels_divide_by_zero_and_keep_nan_as_ieee_says():
    assert ratio(1.0, 0.0) == np.inf
    assert np.isnan(ratio(0.0, 0.0))
    assert is_nan(np.nan)
    assert not is_nan(1.0)


def test_kernels_add_in_the_order_of_the_source():
    values = np.tile([1e16, 1.0, -1e16], 100)
    in_order = 0.0
    for value in values:
        in_order += float(value)
    assert cancelling(values) == in_order


def test_kernels_release_the_lock_and_run_in_threads():
    assert ratio.targetoptions["nogil"]
    out = np.zeros(1000)
    squares(out)
    np.testing.assert_array_equal(out, np.arange(1000.0) ** 2)


@pytest.mark.parametrize("folder", [ROOT / "lutgen", ROOT / "tests"])
def test_the_cache_folder_is_named_by_a_digest(folder):
    path = cache_folder(str(folder))
    assert path is None or len(Path(path).name) == 16
