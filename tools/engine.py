"""Compiles the runtime to the WebAssembly that `lutgen explore` ships: `make engine [OUT]`.

Needs clang and wasm-ld.  The module holds the version of clang: another one gives other bytes.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MODULE = ROOT / "firmware_export" / "explore" / "wasm" / "exported.wasm"
RUNTIME = ROOT / "firmware_export" / "runtime"

FAMILIES = ("points", "rails", "search")
GIVEN = (
    *(f"smap_{family}_host_{what}" for family in FAMILIES for what in ("at", "check")),
    *("smap_rails_host_pose", "smap_search_host_pose", "smap_points_host_sources", "__heap_base"),
)
FLAGS = (
    *("--target=wasm32", "-mcpu=mvp", "-mbulk-memory", "-ffreestanding", "-std=c99", "-O2"),
    *("-ffp-contract=off", "-fno-ident", "-w", "-nostdlib", f"-I{MODULE.parent}", f"-I{RUNTIME}"),
)
LINK = (
    "-Wl,--no-entry,--strip-all,-z,stack-size=524288",
    *(f"-Wl,--export={one}" for one in GIVEN),
)


def clang_version() -> str:
    """Return which clang is here."""
    said = subprocess.run(["clang", "--version"], capture_output=True, text=True, check=True)
    return said.stdout.splitlines()[0].strip()


def build(out: Path) -> None:
    """Compile the module into a file."""
    flags = [*FLAGS, f'-DSMAP_SOURCES="{clang_version()}"']
    with tempfile.TemporaryDirectory() as place:
        made = [f"{place}/{family}.o" for family in FAMILIES]
        for family, name in zip(FAMILIES, made, strict=True):
            source = [f"-DSMAP_FAMILY={family}", "-c", str(RUNTIME / "smap_host.c"), "-o", name]
            subprocess.run(["clang", *flags, *source], check=True)
        subprocess.run(["clang", *FLAGS, *LINK, *made, "-o", str(out)], check=True)
    out.chmod(0o644)


if __name__ == "__main__":
    build(Path(sys.argv[1]) if len(sys.argv) > 1 else MODULE)
