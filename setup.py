"""Builds the C runtime for this machine and takes the gallery's recipes into the package.

What is built depends on the sources, the compiler and setuptools, and on no clock, folder or user:
a wheel or an sdist built twice is the same bytes.  A wheel says in `.dist-info/sboms/` what is in
it (PEP 770).  All else about the package is in pyproject.toml.
"""

import gzip
import hashlib
import json
import os
import shutil
import tarfile
import zipfile
from io import BytesIO
from pathlib import Path
from typing import Any

from setuptools import Extension, find_namespace_packages, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist

RUNTIME = Path("firmware_export/runtime")
SOURCES = sorted(RUNTIME.glob("*.[ch]"))
# The library tells what it was built from: `firmware_export.host` refuses one of other sources.
DIGEST = hashlib.sha256(b"\0".join(path.read_bytes() for path in SOURCES)).hexdigest()
FAMILIES = [path.stem.removeprefix("host_") for path in sorted(RUNTIME.glob("host_*.c"))]
ASKED = ("read", "read_i", "at", "at_i", "check")
# On-board control, of the families that are read with floats.
CONTROLLED = ("three", "many", "search")
CONTROL = tuple("control control_sizes start step ground target transit budget turn".split())  # noqa: SIM905
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
# Nor does it hold where it was built; without what a debugger wants, no flag of Python's does.
FLAGS += [f"-ffile-prefix-map={Path.cwd()}=.", "-g0"]
# The time that archives give every file, in seconds since 1970: the first that a zip can say.
EPOCH = int(os.environ.setdefault("SOURCE_DATE_EPOCH", "315532800"))


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


def mode(before: int) -> int:
    """Return the rights of a file in an archive: no umask of who built it."""
    return 0o755 if before & 0o100 else 0o644


def bill(name: str, version: str, needs: list[str]) -> str:
    """Return what a wheel holds and what it needs, as CycloneDX: no time, no random number."""
    runtime = {
        "type": "library",
        "bom-ref": "smap",
        "name": "smap",
        "version": version,
        "description": "the C runtime, as sources and built for Python",
        "licenses": [{"license": {"id": "MIT"}}],
        "hashes": [{"alg": "SHA-256", "content": DIGEST}],
    }
    # Of what it needs others choose the versions: `versionRange` is what is allowed.
    needed: list[dict[str, Any]] = [
        {
            "type": "library",
            "bom-ref": name_of(need),
            "name": name_of(need),
            "purl": f"pkg:pypi/{name_of(need)}",
            "scope": "required",
            "properties": [{"name": "lutgen:requirement", "value": need}],
        }
        for need in sorted(needs)
    ]
    own = {
        "type": "application",
        "bom-ref": name,
        "name": name,
        "version": version,
        "purl": f"pkg:pypi/{name}@{version}",
        "licenses": [{"license": {"id": "MIT"}}],
    }
    parts = [runtime, *needed]
    document = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {"component": own},
        "components": parts,
        "dependencies": [{"ref": name, "dependsOn": [part["bom-ref"] for part in parts]}],
    }
    return json.dumps(document, indent=1) + "\n"


def name_of(requirement: str) -> str:
    """Return the name of a requirement such as "numpy>=1.26,<3"."""
    return requirement.partition(";")[0].strip().partition("<")[0].partition(">")[0].strip()


class Wheel(bdist_wheel):
    """A wheel that is the same bytes each time, with its bill of materials."""

    def egg2dist(self, egginfo_path: str, distinfo_path: str) -> None:
        """Write the metadata, and the bill beside them."""
        super().egg2dist(egginfo_path, distinfo_path)
        about = self.distribution
        folder = Path(distinfo_path) / "sboms"
        folder.mkdir(exist_ok=True)
        text = bill(about.get_name(), about.get_version(), list(about.install_requires))
        (folder / "lutgen.cdx.json").write_text(text, "utf-8")

    def run(self) -> None:
        """Build, then write the archive again without what differs."""
        super().run()
        for _, _, file in self.distribution.dist_files:
            if file.endswith(".whl"):
                settle_zip(Path(file))


class Source(sdist):
    """An sdist that is the same bytes each time."""

    def make_archive(self, *given: Any, **named: Any) -> str:
        """Write the archive, then again without what differs."""
        file: str = super().make_archive(*given, **named)
        if file.endswith(".tar.gz"):
            settle_tar(Path(file))
        return file


def settle_zip(file: Path) -> None:
    """Write a zip again: files in order, one date, no user's rights."""
    with zipfile.ZipFile(file) as old:
        entries = [(info, old.read(info)) for info in old.infolist() if not info.is_dir()]
    # The list of files and their digests comes last, as wheels have it.
    entries.sort(key=lambda entry: (entry[0].filename.endswith("RECORD"), entry[0].filename))
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as new:
        for info, data in entries:
            entry = zipfile.ZipInfo(info.filename, (1980, 1, 1, 0, 0, 0))
            entry.external_attr = (0o100000 | mode(info.external_attr >> 16)) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            new.writestr(entry, data)


def settle_tar(file: Path) -> None:
    """Write a tar.gz again: entries in order, one date, no user and none of their rights."""
    with tarfile.open(file) as old:
        entries = []
        for info in sorted(old.getmembers(), key=lambda info: info.name):
            data = old.extractfile(info)
            info.mtime, info.uid, info.gid, info.uname, info.gname = EPOCH, 0, 0, "", ""
            info.mode = 0o755 if info.isdir() else mode(info.mode)
            info.pax_headers = {}
            entries.append((info, data.read() if data else b""))
    with (
        file.open("wb") as raw,
        gzip.GzipFile("", "wb", fileobj=raw, mtime=EPOCH) as packed,
        tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as new,
    ):
        for info, content in entries:
            new.addfile(info, None if info.isdir() else BytesIO(content))


setup(
    packages=[
        *find_namespace_packages(
            include=["lutgen*", "firmware_export*"], exclude=["*.__pycache__", "lutgen.gallery"]
        ),
        "lutgen.gallery",
    ],
    # The recipes stand where people look for them; which files go along is in pyproject.toml.
    package_dir={"lutgen.gallery": "maps"},
    cmdclass={"build_ext": BuildLibrary, "bdist_wheel": Wheel, "sdist": Source},
    ext_modules=[
        Extension(
            "firmware_export.runtime._host",
            sorted(str(path) for path in RUNTIME.glob("host_*.c")),
            define_macros=[("SMAP_SOURCES", f'"{DIGEST}"')],
            extra_compile_args=FLAGS,
            export_symbols=EXPORTED,
            depends=[str(path) for path in SOURCES],
            # Without a compiler everything but exports can be installed.
            optional=True,
        )
    ],
)
