"""Files that are refused, each in a sentence of its own, and what is read all the same."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import dask
import h5py
import numpy as np
import pytest
import xarray

import lutgen
from lutgen.errors import MapFileError
from lutgen.mapping import verify
from lutgen.mapping.head import BLANK, sealed
from lutgen.quantities import CHANNELS
from tests.fixtures.commands import broken_off
from tests.fixtures.recipes import tripod


@pytest.fixture
def copy(swept, tmp_path):
    return Path(shutil.copy(swept / "cone.h5", tmp_path / "copy.h5"))


def refusal(path, unsealed=False):
    """Load a map that must be refused; return the sentence, which names the file."""
    with pytest.raises(MapFileError) as caught:
        lutgen.load_map(path, unsealed)
    assert str(caught.value).startswith(f"{path}: ")
    return str(caught.value)


def flip(content, place):
    return content[:place] + bytes([content[place] ^ 0x10]) + content[place + 1 :]


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda whole: b"", "is no HDF5 file"),
        (lambda whole: b"not HDF5 at all\n" * 100, "is no HDF5 file"),
        (lambda whole: b"\x89HDF\r\n\x1a\n" + b"x" * 99, "has no seal .*--unsealed"),
        (lambda whole: whole.replace(b"digest-3", b"digest-2"), "has map format 1, .*sweep it"),
        (
            lambda whole: whole.replace(b"digest-3", b"digest-4"),
            "has a later map format, .*sweep it",
        ),
        (lambda whole: whole[: len(whole) // 2], "is cut off"),
        (lambda whole: whole[:-1], "is cut off"),
        (lambda whole: whole[:2000], "is cut off"),
        (lambda whole: whole + b"x", "rewritten or edited by another program"),
        (lambda whole: flip(whole, 40), "does not match its digest .*damaged or was edited"),
        (lambda whole: flip(whole, 5000), "head that does not match its digest"),
    ],
)
def test_bytes_that_are_no_whole_map_are_refused(made, said, copy):
    copy.write_bytes(made(copy.read_bytes()))
    assert re.search(said, refusal(copy))


def test_what_is_no_file_and_an_unfinished_one_are_refused_with_the_way_out(tmp_path):
    assert "no such file" in refusal(tmp_path / "none.h5")
    assert "is a folder" in refusal(tmp_path)
    broken_off(lutgen.parse_recipe(tripod()), tmp_path / "a.h5")
    for unsealed in (False, True):
        assert re.search("is not complete .*--resume", refusal(tmp_path / "a.h5.part", unsealed))


REWRITTEN = {
    "h5repack": ["h5repack"],
    "h5repack with gzip": ["h5repack", "-f", "GZIP=4"],
    "xarray": [],
    "edited": [],
}


@pytest.mark.parametrize("how", REWRITTEN)
def test_a_map_that_another_program_has_rewritten_is_said_to_be_and_can_be_read(
    how, swept, tmp_path
):
    whole, path = swept / "cone.h5", tmp_path / "rewritten.h5"
    if REWRITTEN[how]:
        if shutil.which("h5repack") is None:
            pytest.skip("needs h5repack")
        subprocess.run([*REWRITTEN[how], whole, path], check=True)
    elif how == "xarray":
        # The cluster of another test is not asked for a lock.
        alone = dask.config.set(scheduler="synchronous")
        with alone, xarray.open_dataset(whole, engine="h5netcdf") as data:
            data.to_netcdf(path, engine="h5netcdf")
    else:
        shutil.copy(whole, path)
        with h5py.File(path, "r+") as file:
            file.attrs["comment"] = "mine"
    said = refusal(path)
    assert "was rewritten or edited by another program" in said
    assert "damage" not in said
    want, got = lutgen.load_map(whole), lutgen.load_map(path, unsealed=True)
    for name in CHANNELS:
        np.testing.assert_array_equal(got[name], want[name])
    with pytest.raises(MapFileError, match="rewritten"):
        verify(got)


def test_a_map_that_another_process_writes_to_is_not_called_damaged(copy):
    code = "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); print(flush=True); input()"
    other = subprocess.Popen(
        [sys.executable, "-c", code, str(copy)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with other:
        other.stdout.readline()
        assert "is open for writing in another program" in refusal(copy)
        other.communicate("\n")
    assert lutgen.load_map(copy).channels


@pytest.mark.parametrize("place", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("channel", CHANNELS)
def test_a_flipped_bit_in_any_channel_is_found_when_it_is_read(copy, channel, place):
    before = lutgen.load_map(copy)
    assert before[channel].size
    with h5py.File(copy, "r") as file:
        at = file[channel].id.get_offset() + int(place * (file[channel].nbytes - 1))
    copy.write_bytes(flip(copy.read_bytes(), at))
    stability_map = lutgen.load_map(copy)
    for read in (verify, lambda one: one[channel]):
        with pytest.raises(MapFileError, match=rf"{copy}: channel {channel} .*damaged"):
            read(stability_map)
    # The file is looked at, though its values are in memory.
    with pytest.raises(MapFileError, match="damaged"):
        verify(before)
    assert all(stability_map[name].size for name in CHANNELS if name != channel)


def test_values_of_another_map_are_not_those_of_this_one(copy, tmp_path):
    other = tripod(channels=CHANNELS, nodes=9, max_tilt=59.0)
    lutgen.sweep(lutgen.parse_recipe(other), tmp_path / "other.h5")
    foreign, content = (tmp_path / "other.h5").read_bytes(), copy.read_bytes()
    with h5py.File(copy, "r") as file, h5py.File(tmp_path / "other.h5", "r") as there:
        start, size = file["seal/blocks"].id.get_offset(), file["seal/blocks"].nbytes
        source, head = there["seal/blocks"].id.get_offset(), file["sdg"].id.get_offset()
        values = there["sdg"].id.get_offset()
    # Its values and its digests, under a new seal: only the key of a digest tells.
    made = content[:start] + foreign[source : source + size] + content[start + size : head]
    blank = re.sub(rb"lutgen-digest-3 at=.*blake3=\w{64}", BLANK.encode(), made)
    copy.write_bytes(sealed(blank, len(content)) + foreign[values:])
    with pytest.raises(MapFileError, match="channel sdg has values that do not match"):
        verify(lutgen.load_map(copy))


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("lutgen_format", 1, "no lutgen map of this format .*make it again"),
        ("lutgen_format", [2, 2], "no lutgen map of this format"),
        ("lutgen_format", None, "no lutgen map of this format .got lutgen_format = None"),
        ("lutgen_definition", 2, "another definition of what stands .*make it again"),
        ("complete", 0, "not complete .*--resume"),
        ("recipe", None, "lacks the attribute `recipe`"),
        ("recipe", "x = 1", "recipe does not match its digest"),
        ("recipe_sha256", np.ones((3, 3)), "recipe does not match its digest"),
        ("title", None, "lacks the attribute `title`"),
    ],
)
def test_a_file_that_is_read_without_a_seal_must_be_a_map(copy, key, value, said):
    with h5py.File(copy, "r+") as file:
        del file.attrs[key]
        if value is not None:
            file.attrs[key] = value
    assert re.search(said, refusal(copy, unsealed=True))


@pytest.mark.parametrize("how", ["external", "virtual", "link", "soft", "shape", "type", "none"])
def test_a_channel_that_is_not_in_the_file_as_its_recipe_says_is_refused(
    how, swept, copy, tmp_path
):
    secret = tmp_path / "secret"
    secret.write_bytes(bytes(range(256)) * 4096)
    with h5py.File(copy, "r+") as file:
        shape, values = file["sdg"].shape, file["sdg"][...]
        del file["sdg"]
        if how == "external":
            file.create_dataset("sdg", shape, "<f4", external=[(str(secret), 0, 1 << 20)])
        elif how == "virtual":
            layout = h5py.VirtualLayout(shape, "<f4")
            layout[...] = h5py.VirtualSource(str(swept / "cone.h5"), "sdg", shape=shape)
            file.create_virtual_dataset("sdg", layout)
        elif how == "link":
            file["sdg"] = h5py.ExternalLink(str(swept / "cone.h5"), "/sdg")
        elif how == "soft":
            file["sdg"] = h5py.SoftLink("/tip_angle")
        elif how == "shape":
            file["sdg"] = values[..., :-1]
        elif how == "type":
            file["sdg"] = values.astype("S4")
    assert "channel sdg is not in the file" in refusal(copy, unsealed=True)
