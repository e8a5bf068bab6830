"""The paper's report, written once, and the numbers that it shows."""

from functools import partial

import pytest

from lutgen import plot
from lutgen.paper import report as report_module
from tests.fixtures.commands import stdout


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """Run `lutgen paper` into a folder that holds somebody else's file, too; return its numbers."""
    folder, numbers, compute = tmp_path_factory.mktemp("paper"), [], report_module.compute
    (folder / "mine.txt").write_text("not the report's")

    def noted(*given):
        numbers.append(compute(*given))
        return numbers[0]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_module, "compute", noted)
        # Encoding pictures of full size takes a quarter of the time.
        patch.setattr(plot, "save", partial(plot.save, dpi=40))
        assert stdout("paper", "-o", folder) == f"{folder / 'paper.html'}\n"
    assert (folder / "mine.txt").read_text() == "not the report's"
    return folder, numbers[0]


@pytest.fixture(scope="session")
def report(written):
    """Return the folder of the report."""
    return written[0]


@pytest.fixture(scope="session")
def results(written):
    """Return the numbers of the report."""
    return written[1]
