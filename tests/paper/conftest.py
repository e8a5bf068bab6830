"""The paper's report, written once."""

from functools import partial

import pytest
from click.testing import CliRunner

from lutgen import plot
from lutgen.cli import main


@pytest.fixture(scope="session")
def report(tmp_path_factory):
    """Run `lutgen paper` into a folder that holds somebody else's file, too."""
    folder = tmp_path_factory.mktemp("paper")
    (folder / "mine.txt").write_text("not the report's")
    with pytest.MonkeyPatch.context() as patch:
        # Encoding pictures of full size takes a quarter of the time.
        patch.setattr(plot, "save", partial(plot.save, dpi=40))
        done = CliRunner().invoke(main, ["paper", "-o", str(folder)])
    assert done.exit_code == 0, done.output
    assert done.stdout.strip() == str(folder / "paper.html")
    assert (folder / "mine.txt").read_text() == "not the report's"
    return folder
