"""The one place that holds numba's flags and the place of its disk cache.

``njit`` compiles without any flag that lets the compiler reorder sums or assume
that NaN does not exist: a map must have the same bits for any number of threads
and a NaN must stay one.

numba's own disk cache looks at the file of the decorated function only, so a
kernel keeps running the old code of a callee that was edited in another file.
Here the cache folder is therefore named after a digest of every file that holds
kernels.  A constant that a kernel uses must live in such a file too.  The whole
folder may be deleted at any time.
"""

import functools
import hashlib
from collections.abc import Callable, Iterable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numba
from llvmlite import binding
from numba import prange, types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, compile_result
from numba.core.registry import CPUDispatcher
from numba.core.runtime import rtsys

from lutgen import interrupts
from lutgen.cache import Entries, cache_root, usable

__all__ = ["cache_folder", "in_threads", "njit", "prange"]

# "contract" (fused multiply-add), "arcp" and "nsz" act inside one expression and do not
# depend on the loop's length; "reassoc" would, and "nnan"/"ninf" would lose NaN.
FASTMATH = {"contract", "arcp", "nsz"}

# Pieces of work are not all equally dear, and small parts even that out.
PARTS_PER_THREAD = 8

# Files that hold kernels import this module; the text of that import marks them.
_MARK = b"lutgen.jit"
# Packages whose kernels read nothing that is not in such a file: a test holds it.
_OURS = ("lutgen", "firmware_export")
_PACKAGE = Path(__file__).resolve().parent

interrupts.defer()

_Function = TypeVar("_Function", bound=Callable[..., Any])
Job = TypeVar("Job")
Result = TypeVar("Result")


class _Place(UserProvidedCacheLocator):  # type: ignore[misc]
    """Where a kernel's entries lie: equal sources of ours share them, wherever they are.

    numba names a folder after the path of the source, so a second clone or a second environment
    would compile for a minute what is there already.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """Return the folder for a source: named by its room, or by the path of others."""
        room = Path(py_file).resolve().parent
        package = _package_of(room)
        if package.name in _OURS and (package / "__init__.py").is_file():
            return ".".join(room.relative_to(package.parent).parts)
        return str(super().get_suitable_cache_subpath(py_file))

    def get_source_stamp(self) -> str:
        """Return nothing: the folder above is named by all that is in the sources."""
        return ""


class _Forms(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_Place,)


class _InnerCode(JITCodeLibrary):  # type: ignore[misc]
    """The code of a kernel that others call: linked into theirs, and never run by itself.

    numba would optimise it, with all that it calls, and make machine code of it and of a wrapper
    for Python, and do the same again for each kernel above it: three quarters of the time that
    compiling takes.
    """

    def finalize(self) -> None:
        """Take in the code of all that is called."""
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0, for no machine code."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> Any:
        """What numba gives the environment of machine code to."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Keep nothing: Python never calls this code."""

    def serialize_using_object_code(self) -> tuple[str, bytes]:
        """Return what the disk cache keeps."""
        return self.name, self._get_module_for_linking().as_bitcode()


class _InnerCompiler(Compiler):  # type: ignore[misc]
    """numba's compiler, for the code that other kernels call."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function."""
        self.state.library = _InnerCode(self.state.targetctx.codegen(), func.__qualname__)
        return super().compile_extra(func)


class _SharedCode(JITCodeLibrary):  # type: ignore[misc]
    """Machine code that other kernels call, and do not take in."""

    def _get_module_for_linking(self) -> Any:
        """Return nothing: who calls it declares it, and finds it by its name."""
        self._ensure_finalized()
        return binding.parse_assembly("")


class _SharedCompiler(Compiler):  # type: ignore[misc]
    """numba's compiler, for machine code that other kernels call."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function."""
        self.state.library = _SharedCode(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        found = super().compile_extra(func)
        found.library._reload_init.add(_Loader.of(found))
        return found

    def _compile_bytecode(self) -> Any:
        # numba counts from 1 in every process: no other code gets this name.
        self.state.func_id.unique_id = 0
        return super()._compile_bytecode()


class _Loader(NamedTuple):
    """Brings shared machine code into the process; kept with all that calls it."""

    module: str
    function: str
    arguments: tuple[Any, ...]
    symbol: str

    @classmethod
    def of(cls, found: Any) -> "_Loader":
        """Return the loader of a compiled form."""
        where = found.fndesc
        return cls(where.modname, where.qualname, found.signature.args, where.llvm_func_name)

    def __call__(self) -> None:
        """Raise LookupError if it goes by another name since it was compiled anew."""
        called = getattr(import_module(self.module), self.function).called
        called.compile(self.arguments)
        if called.overloads[self.arguments].fndesc.llvm_func_name != self.symbol:
            raise LookupError(self.symbol)


class _SharedForms(_Forms):
    def rebuild(self, target_context: Any, payload: Any) -> Any:
        """Return a form that was kept."""
        found = super().rebuild(target_context, payload)
        found.library._reload_init.add(_Loader.of(found))
        return found


class _InnerForms(_Forms):
    def rebuild(self, target_context: Any, payload: Any) -> Any:
        """Return a form that was kept."""
        (name, code), fndesc, env, signature, _, lifted, annotation, reload_init, envs = payload
        library = _InnerCode(target_context.codegen(), name)
        library._final_module, library._finalized = binding.parse_bitcode(code), True
        library._reload_init.update(reload_init)
        for load in reload_init:
            load()
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


class _Kernels(FunctionCache):  # type: ignore[misc]
    """numba's disk cache without what only compiling needs.

    numba imports all that it can compile, and with it scipy's linear algebra, before it loads
    machine code: a quarter of the time of a short command.  A compilation imports it by itself.
    Entries that are damaged count as none.
    """

    _impl_class = _Forms
    _kind = ""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        # numba's own file of entries knows its name only in parts.
        plain = vars(self)["_cache_file"]
        base = plain._index_name.removesuffix(".nbi") + self._kind
        self._cache_file = Entries(self._cache_path, base, plain._source_stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the machine code for a signature, or None where there is none."""
        # Machine code counts references to arrays; what is imported otherwise would begin it.
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors(), suppress(LookupError):
            return self._load_overload(sig, target_context)
        return None


class _InnerKernels(_Kernels):
    """The disk cache of the code that other kernels call."""

    _impl_class = _InnerForms
    _kind = ".inner"


class _SharedKernels(_Kernels):
    """The disk cache of machine code that other kernels call."""

    _impl_class = _SharedForms
    _kind = ".shared"


def njit(
    *,
    parallel: bool = False,
    inline: bool = False,
    exact: bool = False,
    bare: bool = False,
    shared: bool = False,
) -> Callable[[_Function], _Function]:
    """Compile a kernel with the project's flags; use as ``@njit()``.

    Parameters
    ----------
    parallel : bool
        Whether ``prange`` loops of the function run in several threads.
    inline : bool
        Whether the function is always inlined.  Worth it for small functions that take
        arrays: each array argument is seven machine words, each table of arrays dozens.
    exact : bool
        Whether every operation is rounded by itself, as it is written.  For predicates that must
        say the same wherever they are asked.
    bare : bool
        Whether the function makes no array and returns none.  References to the arrays that it is
        given are then not counted, which for ten arrays takes longer than a short kernel's work.
    shared : bool
        Whether kernels call the function's own machine code, which is compiled once.  Others take
        in all that they call, and all of it is optimised anew with each of them.

    Returns
    -------
    callable
        The decorator.  With ``NUMBA_DISABLE_JIT=1`` in the environment the
        function stays plain Python.
    """

    def compile_later(function: _Function) -> _Function:
        options: dict[str, Any] = {
            "error_model": "numpy",
            "fastmath": False if exact else FASTMATH,
            "nogil": True,
            "parallel": parallel,
            "forceinline": inline,
            "_nrt": not bare,
            # Nobody calls a kernel from C.
            "no_cfunc_wrapper": True,
        }
        compiled: _Function = numba.njit(**options)(function)
        if not isinstance(compiled, CPUDispatcher):
            return compiled
        called, kept = compiled, _Kernels
        if not parallel:
            compiler = _SharedCompiler if shared else _InnerCompiler
            options |= {"no_cpython_wrapper": True, "pipeline_class": compiler}
            called = numba.njit(**options)(function)
            kept = _SharedKernels if shared else _InnerKernels
        _call_inside(compiled, called)
        folder = cache_folder(str(Path(function.__code__.co_filename).parent))
        if folder is not None:
            # numba picks the folder from this setting.
            before = numba.config.CACHE_DIR
            numba.config.CACHE_DIR = folder
            try:
                called._cache, compiled._cache = kept(function), _Kernels(function)
            finally:
                numba.config.CACHE_DIR = before
        return compiled

    return compile_later


def _call_inside(compiled: Any, called: Any) -> None:
    """Let kernels call a form of a kernel of their own, one for literal integers and for others.

    numba compiles a callee once for each literal that a caller hands on, and once more for a
    variable: a counter that starts at 0 doubles everything below it.  After inlining the machine
    code is the same.
    """
    find = called.get_call_template

    def find_without(args: tuple[Any, ...], kws: dict[str, Any]) -> Any:
        plain = {name: types.unliteral(kind) for name, kind in kws.items()}
        return find(tuple(map(types.unliteral, args)), plain)

    compiled.get_call_template = find_without
    compiled.get_overload, compiled.called = called.get_overload, called


@functools.cache
def cache_folder(source_folder: str) -> str | None:
    """Return the folder for the compiled kernels of one folder of sources.

    Parameters
    ----------
    source_folder : str
        Folder of the decorated function's file.

    Returns
    -------
    str or None
        ``<root>/<digest>`` where the root is ``NUMBA_CACHE_DIR`` if it is set,
        else ``lutgen`` in the user's cache folder, and the digest changes with any
        file that holds kernels, with numba and with the processor.  None when
        nothing can be written there, or somebody else could write there: the kernels
        are then compiled at each start.
    """
    return _folder(_package_of(Path(source_folder).resolve()))


@functools.cache
def _folder(package: Path) -> str | None:
    """Return the folder for the compiled kernels of one package, or of a folder of loose files."""
    digest = hashlib.sha256()
    for part in (numba.__version__, binding.get_host_cpu_name(), repr(sorted(FASTMATH))):
        digest.update(part.encode() + b"\0")
    for root in sorted({_PACKAGE, package}):
        for path in _kernel_files(root):
            # The same name stands in several rooms.
            name = path.relative_to(root).as_posix()
            digest.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
    folder = cache_root() / digest.hexdigest()[:16]
    return str(folder) if usable(folder) else None


def _package_of(folder: Path) -> Path:
    """Return the outermost package that holds a folder, or the folder itself."""
    while (folder.parent / "__init__.py").is_file():
        folder = folder.parent
    return folder


def _kernel_files(root: Path) -> list[Path]:
    """Return the files below `root` that hold kernels, sorted."""
    return sorted(path for path in root.rglob("*.py") if _MARK in path.read_bytes())


def in_threads(
    kernel: Callable[..., None], pieces: int, *arguments: object, least: int = 1
) -> None:
    """Call a kernel on parts of a range, in as many threads as that is worth.

    Kernels release Python's lock, so Python's own threads are enough, and no kernel is compiled a
    second time for the sake of threads.  On a busy machine a thread that is woken for a few
    microseconds of work is waited for until the machine has a core for it, which takes a thousand
    times as long as the work.

    Parameters
    ----------
    kernel : callable
        Called as ``kernel(begin, end, *arguments)``.
    pieces : int
        The parts make up range(pieces).
    arguments : object
        The same for every part.
    least : int
        Pieces that a thread of its own is worth.
    """
    threads = 1 if pieces < 2 * least else min(numba.get_num_threads(), pieces // least)
    if threads == 1:
        kernel(0, pieces, *arguments)
        return
    parts = min(threads * PARTS_PER_THREAD, pieces)
    bounds = [part * pieces // parts for part in range(parts + 1)]
    # What is not compiled yet is compiled here: Ctrl-C does not reach other threads.
    first = 0 if getattr(kernel, "signatures", True) else 1
    for at in range(first):
        kernel(*bounds[at : at + 2], *arguments)
    spans = zip(bounds[first:-1], bounds[first + 1 :], strict=True)
    in_pool(lambda span: kernel(*span, *arguments), spans, threads)


def in_pool(work: Callable[[Job], Result], jobs: Iterable[Job], threads: int) -> list[Result]:
    """Return what `work` answers to each job, in order, asked in so many threads."""
    from concurrent.futures import ThreadPoolExecutor

    pool = ThreadPoolExecutor(threads)
    try:
        answers = list(pool.map(work, jobs))
    except BaseException:
        # Ctrl-C need not wait for what nobody wants any more.
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()
    return answers
