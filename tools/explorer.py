"""Builds what `lutgen explore` ships: two WebAssembly modules, and the page's scripts in one file.

Run by `make engine`, which needs clang, wasm-ld, node and npm.  With --check nothing is replaced:
the files are built beside and compared byte for byte.
"""

import argparse
import hashlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HOME = ROOT / "firmware_export" / "explore"
RUNTIME = ROOT / "firmware_export" / "runtime"
# memcpy and memset without a C library.
MEMORY = ROOT / "targets" / "wasm" / "memory.c"
FLAGS = (
    *("--target=wasm32", "-mcpu=mvp", "-ffreestanding", "-std=c99", "-O2", "-ffp-contract=off"),
    *("-fno-ident", "-Wall", "-Wextra", "-Wno-unknown-pragmas", "-Wno-unused-function"),
)
LINK = ("--no-entry", "--strip-all", "-z", "stack-size=524288", "--export=__heap_base")
FAMILIES = ("three", "points", "grid", "whole", "many", "search")
PARTS = (
    *("types", "planes", "rests", "search", "rolls", "held", "gaps"),
    *("walls", "pieces", "trace", "strips", "pose", "at"),
)
# Tolerances of single precision, and what the exact definition has in their place.
TOLERANCES = {
    "SMAP_BELOW": "1e-9",
    "SMAP_TURN_SHORT": "1e-7",
    "SMAP_TURN_ROUNDED": "1e-7",
    "SMAP_TOUCHES": "2e-9",
    "SMAP_NOISY": "2e-9",
    "SMAP_FLAT": "1e-12",
    "SMAP_FACE": "0.17364817766693033",
    "SMAP_FLATTEST": "1e-6",
    "SMAP_NEWTON": "40",
    "SMAP_CAUGHT": "1e-12",
    "SMAP_RAISED": "1e-12",
    "SMAP_FURTHER_ON": "1e-12",
    "SMAP_TURNED": "1e-12",
    "SMAP_HAIR": "1e-9",
    "SMAP_STRAIGHT": "0.0",
    "SMAP_SPARE": "1e-9",
}
# Single places where a number stands without a name, or bits are those of a single.
PLACES = {
    """  uint32_t bits;
  memcpy(&bits, &w->low[e], sizeof bits);
  return SMAP_MANY_GAPS && bits <= 0x3F800000u;""": (
        "  return w->low[e] >= 0.0 && w->low[e] <= 1.0;"
    ),
    "change < 1e-9)": "change < 1e-26)",
    "smap_dot(d, d) >= 1e-8": "smap_dot(d, d) >= 1e-16",
    "o->hair = 1e-4": "o->hair = 1e-12",
    "o->slack = 5e-4": "o->slack = 1e-9",
    # Sides of gaps are cut as the definition cuts them, see exact.c.
    "smap_has_ends(w, o, e) && smap_has_ends(w, o, back)": "1",
    "    smap_curve(w, o, e, side, p, q);": "    exact_side(w, o, e, side, p, q);",
    # Which way a roll is followed, and so over which contact, is a matter of the last digits.
    "(w->twin[e] < e) {\n    e = w->twin[e];": "(exact_backwards(w, e)) {\n    e = w->twin[e];",
    "(w->twin[e] > e) {\n    SMAP_THRICE": "(!exact_backwards(w, e)) {\n    SMAP_THRICE",
    "#define SMAP_NONE 255u": "#define SMAP_NONE 65535u",
}


def doubled(text: str, used: set[str]) -> str:
    """Return a part of the runtime in double precision; add to `used` what was replaced in it."""
    text = re.sub(r"\bfloat\b", "double", text)
    # Room for any robot: indices are wider than on a microcontroller, and so are counts of work.
    text = text.replace("uint16_t", "uint32_t").replace("uint8_t", "uint16_t")
    text = re.sub(r"(?<![\w.])(\d+\.?\d*(?:e[-+]?\d+)?)f\b", r"\1", text)
    for name, value in TOLERANCES.items():
        text, times = re.subn(rf"(#define {name} +)\S+", rf"\g<1>{value}", text)
        used |= {name} if times else set()
    for single, double in PLACES.items():
        used |= {single} if single in text else set()
        text = text.replace(single, double)
    return text


def write_doubled(folder: Path) -> None:
    """Write the parts of the runtime that engine/exact.c takes in, in double precision."""
    used: set[str] = set()
    for part in PARTS:
        name = f"many_{part}.c"
        text = (RUNTIME / name).read_text(encoding="utf-8")
        (folder / name).write_text(doubled(text, used), encoding="utf-8")
    lost = {*TOLERANCES, *PLACES} - used
    if lost:
        sys.exit(
            f"the runtime no longer has what engine/exact.c has otherwise (got no {min(lost)!r}); "
            "say here what stands in its place."
        )


def run(command: list[object], where: Path) -> None:
    """Run a command; stop with what it said where it fails."""
    done = subprocess.run(
        [str(word) for word in command], cwd=where, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")


def build_exported(folder: Path, out: Path) -> None:
    """Build the module of all families of codecs: what exports are asked with."""
    for family in FAMILIES:
        name = f"host_{family}"
        digest = '-DSMAP_SOURCES="wasm"'
        source = RUNTIME / f"{name}.c"
        command = ["clang", *FLAGS, digest, f"-I{MEMORY.parent}", f"-I{RUNTIME}", "-c", source]
        run([*command, "-o", f"{name}.o"], folder)
    names = [f"smap_{family}_host_{what}" for family in FAMILIES for what in ("read", "at")]
    names += [f"smap_{family}_host_{what}" for family in FAMILIES for what in ("read_i", "at_i")]
    names += [f"smap_{family}_host_check" for family in FAMILIES]
    names += [f"smap_{family}_host_positions" for family in ("three", "many", "search")]
    objects = [f"host_{family}.o" for family in FAMILIES]
    link(folder, objects, names, out)


def build_exact(folder: Path, out: Path) -> None:
    """Build the module of the code for many contacts in double precision."""
    write_doubled(folder)
    source = HOME / "engine" / "exact.c"
    run(
        ["clang", *FLAGS, f"-I{folder}", f"-I{MEMORY.parent}", "-c", source, "-o", "exact.o"],
        folder,
    )
    lists = [f"exact_list_{name}" for name in ("facets", "edges", "segments")]
    data = ("contact", "number", "gravity", "answer", "facets", "edges", "segments")
    names = ["exact_pose", "exact_read", *lists, *(f"exact_{name}" for name in data)]
    link(folder, ["exact.o"], names, out)


def link(folder: Path, objects: list[str], names: list[str], out: Path) -> None:
    """Link objects with memcpy and memset into a module that gives some names."""
    run(["clang", *FLAGS, "-fno-builtin", f"-I{MEMORY.parent}", "-c", MEMORY], folder)
    given = [f"--export={name}" for name in names]
    run(["wasm-ld", *LINK, *given, *objects, "memory.o", "-o", out], folder)
    out.chmod(0o644)


def build_scripts(folder: Path, out: Path) -> None:
    """Bundle the page's scripts and the worker's, with the packages that the lock file names."""
    aside = shutil.ignore_patterns("node_modules")
    shutil.copytree(HOME / "web", folder, dirs_exist_ok=True, ignore=aside)
    run(["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts"], folder)
    packages = folder / "node_modules"
    look = ["--bundle", "--minify", "--format=iife", "--target=es2020", "--charset=utf8"]
    for name in ("main", "worker"):
        command = ["node", packages / "esbuild" / "bin" / "esbuild", f"{name}.js", *look]
        run([*command, "--legal-comments=none", f"--outfile={out / name}.js"], folder)
    three = packages / "three"
    version = json.loads((three / "package.json").read_text(encoding="utf-8"))["version"]
    licence = (three / "LICENSE").read_text(encoding="utf-8")
    (out / "three.LICENSE").write_text(f"three.js {version}\n\n{licence}", encoding="utf-8")


def clang_version() -> str:
    """Return which clang is here; another one gives other bytes."""
    said = subprocess.run(["clang", "--version"], capture_output=True, text=True, check=True)
    return said.stdout.splitlines()[0].strip()


def build(out: Path, only: str) -> None:
    """Build all files, or those of C or of scripts alone, into a folder."""
    if only != "scripts":
        for name, make in (("exported", build_exported), ("exact", build_exact)):
            with tempfile.TemporaryDirectory() as folder:
                make(Path(folder), out / f"{name}.wasm")
        (out / "made_by.txt").write_text(f"{clang_version()}\n", encoding="utf-8")
    if only != "engine":
        with tempfile.TemporaryDirectory() as folder:
            build_scripts(Path(folder), out)


def compare(folder: Path) -> None:
    """Stop where a file that was built is not what is checked in."""
    for path in sorted(folder.iterdir()):
        built, held = path.read_bytes(), (HOME / "built" / path.name).read_bytes()
        if built != held:
            here, there = (hashlib.sha256(one).hexdigest()[:12] for one in (held, built))
            sys.exit(
                f"{path.name}: is not what its sources give (got {here}, built {there}); "
                "run make engine."
            )


def main() -> None:
    """Build, or compare with what is there."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare, and replace nothing")
    parser.add_argument("--only", choices=("engine", "scripts"), default="")
    asked = parser.parse_args()
    if not asked.check:
        build(HOME / "built", asked.only)
        return
    with tempfile.TemporaryDirectory() as folder:
        build(Path(folder), asked.only)
        compare(Path(folder))


if __name__ == "__main__":
    main()
