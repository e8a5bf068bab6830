"""numba's flags, and the folder of the machine code that numba keeps.

`njit` compiles without any flag that lets the compiler reorder sums or assume that NaN does not
exist: a map must have the same bits for any number of threads, and a NaN must stay one.

numba looks for edits in the file of the decorated function alone.  A kernel would go on to run the
old code of a callee in another file, so the folder is named by a digest of all files that hold
kernels.  A constant that a kernel uses must stand in such a file.  The folder may be deleted.
"""

import functools
import gc
import hashlib
import logging
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeVar

import numba
from llvmlite import binding
from numba import types
from numba.core import event, sigutils
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, compile_result
from numba.core.registry import CPUDispatcher
from numba.core.runtime import rtsys
from numba.misc.appdirs import user_cache_dir

# "contract" (fused multiply-add), "arcp" and "nsz" act inside one expression and do not
# depend on the loop's length; "reassoc" would, and "nnan"/"ninf" would lose NaN.
FASTMATH = {"contract", "arcp", "nsz"}

# Pieces of work are not all equally dear, and small parts even that out.
PARTS_PER_THREAD = 8

# Files that hold kernels import this module; the text of that import marks them.
_MARK = b"lutgen.jit"
_PACKAGE = Path(__file__).resolve().parent
_PACKAGES = (_PACKAGE, _PACKAGE.parent / "firmware_export")
_FIRST = "compiling the kernels: about 20 seconds on an idle machine, kept for the next time"

_Function = TypeVar("_Function", bound=Callable[..., Any])


class _Compiling(event.Listener):  # type: ignore[misc]
    """Says once that the program waits; holds off the garbage collector, a sixth of the time."""

    said, depth, collects = False, 0, True

    def on_start(self, event: object) -> None:
        if not self.said:
            self.said = True
            logging.getLogger("lutgen").warning(_FIRST)
        if self.depth == 0:
            self.collects = gc.isenabled()
            gc.disable()
        self.depth += 1

    def on_end(self, event: object) -> None:
        self.depth -= 1
        if self.depth == 0 and self.collects:
            gc.enable()


class _Place(_CacheLocator):  # type: ignore[misc]
    """Where the machine code of a kernel lies: equal sources share it, wherever they are."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self.function, self.file = function, file

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> "_Place":
        return cls(function, file)

    def ensure_cache_path(self) -> None:
        """Make the folder; `cache_folder` has found that it can be made."""
        Path(self.get_cache_path()).mkdir(exist_ok=True)

    def get_cache_path(self) -> str:
        return f"{cache_folder()}/{self.function.__module__}"

    def get_source_stamp(self) -> str:
        """Return the digest of the function's own file, which need not be one of ours."""
        return _digest(Path(self.file))

    def get_disambiguator(self) -> str:
        return str(self.function.__code__.co_firstlineno)


class _Forms(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_Place,)


class _Kernels(FunctionCache):  # type: ignore[misc]
    """numba's disk cache of a kernel, quick to load and safe from damage.

    numba would first import all that it can compile, and with it scipy's linear algebra: a quarter
    of the time of a short command.  A compilation imports it by itself.
    """

    _impl_class = _Forms

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the whole machine code for a signature, or None."""
        # Machine code counts references to arrays; the import would have begun that.
        rtsys.initialize(target_context)
        try:
            found = self._load_overload(sig, target_context)
        except Exception:
            self.flush()
            return None
        # Two processes that save at once may give one name to two forms.
        wanted = sigutils.normalize_signature(sig)[0]
        return found if found is not None and found.signature.args == wanted else None


class _InnerCode(JITCodeLibrary):  # type: ignore[misc]
    """The code of a kernel that others call: linked into theirs, and never run by itself.

    numba would make machine code of it, with all that it calls, and a wrapper for Python, and do
    the same again for each kernel above it: half of the time that compiling takes.
    """

    def finalize(self) -> None:
        for library in dict.fromkeys(self._linking_libraries):
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0, for no machine code."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> Any:
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Keep nothing: Python never calls this code."""

    def serialize_using_object_code(self) -> tuple[str, bytes]:
        return self.name, self._get_module_for_linking().as_bitcode()


class _InnerCompiler(Compiler):  # type: ignore[misc]
    def compile_extra(self, func: Any) -> Any:
        self.state.library = _InnerCode(self.state.targetctx.codegen(), func.__qualname__)
        return super().compile_extra(func)


class _InnerForms(_Forms):
    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        return f"{super().get_filename_base(fullname, abiflags)}.inner"

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        (name, code), fndesc, env, signature, _, lifted, annotation, reload_init, envs = payload
        library = _InnerCode(target_context.codegen(), name)
        library._final_module, library._finalized = binding.parse_bitcode(code), True
        return compile_result(
            target_context=target_context,
            typing_context=target_context.typing_context,
            library=library,
            environment=env,
            entry_point=target_context.get_executable(library, fndesc, env),
            fndesc=fndesc,
            type_annotation=annotation,
            signature=signature,
            objectmode=False,
            lifted=lifted,
            reload_init=reload_init,
            referenced_envs=envs,
        )


class _InnerKernels(_Kernels):
    _impl_class = _InnerForms


def njit(
    *, inline: bool = False, exact: bool = False, bare: bool = False
) -> Callable[[_Function], _Function]:
    """Compile a kernel with the project's flags; use as ``@njit()``.

    With ``NUMBA_DISABLE_JIT=1`` in the environment the function stays plain Python.

    One that is `inline` is so always: worth it for small functions that take arrays.  In an `exact`
    one every operation is rounded by itself: predicates must say the same wherever they are used.
    A `bare` one makes no array and returns none; references to its arrays are then not counted,
    which for ten arrays takes longer than a short kernel's work.
    """

    def compile_later(function: _Function) -> _Function:
        options: dict[str, Any] = {
            "error_model": "numpy",
            "fastmath": False if exact else FASTMATH,
            "nogil": True,
            "forceinline": inline,
            "_nrt": not bare,
            # A kernel is never called from C.
            "no_cfunc_wrapper": True,
        }
        compiled: _Function = numba.njit(**options)(function)
        if not isinstance(compiled, CPUDispatcher):
            return compiled
        options |= {"no_cpython_wrapper": True, "pipeline_class": _InnerCompiler}
        called = numba.njit(**options)(function)
        _call_inside(compiled, called)
        if cache_folder() is not None:
            called._cache, compiled._cache = _InnerKernels(function), _Kernels(function)
        return compiled

    return compile_later


def _call_inside(compiled: Any, called: Any) -> None:
    """Let kernels call a form of a kernel of their own, one for literal integers and for others.

    numba compiles a callee once for each literal that a caller hands on, and for a variable: a
    counter that starts at 0 doubles everything below it.  The machine code is the same.
    """
    find = called.get_call_template

    def find_without(args: tuple[Any, ...], kws: dict[str, Any]) -> Any:
        plain = {name: types.unliteral(kind) for name, kind in kws.items()}
        return find(tuple(map(types.unliteral, args)), plain)

    compiled.get_call_template = find_without
    compiled.get_overload, compiled.called = called.get_overload, called


@functools.cache
def cache_folder() -> str | None:
    """Return the folder of the machine code; None if it cannot be written, to compile each time.

    It is ``<root>/<digest>``: the root ``NUMBA_CACHE_DIR``, or ``lutgen`` in the user's caches; the
    digest changes with every file that holds kernels, with numba and with the processor.
    """
    digest = hashlib.sha256()
    for part in (numba.__version__, binding.get_host_cpu_name(), repr(sorted(FASTMATH))):
        digest.update(part.encode() + b"\0")
    for package in _PACKAGES:
        for path in sorted(package.rglob("*.py")):
            if _MARK in path.read_bytes():
                name = path.relative_to(package).as_posix()
                digest.update(f"{name}\0{_digest(path)}\0".encode())
    root = Path(os.environ.get("NUMBA_CACHE_DIR") or user_cache_dir("lutgen"))
    folder = root / digest.hexdigest()[:16]
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError:
        return None
    # Without a home, the user's folder is "~" of wherever the process runs.
    return str(folder) if root.is_absolute() and os.access(folder, os.W_OK) else None


@functools.cache
def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def in_threads(
    kernel: Callable[..., None],
    pieces: int,
    memory: Callable[[], object],
    *arguments: object,
    least: int = 1,
) -> None:
    """Call ``kernel(span, memory(), *arguments)`` on parts of a range, of `least` pieces or more.

    `span`: the first piece and the one after the last.  Each part has a memory of its own.
    Kernels release Python's lock, so Python's own threads do.  On a busy machine a thread that is
    woken for a few microseconds of work is waited for a thousand times as long.
    """
    threads = 1 if pieces < 2 * least else min(numba.get_num_threads(), pieces // least)
    if threads == 1:
        kernel((0, pieces), memory(), *arguments)
        return
    parts = min(threads * PARTS_PER_THREAD, pieces)
    spans = [*pairwise(part * pieces // parts for part in range(parts + 1))]
    if not getattr(kernel, "signatures", True):
        # It is compiled here: Ctrl-C does not reach other threads.
        kernel(spans.pop(0), memory(), *arguments)
    pool = ThreadPoolExecutor(threads)
    try:
        # All are waited for, and the first error is raised.
        list(pool.map(lambda span: kernel(span, memory(), *arguments), spans))
    finally:
        # Ctrl-C need not wait for results that are not used.
        pool.shutdown(wait=False, cancel_futures=True)


# A kernel that is loaded from the folder is no such event.
event.register("numba:compile", _Compiling())
