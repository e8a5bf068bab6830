"""The paper's report, written once: its folder, and the numbers that it was made of."""

from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from lutgen.cli import main
from lutgen.paper import report as write
from lutgen.paper.results import MAP, Results


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Results]:
    """Run `lutgen paper` into a folder that holds somebody else's file, too."""
    folder = tmp_path_factory.mktemp("paper")
    (folder / "mine.txt").write_text("not the report's")
    computed: list[Results] = []
    compute = write.compute

    def kept(*arguments: object) -> Results:
        computed.append(compute(*arguments))  # type: ignore[arg-type]
        return computed[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(write, "compute", kept)
        done = CliRunner().invoke(main, ["paper", "-o", str(folder)])
    assert done.exit_code == 0, done.output
    assert done.stdout.strip() == str(folder / "paper.html")
    # The map was computed beside the report, and has moved into it.
    swept = replace(computed[0].swept, path=folder / MAP)
    return folder, replace(computed[0], swept=swept)


@pytest.fixture(scope="session")
def report(written: tuple[Path, Results]) -> Path:
    """Return the folder."""
    return written[0]


@pytest.fixture(scope="session")
def results(written: tuple[Path, Results]) -> Results:
    """Return the numbers."""
    return written[1]
