"""The channel `status` in a map: bytes, never interpolated, and what it is to others."""

import builtins
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray

import lutgen
from lutgen.errors import InputError
from lutgen.mapping.map import StabilityMap
from lutgen.mapping.statistics import share_that_tips
from lutgen.mapping.verification import verify
from tests.fixtures.recipes import ALL_CHANNELS, rocker

STANDS, ROCKS, TIPS = 0, 1, 2


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the map of a robot that stands, rocks and tips; 35 x 35 nodes, an odd number."""
    target = tmp_path_factory.mktemp("status") / "rocker.h5"
    text = rocker(channels=ALL_CHANNELS, nodes=35, max_tilt=62.0)
    lutgen.sweep(lutgen.parse_recipe(text), target)
    return target


@pytest.fixture
def stability_map(path: Path) -> StabilityMap:
    return lutgen.load_map(path)


def test_a_map_holds_a_status_as_bytes_that_say_what_they_mean(path: Path) -> None:
    with h5py.File(path, "r") as file:
        status = file["status"]
        assert status.dtype == np.uint8
        assert "_FillValue" not in status.attrs
        assert status.attrs["flag_values"].tolist() == [STANDS, ROCKS, TIPS]
        assert status.attrs["flag_meanings"] == "stands rocks tips"
        assert set(np.unique(status[...])) == {STANDS, ROCKS, TIPS}
        # HDF5 itself checks the sum of a chunk of an odd number of bytes when it reads it.
        assert status.id.get_num_chunks() > 0
        assert (status.chunks[0] * np.prod(status.chunks[1:])) % 2 == 1


def test_the_other_channels_say_the_same_of_what_tips(stability_map: StabilityMap) -> None:
    tips = stability_map.channel("status") == TIPS
    np.testing.assert_array_equal(stability_map.channel("tip_angle") < 0.0, tips)
    np.testing.assert_array_equal(np.isnan(stability_map.channel("sdg")), tips)
    np.testing.assert_array_equal(stability_map.channel("facet") == -1.0, tips)


def test_reading_gives_the_worst_status_of_the_nodes_around(stability_map: StabilityMap) -> None:
    rng = np.random.default_rng(4)
    u, v = rng.uniform(-1.8, 1.8, (2, 4000))
    got = stability_map.read(np.empty((4000, 0)), np.c_[u, v, -np.ones(4000)], ["status"])
    nodes, coords = stability_map.channel("status")[0], stability_map.chart.coords
    column, row = (np.searchsorted(coords, place, "right") - 1 for place in (u, v))
    corners = [nodes[row + i, column + j] for i in (0, 1) for j in (0, 1)]
    want = np.max(corners, axis=0)
    np.testing.assert_array_equal(got["status"], want)
    # Each kind is among them, and not every corner of a cell says the same.
    assert set(want) == {STANDS, ROCKS, TIPS}
    assert (np.min(corners, axis=0) != want).any()


def test_reading_at_a_node_gives_its_own_status(stability_map: StabilityMap) -> None:
    directions = stability_map.chart.directions().reshape(-1, 3)
    got = stability_map.read(np.empty((len(directions), 0)), directions, ["status"])["status"]
    stored = stability_map.channel("status").ravel()
    # Though a direction comes back from its unit vector a hair beside the node.
    np.testing.assert_array_equal(got, stored)
    assert len(set(stored)) == 3


def test_off_the_chart_nothing_is_said(stability_map: StabilityMap) -> None:
    got = stability_map.read(np.empty((1, 0)), [[0.0, 0.0, 1.0]], ["status"])
    assert np.isnan(got["status"]).all()


def test_a_status_alone_tells_which_share_tips(path: Path, tmp_path: Path) -> None:
    recipe = lutgen.parse_recipe(rocker(channels=("status",), nodes=35, max_tilt=62.0))
    lutgen.sweep(recipe, tmp_path / "alone.h5")
    alone = lutgen.load_map(tmp_path / "alone.h5")
    want = share_that_tips(lutgen.load_map(path))
    assert want is not None
    assert 0.1 < want < 0.9
    assert share_that_tips(alone) == pytest.approx(want, abs=1e-12)  # the same sums


def test_verify_catches_a_flipped_bit_of_a_status(path: Path, tmp_path: Path) -> None:
    whole = path.read_bytes()
    with h5py.File(path, "r") as file:
        chunk = file["status"].id.get_chunk_info(0)
    damaged = tmp_path / "damaged.h5"
    # The last value before the checksum is the odd one.
    place = chunk.byte_offset + chunk.size - 5
    damaged.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
    verify(lutgen.load_map(path))
    with pytest.raises(lutgen.MapFileError, match="channel status has values that do not match"):
        verify(lutgen.load_map(damaged))


def test_a_sweep_goes_on_with_blocks_of_bytes_that_are_done(path: Path, tmp_path: Path) -> None:
    text = rocker(channels=ALL_CHANNELS, nodes=35, max_tilt=62.0)
    target = tmp_path / "again.h5"

    def stop(done: int, _: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(lutgen.parse_recipe(text), target, progress=stop)
    lutgen.sweep(lutgen.parse_recipe(text), target, resume=True)
    assert target.read_bytes() == path.read_bytes()


# xarray.


def test_a_dataset_is_what_xarray_reads_from_the_file(
    path: Path, stability_map: StabilityMap
) -> None:
    data = stability_map.to_xarray()
    with xarray.open_dataset(path, engine="h5netcdf") as want:
        # Values, dimensions, coordinates and their attributes.
        assert set(data.variables) == set(want.variables)
        for name, variable in want.variables.items():
            ours = data.variables[name]
            assert ours.dims == variable.dims
            assert ours.dtype == variable.dtype, name
            np.testing.assert_array_equal(ours.values, variable.values)
            for key in ("units", "long_name"):
                assert ours.attrs[key] == variable.attrs[key]
        assert set(want.attrs) - set(data.attrs) == {"digest", "complete"}
    assert data["status"].attrs["flag_meanings"] == "stands rocks tips"
    level = data.sel(face=0).sel(u=0.0, v=0.0, method="nearest")
    assert int(level["status"]) == ROCKS


def test_without_xarray_a_dataset_is_refused_with_a_way_out(
    stability_map: StabilityMap, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name == "xarray":
            raise ImportError("No module named 'xarray'")
        return real(name, *rest)

    monkeypatch.delitem(sys.modules, "xarray")
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=r"needs the package xarray .*pip install xarray"):
        stability_map.to_xarray()
