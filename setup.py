"""Builds the C runtime for this machine and takes the gallery's recipes into the package.

All else about the package is in pyproject.toml.
"""

import hashlib
import shutil
from pathlib import Path

from setuptools import Extension, find_namespace_packages, setup
from setuptools.command.build_ext import build_ext

RUNTIME = Path("firmware_export/runtime")
SOURCES = sorted(RUNTIME.glob("*.[ch]"))
# The library tells what it was built from: `firmware_export.host` refuses one of other sources.
DIGEST = hashlib.sha256(b"\0".join(path.read_bytes() for path in SOURCES)).hexdigest()
FAMILIES = [path.stem.removeprefix("host_") for path in sorted(RUNTIME.glob("host_*.c"))]
ASKED = ("read", "read_i", "at", "at_i", "check")
# On-board control, of the families that are read with floats.
CONTROLLED = ("three", "grid", "many", "search")
CONTROL = "control control_sizes start step ground target transit budget turn".split()
EXPORTED = [
    "smap_sources",
    "smap_many_host_room",
    "smap_search_host_room",
    *(f"smap_{name}_host_positions" for name in ("three", "many", "search")),
    *(f"smap_{name}_host_{what}" for name in FAMILIES for what in ASKED),
    *(f"smap_{name}_host_{what}" for name in CONTROLLED for what in CONTROL),
]
# Each operation rounds once, as on the targets; whatever CFLAGS say, these stand behind them.
FLAGS = ["-std=c99", "-O2", "-ffp-contract=off", "-fno-fast-math", "-Wno-unknown-pragmas"]


class BuildLibrary(build_ext):
    """A plain library for ctypes and no module: it needs no header of Python, and exports none."""

    def build_extensions(self) -> None:
        """Build with the compiler that is here: Python's own was another machine's, perhaps."""
        here = next(filter(shutil.which, ("cc", "gcc", "clang")), None)
        if here is not None:
            for step in ("compiler", "compiler_so", "linker_so"):
                words = getattr(self.compiler, step, None)
                if words and not shutil.which(words[0]):
                    self.compiler.set_executable(step, [here, *words[1:]])
        super().build_extensions()

    def get_export_symbols(self, ext: Extension) -> list[str]:
        """Return the names to export: those of the extension alone."""
        return ext.export_symbols


setup(
    packages=[
        *find_namespace_packages(
            include=["lutgen*", "firmware_export*"], exclude=["*.__pycache__", "lutgen.gallery"]
        ),
        "lutgen.gallery",
    ],
    # The recipes stand where people look for them; which files go along is in pyproject.toml.
    package_dir={"lutgen.gallery": "maps"},
    cmdclass={"build_ext": BuildLibrary},
    ext_modules=[
        Extension(
            "firmware_export.runtime._host",
            [str(path) for path in RUNTIME.glob("host_*.c")],
            define_macros=[("SMAP_SOURCES", f'"{DIGEST}"')],
            extra_compile_args=FLAGS,
            export_symbols=EXPORTED,
            depends=[str(path) for path in SOURCES],
            # Without a compiler everything but exports can be installed.
            optional=True,
        )
    ],
)
