"""The notice that the compiler is waited for: once, only when it is, and never to the quiet."""

import numba
import pytest

from lutgen.cli.compiling import MESSAGE, compiling_is_told


@pytest.mark.parametrize(("quiet", "said"), [(False, f"{MESSAGE}\n"), (True, "")])
def test_the_first_of_several_kernels_is_told_and_compiled_ones_are_not(
    quiet: bool, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    one, other = numba.njit(lambda x: x + 1), numba.njit(lambda x: x + 2)
    with compiling_is_told(quiet):
        assert (one(1), other(1)) == (2, 3)
    with compiling_is_told(quiet):
        assert (one(1), other(1)) == (2, 3)
    assert capsys.readouterr().err == said


def test_after_the_block_nothing_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with compiling_is_told(False):
        pass
    assert numba.njit(lambda x: x + 3)(1) == 4
    assert capsys.readouterr().err == ""
