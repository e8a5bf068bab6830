"""The project's decorator: flags, cache and its staleness, and life without a compiler."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

from lutgen.jit import cache_folder, njit, prange
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
