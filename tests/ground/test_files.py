"""Files are whole or not there, and never in the place of what lutgen did not make."""

import os
import re
from pathlib import Path

import pytest

from lutgen import bounds, files
from lutgen.errors import InputError
from tests.fixtures.places import ROOT

MARKED = b"\x89PNG\r\n\x1a\n....tEXtSoftware\0lutgen...."


def foreign(path):
    path.write_bytes(b"my thesis")
    return path


def test_a_file_of_somebody_else_stays_unless_force_is_said(tmp_path):
    path = foreign(tmp_path / "thesis.txt")
    with pytest.raises(InputError, match=r"thesis\.txt: is there already.*--force"):
        files.write_text(path, "new")
    assert path.read_bytes() == b"my thesis"
    files.write_text(path, "new", force=True)
    assert path.read_bytes() == b"new"
    assert [one.name for one in tmp_path.iterdir()] == ["thesis.txt"]


@pytest.mark.parametrize("kind", ["fifo", "link", "link to nothing"])
def test_a_device_or_a_link_is_never_written_to_nor_replaced(tmp_path, kind):
    path = tmp_path / "out"
    if kind == "fifo":
        os.mkfifo(path)
    else:
        path.symlink_to("victim")
    if kind == "link":
        foreign(tmp_path / "victim")
    before = path.lstat()
    for force in (False, True):
        with pytest.raises(InputError, match=r"is a link|is no file"):
            files.write_bytes(path, b"new", force=force)
    assert path.lstat().st_ino == before.st_ino
    assert all(one.read_bytes() == b"my thesis" for one in tmp_path.glob("victim"))


def test_a_file_with_the_mark_and_one_that_would_not_change_are_replaced_without_a_word(tmp_path):
    files.write_bytes(tmp_path / "a.png", MARKED)
    files.write_bytes(tmp_path / "a.png", MARKED + b"other")
    assert (tmp_path / "a.png").read_bytes().endswith(b"other")
    files.write_text(tmp_path / "a.csv", "x\n1\n")
    files.write_text(tmp_path / "a.csv", "x\n1\n")
    with pytest.raises(InputError, match="is there already"):
        files.write_text(tmp_path / "a.csv", "x\n2\n")
    (tmp_path / "b").write_bytes(b"tEXtSoftware\0lutgen, the story of a mark")
    assert not files.is_ours(tmp_path / "b")


def test_a_name_that_is_taken_meanwhile_is_left_alone(tmp_path, monkeypatch):
    path, fdopen = tmp_path / "late", os.fdopen

    def taken(handle, mode):
        if not path.exists():
            foreign(path)
        return fdopen(handle, mode)

    monkeypatch.setattr(os, "fdopen", taken)
    with pytest.raises(InputError, match="is there already"):
        files.write_text(path, "new")
    assert path.read_bytes() == b"my thesis"
    assert [one.name for one in tmp_path.iterdir()] == ["late"]


def test_temporary_names_cannot_be_foreseen_and_are_opened_only_if_new(tmp_path, monkeypatch):
    opened, plain = [], os.open

    def note(path, flags, *mode):
        opened.append((Path(path).name, flags))
        return plain(path, flags, *mode)

    monkeypatch.setattr(os, "open", note)
    for _ in range(2):
        files.write_text(tmp_path / "a.csv", "x\n")
    written = [(name, flags) for name, flags in opened if flags & os.O_WRONLY]
    assert len({name for name, _ in written}) == len(written) == 2
    assert all(flags & os.O_EXCL and flags & os.O_NOFOLLOW for _, flags in written)


def test_the_reference_lists_every_bound_as_it_is():
    page = (ROOT / "docs/reference/bounds.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| ([\d,]+) \| (.+) \|$", page, re.MULTILINE)
    assert rows == [(name, f"{one.most:,}", one.what) for name, one in bounds.BOUNDS.items()]


def test_a_bound_counts_itself_in_and_names_what_it_got():
    bounds.check(bounds.LEVELS.most, bounds.LEVELS, "--levels", "use fewer")
    with pytest.raises(InputError, match=r"--levels: .* 32 .*\(got a number of 5001 digits\)"):
        bounds.check(10**5000, bounds.LEVELS, "--levels", "use fewer")
