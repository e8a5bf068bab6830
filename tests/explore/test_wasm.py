"""The WebAssembly that is checked in is what the runtime's C gives."""

from pathlib import Path

import pytest

from tools.engine import MODULE, build, clang_version


@pytest.mark.needs("clang", "wasm-ld")
def test_the_webassembly_is_what_the_sources_give(tmp_path: Path) -> None:
    held = MODULE.read_bytes()
    if clang_version().encode() not in held:
        pytest.skip(f"{clang_version()} is not what the module says that it was made by")
    build(tmp_path / "made.wasm")
    assert (tmp_path / "made.wasm").read_bytes() == held, "run make engine"
