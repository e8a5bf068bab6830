"""Builds the C runtime, once for each family, as a library for ctypes; see pyproject.toml."""

import hashlib
import os
import shutil
import sysconfig
from pathlib import Path

from setuptools import Extension, find_namespace_packages, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext

FAMILIES = ("points", "tables", "tables_i", "grid", "rails", "search")
SOURCES = sorted(Path("firmware_export/runtime").glob("*.[ch]"))
# `firmware_export.host` refuses a library of other sources.
DIGEST = hashlib.sha256(b"\0".join(path.read_bytes() for path in SOURCES)).hexdigest()
# Each operation rounds once, as on the targets; no flag names the folder of the build.
FLAGS = ["-std=c99", "-O2", "-ffp-contract=off", "-fno-fast-math", "-Wno-unknown-pragmas", "-g0"]
# Python may have been built by a compiler that this machine lacks.
if not shutil.which((sysconfig.get_config_var("CC") or "cc").split()[0]):
    os.environ.setdefault("CC", "cc")


class Wheel(bdist_wheel):
    """A wheel for every Python 3 of one platform."""

    def get_tag(self) -> tuple[str, str, str]:  # noqa: D102
        return "py3", "none", super().get_tag()[2]


class Build(build_ext):
    """The same file compiled for each family."""

    def build_extension(self, ext: Extension) -> None:  # noqa: D102
        for family in FAMILIES:
            ext.extra_objects += self.compiler.compile(
                ext.sources,
                output_dir=str(Path(self.build_temp) / family),
                macros=[*ext.define_macros, ("SMAP_FAMILY", family)],
                extra_postargs=ext.extra_compile_args,
                depends=ext.depends,
            )
        ext.sources = []
        super().build_extension(ext)


runtime = Extension(
    "firmware_export.runtime._host",
    ["firmware_export/runtime/smap_host.c"],
    define_macros=[("SMAP_SOURCES", f'"{DIGEST}"')],
    extra_compile_args=[*FLAGS, f"-ffile-prefix-map={Path.cwd()}=."],
    depends=[str(path) for path in SOURCES],
    py_limited_api=True,  # it is no Python module, so its name carries no version of Python
    optional=True,  # without a compiler all but exports works
)
packages = find_namespace_packages(".", ["*__pycache__"], ["lutgen*", "firmware_export*"])
setup(
    packages=[*packages, "lutgen.gallery"],
    package_dir={"lutgen.gallery": "maps"},
    cmdclass={"bdist_wheel": Wheel, "build_ext": Build},
    ext_modules=[runtime],
    # An editable install is this folder on the path, where type checkers look for packages.
    options={"editable_wheel": {"mode": "compat"}},
)
