"""The map file: what others read in it, what is refused, and what `read` interpolates."""

import hashlib
import re
import shutil
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from blake3 import blake3

import lutgen
from lutgen.errors import InputError, MapFileError
from lutgen.mapping.checksum import fletcher32
from lutgen.mapping.map import StabilityMap
from lutgen.mapping.template import FORMAT
from lutgen.mapping.verification import verify
from lutgen.recipe import recipe_digest
from tests.fixtures.maps import unseal
from tests.fixtures.recipes import ALL_CHANNELS, rover, tripod


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with three maps that no test changes."""
    path = tmp_path_factory.mktemp("maps")
    cone = tripod(channels=ALL_CHANNELS, nodes=9, max_tilt=60.0)
    lutgen.sweep(lutgen.parse_recipe(cone), path / "cone.h5")
    sphere = tripod(channels=("sdg", "tip_angle", "height"), chart="sphere", nodes=5)
    lutgen.sweep(lutgen.parse_recipe(sphere), path / "sphere.h5")
    alone = tripod(channels=("sdg",), nodes=9, max_tilt=60.0)
    lutgen.sweep(lutgen.parse_recipe(alone), path / "alone.h5")
    return path


@pytest.fixture
def cone(folder: Path) -> StabilityMap:
    """Return the map with all channels over a cone."""
    return lutgen.load_map(folder / "cone.h5")


@pytest.fixture
def copy(folder: Path, tmp_path: Path) -> Path:
    """Return a copy of the cone map to be damaged."""
    return Path(shutil.copy(folder / "cone.h5", tmp_path / "copy.h5"))


@pytest.fixture
def unsealed(copy: Path) -> Path:
    """Return a copy without a digest, as of an earlier lutgen, to be edited through HDF5."""
    unseal(copy)
    return copy


def refusal(path: Path) -> str:
    """Load a map that must be refused in any case; return the sentence, which names the file."""
    with pytest.raises(MapFileError) as caught:
        lutgen.load_map(path, unsealed=True)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message


# What others see.


def test_xarray_opens_a_map_with_coordinates_and_units(folder: Path) -> None:
    recipe = lutgen.parse_recipe(tripod())
    with xarray.open_dataset(folder / "cone.h5", engine="h5netcdf") as data:
        assert set(data.data_vars) == set(ALL_CHANNELS)
        assert set(data.coords) == {"reach", "swing", "face", "v", "u"}
        for name in ALL_CHANNELS:
            assert data[name].dims == ("reach", "swing", "face", "v", "u")
            assert data[name].dtype == (np.uint8 if name == "status" else np.float32)
            assert data[name].attrs["long_name"]
        units = {name: data[name].attrs["units"] for name in data.variables}
        assert units == {
            **dict.fromkeys(("sdg", "height", "margin", "energy_margin", "reach"), "m"),
            **dict.fromkeys(("tip_angle", "swing"), "rad"),
            **dict.fromkeys(("facet", "status", "face", "v", "u"), "1"),
        }
        for axis in recipe.grid.axes:
            np.testing.assert_array_equal(data[axis.name], axis.knots)
        np.testing.assert_array_equal(data["u"], np.linspace(-1, 1, 9) * np.tan(np.radians(60)))
        # Level ground: no tilt, at the smallest reach and the middle swing.
        level = data.sel(reach=0.0, face=0).isel(swing=1).sel(u=0.0, v=0.0)
        params = [[recipe.grid.axes[0].knots[0], recipe.grid.axes[1].knots[1]]]
        want = lutgen.evaluate(recipe, params, [[0, 0, -1]], ALL_CHANNELS)
        for name in ALL_CHANNELS:
            assert float(level[name]) == pytest.approx(want[name][0, 0], rel=1e-6)  # float32


@pytest.mark.needs("h5dump")
def test_h5dump_prints_the_header_of_a_map(folder: Path) -> None:
    done = subprocess.run(["h5dump", "-H", folder / "sphere.h5"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert 'DATASET "tip_angle"' in done.stdout
    assert "( 4, 3, 6, 5, 5 )" in done.stdout


def test_the_lowest_level_of_hdf5_finds_types_shapes_and_scales(folder: Path) -> None:
    file = h5py.h5f.open(bytes(folder / "sphere.h5"), h5py.h5f.ACC_RDONLY)
    variable = h5py.h5d.open(file, b"tip_angle")
    assert variable.get_type() == h5py.h5t.IEEE_F32LE
    assert variable.get_space().get_simple_extent_dims() == (4, 3, 6, 5, 5)
    assert h5py.h5ds.get_num_scales(variable, 4) == 1


def test_the_root_attributes_are_those_of_the_format(folder: Path) -> None:
    recipe = lutgen.parse_recipe(tripod(channels=ALL_CHANNELS, nodes=9, max_tilt=60.0))
    with h5py.File(folder / "cone.h5", "r") as file:
        assert dict(file.attrs) == {
            "digest": lutgen.load_map(folder / "cone.h5").attributes["digest"],
            "Conventions": "CF-1.10",
            "title": "stability map of tripod",
            "lutgen_format": 1,
            "lutgen_definition": 3,
            "lutgen_version": lutgen.__version__,
            "recipe": recipe.text,
            "recipe_sha256": recipe.digest,
            "chart": "cone",
            "complete": 1,
        }
        fill = file["sdg"].attrs["_FillValue"]
        assert np.isnan(fill).all()
        assert fill.dtype == np.float32


def test_fletcher32_is_the_only_filter_of_a_channel(folder: Path) -> None:
    with h5py.File(folder / "cone.h5", "r") as file:
        for name in ALL_CHANNELS:
            plist = file[name].id.get_create_plist()
            assert plist.get_nfilters() == 1
            assert plist.get_filter(0)[0] == h5py.h5z.FILTER_FLETCHER32
            for index in range(file[name].id.get_num_chunks()):
                # A mask other than 0 would say that the checksum was left out.
                assert file[name].id.get_chunk_info(index).filter_mask == 0


def test_a_map_holds_what_evaluate_says_at_every_node(folder: Path) -> None:
    for name in ("cone.h5", "sphere.h5"):
        stability_map = lutgen.load_map(folder / name)
        recipe = stability_map.recipe
        want = lutgen.evaluate(
            recipe,
            recipe.grid.params(np.arange(recipe.grid.size)),
            recipe.chart.directions().reshape(-1, 3),
            recipe.channels,
        )
        for channel in recipe.channels:
            got = stability_map.channel(channel)
            assert got.shape == (4, 3, *recipe.chart.shape)
            assert got.dtype == (np.uint8 if channel == "status" else np.float32)
            np.testing.assert_allclose(
                got.reshape(want[channel].shape), want[channel], rtol=1e-6, atol=1e-9
            )  # float32


def test_a_map_knows_its_recipe_axes_and_chart(cone: StabilityMap) -> None:
    recipe = lutgen.parse_recipe(tripod(channels=ALL_CHANNELS, nodes=9, max_tilt=60.0))
    assert cone.recipe.digest == recipe.digest
    assert cone.axes == recipe.grid.axes
    assert cone.chart == recipe.chart
    assert cone.channels == ALL_CHANNELS


# What is refused.


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    assert "no such file" in refusal(tmp_path / "none.h5")


def test_a_folder_is_refused(tmp_path: Path) -> None:
    assert "is a folder" in refusal(tmp_path)


@pytest.mark.parametrize(
    "content", [b"", b"not HDF5 at all\n" * 100, b"\x89HDF\r\n\x1a\n" + b"x" * 99]
)
def test_a_file_that_is_no_hdf5_is_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "text.h5"
    path.write_bytes(content)
    assert "cannot be read as HDF5" in refusal(path)


def test_hdf5_of_another_program_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "foreign.h5"
    with h5py.File(path, "w") as file:
        file["sdg"] = np.zeros((2, 2))
        file.create_group("a group")
    assert "no lutgen map" in refusal(path)


@pytest.mark.parametrize("found", [FORMAT + 1, 0, "1", [1, 2]])
def test_another_format_is_refused(unsealed: Path, found: object) -> None:
    with h5py.File(unsealed, "r+") as file:
        file.attrs["lutgen_format"] = found
    assert "format" in refusal(unsealed)


@pytest.mark.parametrize("found", [None, 1, 2, "3"], ids=repr)
def test_a_map_by_another_definition_is_refused(unsealed: Path, found: object) -> None:
    with h5py.File(unsealed, "r+") as file:
        del file.attrs["lutgen_definition"]
        if found is not None:
            file.attrs["lutgen_definition"] = found
    message = refusal(unsealed)
    assert "another definition of what stands" in message
    assert f"lutgen_definition = {'none' if found is None else found}," in message
    assert message.endswith("sweep it again")


@pytest.mark.parametrize("complete", [0, None, [1, 1]])
def test_an_incomplete_map_is_refused(unsealed: Path, complete: object) -> None:
    with h5py.File(unsealed, "r+") as file:
        del file.attrs["complete"]
        if complete is not None:
            file.attrs["complete"] = complete
    assert "--resume" in refusal(unsealed)


def test_a_recipe_that_does_not_match_its_digest_is_refused(unsealed: Path) -> None:
    with h5py.File(unsealed, "r+") as file:
        file.attrs["recipe"] = str(file.attrs["recipe"]).replace("-40.0", "-41.0")
    assert "digest" in refusal(unsealed)


@pytest.mark.parametrize("value", [np.zeros(0, np.uint8), np.ones((3, 3)), h5py.Empty("f")])
def test_a_digest_of_a_recipe_that_is_no_text_is_refused(unsealed: Path, value: object) -> None:
    with h5py.File(unsealed, "r+") as file:
        file.attrs["recipe_sha256"] = value
    assert "does not match its digest" in refusal(unsealed)


@pytest.mark.parametrize("name", ["recipe", "recipe_sha256"])
def test_a_map_without_its_recipe_is_refused(unsealed: Path, name: str) -> None:
    with h5py.File(unsealed, "r+") as file:
        del file.attrs[name]
    assert "damaged" in refusal(unsealed)


def test_a_channel_of_another_shape_is_refused(unsealed: Path) -> None:
    with h5py.File(unsealed, "r+") as file:
        del file["sdg"]
        file["sdg"] = np.zeros((4, 3, 1, 9, 8), np.float32)
    assert "(4, 3, 1, 9, 8)" in refusal(unsealed)


def test_a_missing_channel_is_refused(unsealed: Path) -> None:
    with h5py.File(unsealed, "r+") as file:
        del file["margin"]
    assert "channel margin" in refusal(unsealed)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.999])
def test_a_truncated_file_is_refused(copy: Path, share: float) -> None:
    content = copy.read_bytes()
    copy.write_bytes(content[: int(share * len(content))])
    assert "cannot be read" in refusal(copy)


def flip(path: Path, channel: str, place: float) -> None:
    """Flip one bit of a channel's chunk, `place` of the way through it."""
    with h5py.File(path, "r") as file:
        chunk = file[channel].id.get_chunk_info(0)
    with path.open("r+b") as file:
        at = chunk.byte_offset + int(place * (chunk.size - 1))
        file.seek(at)
        byte = file.read(1)[0]
        file.seek(at)
        file.write(bytes([byte ^ 0x10]))


@pytest.mark.parametrize("place", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("channel", ALL_CHANNELS)
def test_verify_catches_a_flipped_bit_in_any_channel(
    copy: Path, channel: str, place: float
) -> None:
    verify(lutgen.load_map(copy))
    flip(copy, channel, place)
    stability_map = lutgen.load_map(copy)
    with pytest.raises(MapFileError, match=rf"{copy}: channel {channel} .*damaged"):
        verify(stability_map)
    with pytest.raises(MapFileError, match=f"channel {channel}"):
        stability_map.channel(channel)


def test_verify_looks_at_the_file_though_its_values_are_in_memory(copy: Path) -> None:
    stability_map = lutgen.load_map(copy)
    before = stability_map.channel("sdg").copy()
    flip(copy, "sdg", 0.3)
    with pytest.raises(MapFileError, match="channel sdg"):
        verify(stability_map)
    assert np.isfinite(before).any()


# The digest.


def test_a_map_without_a_digest_is_read_where_that_is_asked_for_and_never_verified(
    unsealed: Path,
) -> None:
    with pytest.raises(MapFileError, match="is not sealed") as caught:
        lutgen.load_map(unsealed)
    assert "\n" not in str(caught.value)
    stability_map = lutgen.load_map(unsealed, unsealed=True)
    assert np.isfinite(stability_map.channel("tip_angle")).all()
    with pytest.raises(MapFileError, match="without a digest"):
        verify(stability_map)


def test_a_map_that_was_sealed_in_the_earlier_way_has_to_be_swept_again(copy: Path) -> None:
    copy.write_bytes(copy.read_bytes().replace(b"lutgen-digest-2", b"lutgen-digest-1"))
    assert "sealed in another way (got lutgen-digest-1" in refusal(copy)


# What lies somewhere else.


@pytest.mark.parametrize("how", ["external storage", "a virtual dataset", "a link", "soft", "deep"])
def test_a_map_that_reaches_outside_of_itself_is_refused(
    how: str, folder: Path, unsealed: Path, tmp_path: Path
) -> None:
    secret = tmp_path / "secret"
    secret.write_bytes(bytes(range(256)) * 4096)
    with h5py.File(unsealed, "r+") as file:
        shape = file["sdg"].shape
        del file["sdg"]
        if how == "external storage":
            file.create_dataset("sdg", shape, "<f4", external=[(str(secret), 0, 1 << 20)])
        elif how == "a virtual dataset":
            layout = h5py.VirtualLayout(shape, "<f4")
            layout[...] = h5py.VirtualSource(str(folder / "cone.h5"), "sdg", shape=shape)
            file.create_virtual_dataset("sdg", layout)
        elif how == "a link":
            file["sdg"] = h5py.ExternalLink(str(folder / "cone.h5"), "/sdg")
        elif how == "soft":
            file["sdg"] = h5py.SoftLink("/tip_angle")
        else:
            file["seal/sdg"] = h5py.ExternalLink(str(folder / "cone.h5"), "/sdg")
    said = refusal(unsealed)
    assert "somewhere else" in said
    assert ("a link" if how in ("soft", "deep") else how) in said


@pytest.mark.parametrize("how", ["contiguous", "zipped", "wide", "claimed"])
def test_values_that_are_stored_in_another_way_are_refused(how: str, unsealed: Path) -> None:
    with h5py.File(unsealed, "r+") as file:
        old, chunks = file["sdg"][...], file["sdg"].chunks
        del file["sdg"]
        options = {"chunks": chunks, "fletcher32": True}
        if how == "contiguous":
            options = {}
        elif how == "zipped":
            options["compression"] = "gzip"
        elif how == "claimed":
            # None of its chunks is there: values for which the file has no bytes.
            file.attrs.modify("recipe", file.attrs["recipe"].replace("nodes = 9", "nodes = 999"))
            text = str(file.attrs["recipe"])
            file.attrs.modify("recipe_sha256", recipe_digest(text))
            for name in lutgen.parse_recipe(text).channels:
                if name in file:
                    del file[name]
                many = (*old.shape[:-2], 999, 999)
                kind = "u1" if name == "status" else "<f4"
                file.create_dataset(name, many, kind, chunks=(1, 1, 1, 999, 999), fletcher32=True)
        if how != "claimed":
            kind = "<f8" if how == "wide" else "<f4"
            file.create_dataset("sdg", data=old.astype(kind), **options)
    assert "not stored as a sweep stores it" in refusal(unsealed)


# The digest.


@pytest.mark.parametrize("name", ["title", "units", "knots"])
def test_a_map_that_was_edited_is_refused(copy: Path, name: str) -> None:
    with h5py.File(copy, "r+") as file:
        if name == "title":
            file.attrs.modify("title", "another")
        elif name == "units":
            file["sdg"].attrs.modify("units", "mm")
        else:
            file["reach"][1] += 1e-9
    assert "damaged or was edited" in refusal(copy)


def test_verify_catches_values_that_were_replaced_with_their_checksum(copy: Path) -> None:
    with h5py.File(copy, "r") as file:
        values = file["sdg"][...]
        head = copy.read_bytes()
        values[0] += 1.0
        chunk = file["sdg"].id.get_chunk_info(0)
        raw = np.append(values.ravel(), np.float32(0.0))
    raw[-1:].view(np.uint32)[0] = fletcher32(raw[:-1].view(np.uint16))
    start = chunk.byte_offset
    copy.write_bytes(head[:start] + raw.tobytes() + head[start + raw.nbytes :])
    stability_map = lutgen.load_map(copy)
    np.testing.assert_array_equal(stability_map.channel("sdg"), values)
    with pytest.raises(MapFileError, match="without its digest"):
        verify(stability_map)


def test_verify_refuses_a_block_of_another_map_with_its_checksum(
    folder: Path, copy: Path, tmp_path: Path
) -> None:
    other = tripod(channels=ALL_CHANNELS, nodes=9, max_tilt=59.0)
    lutgen.sweep(lutgen.parse_recipe(other), tmp_path / "other.h5", threads=1)
    content = copy.read_bytes()
    with h5py.File(copy, "r") as file, h5py.File(tmp_path / "other.h5", "r") as foreign:
        to, source = (one["sdg"].id.get_chunk_info(0) for one in (file, foreign))
    foreign_bytes = (tmp_path / "other.h5").read_bytes()
    taken = foreign_bytes[source.byte_offset : source.byte_offset + source.size]
    assert len(taken) == to.size
    copy.write_bytes(content[: to.byte_offset] + taken + content[to.byte_offset + to.size :])
    # HDF5 sees nothing wrong.
    assert lutgen.load_map(copy).channel("sdg").shape
    with pytest.raises(MapFileError, match=r"sdg has values of another map or place"):
        verify(lutgen.load_map(copy))


def test_the_digest_is_that_of_its_definition(folder: Path) -> None:
    # docs/reference/format.md, followed without our code.
    content = (folder / "cone.h5").read_bytes()
    with h5py.File(folder / "cone.h5", "r") as file:
        text = str(file.attrs["digest"])
        digests = file["seal/blocks"][...]
        parts = [str(file.attrs[k]) for k in ("recipe_sha256", "lutgen_definition")]
        parts += [str(file.attrs["lutgen_version"]), " ".join(map(str, file["sdg"].chunks))]
        for index, name in enumerate(ALL_CHANNELS):
            chunk = file[name].id.get_chunk_info(0)
            key = blake3("\n".join(["lutgen block", *parts, name, "0"]).encode()).digest()
            stored = content[chunk.byte_offset : chunk.byte_offset + chunk.size]
            assert digests[0, index].tobytes() == blake3(stored, key=key).digest()
    found = re.fullmatch(r"lutgen-digest-2 head=(\d+) sha256=(\w+)", text)
    assert found is not None
    assert content[: int(found[1])].count(digests.tobytes()) == 1
    head = content[: int(found[1])].replace(found[2].encode(), b"0" * 64)
    assert hashlib.sha256(head).hexdigest() == found[2]


# What `read` interpolates.


@pytest.mark.parametrize("name", ["cone.h5", "sphere.h5", "alone.h5"])
def test_reading_at_the_nodes_gives_the_stored_values(folder: Path, name: str) -> None:
    stability_map = lutgen.load_map(folder / name)
    recipe = stability_map.recipe
    directions = recipe.chart.directions().reshape(-1, 3)
    grid = recipe.grid
    params = np.repeat(grid.params(np.arange(grid.size)), len(directions), axis=0)
    got = stability_map.read(params, np.tile(directions, (grid.size, 1)))
    # A direction comes back from its unit vector within 2e-16, so do the weights.
    for channel in recipe.channels:
        np.testing.assert_allclose(
            got[channel],
            stability_map.channel(channel).ravel(),
            rtol=1e-12,
            atol=1e-12,
            err_msg=channel,
        )


def queries(count: int, tilt: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Random parameters of the tripod, and directions within about 50 deg of straight down."""
    rng = np.random.default_rng(17)
    params = np.column_stack(
        [rng.uniform(0.0, 0.6, count), np.radians(rng.uniform(-40.0, 50.0, count))]
    )
    slope = rng.uniform(-tilt, tilt, (count, 2))
    return params, np.column_stack([slope, np.full(count, -1.0)])


def test_reading_between_the_nodes_of_a_fine_map_is_near_the_exact_value(tmp_path: Path) -> None:
    recipe = lutgen.parse_recipe(tripod("reach = 13, swing = 25", nodes=33, max_tilt=60.0))
    lutgen.sweep(recipe, tmp_path / "fine.h5")
    params, gravity = queries(200)
    got = lutgen.load_map(tmp_path / "fine.h5").read(params, gravity)["tip_angle"]
    want = np.array(
        [
            lutgen.evaluate(recipe, params[k : k + 1], gravity[k], ("tip_angle",))["tip_angle"]
            for k in range(len(params))
        ]
    ).ravel()
    # The angle changes no faster than gravity turns, but has a kink where another axis becomes the
    # nearest: in a cell of 6 deg of tilt that costs at most half of the cell, hardly anything
    # elsewhere.
    assert np.abs(got - want).max() < np.radians(3.0)
    assert np.abs(got - want).mean() < np.radians(0.2)


def test_reading_equals_a_multilinear_mean_of_the_stored_corners(cone: StabilityMap) -> None:
    axis_r, axis_s = cone.axes
    stored = cone.channel("tip_angle")[:, :, 0]
    params = [[axis_r.knots[1] * 0.75 + axis_r.knots[2] * 0.25, axis_s.knots[0] * 0.5]]
    swing = (params[0][1] - axis_s.knots[0]) / (axis_s.knots[1] - axis_s.knots[0])
    u = cone.chart.coords
    at_u, at_v = (u[4] + u[5]) / 2, u[6]
    got = cone.read(params, [[at_u, at_v, -1.0]], ["tip_angle"])["tip_angle"][0]
    want = 0.0
    for i, wi in ((1, 0.75), (2, 0.25)):
        for j, wj in ((0, 1.0 - swing), (1, swing)):
            for k in (4, 5):
                want += 0.5 * wi * wj * float(stored[i, j, 6, k])
    assert got == pytest.approx(want, abs=1e-12)


def test_parameters_beyond_the_axes_are_clamped(cone: StabilityMap) -> None:
    low, high = (np.array([axis.knots[end] for axis in cone.axes]) for end in (0, -1))
    down = [[0.1, 0.05, -1.0]] * 2
    beyond = cone.read([low - 1.0, high + 100.0], down)
    at_the_end = cone.read([low, high], down)
    for name in cone.channels:
        np.testing.assert_array_equal(beyond[name], at_the_end[name])


def test_directions_off_the_chart_read_nan_in_every_channel(cone: StabilityMap) -> None:
    params, _ = queries(3)
    got = cone.read(params, [[0, 0, 1], [1, 0, 0], [1.8, 0, -1]])  # tan 60 deg is 1.73
    for name in cone.channels:
        assert np.isnan(got[name]).all(), name


def test_gravity_may_have_any_length(cone: StabilityMap) -> None:
    params, gravity = queries(20)
    short, long = (cone.read(params, gravity * size) for size in (1e-3, 9.81e4))
    for name in cone.channels:
        np.testing.assert_allclose(short[name], long[name], rtol=1e-9, atol=1e-12)


def test_facet_is_that_of_the_nearest_node(cone: StabilityMap) -> None:
    params, gravity = queries(500, 1.6)
    index = [
        np.abs(axis.knots[None] - params[:, k, None]).argmin(axis=1)
        for k, axis in enumerate(cone.axes)
    ]
    u, v = (np.abs(cone.chart.coords[None] - gravity[:, k, None]).argmin(axis=1) for k in (0, 1))
    want = cone.channel("facet")[index[0], index[1], 0, v, u]
    assert {-1.0, 0.0} <= set(want.tolist())
    np.testing.assert_array_equal(cone.read(params, gravity)["facet"], want)


def test_factor_and_height_are_nan_exactly_where_the_angle_says_that_it_tips(
    cone: StabilityMap,
) -> None:
    params, gravity = queries(2000, 0.8)
    got = cone.read(params, gravity)
    tips = got["tip_angle"] < 0.0
    assert 0.1 < tips.mean() < 0.9
    np.testing.assert_array_equal(np.isnan(got["sdg"]), tips)
    np.testing.assert_array_equal(np.isnan(got["height"]), tips)
    # The rule holds for a factor that is read alone, too.
    alone = cone.read(params, gravity, ["sdg"])["sdg"]
    np.testing.assert_array_equal(alone, got["sdg"])


def test_without_the_angle_the_factor_is_nan_where_most_of_the_cell_tips(folder: Path) -> None:
    alone = lutgen.load_map(folder / "alone.h5")
    together = lutgen.load_map(folder / "cone.h5")
    params, gravity = queries(2000, 0.8)
    without = np.isnan(alone.read(params, gravity)["sdg"])
    tips = together.read(params, gravity)["tip_angle"] < 0.0
    assert 0.1 < without.mean() < 0.9
    # Two rules for the same boundary: they differ only within half a cell of it.
    assert (without == tips).mean() > 0.9


def test_seams_of_the_sphere_are_crossed_without_a_jump(folder: Path) -> None:
    sphere = lutgen.load_map(folder / "sphere.h5")
    rng = np.random.default_rng(8)
    on_seam = np.column_stack([np.ones(200), rng.uniform(-0.9, 0.9, 200), -np.ones(200)])
    either = [on_seam * (1.0 + step, 1.0, 1.0) for step in (-1e-9, 1e-9)]
    params = np.tile([[0.2, 0.1]], (200, 1))
    one, other = (sphere.read(params, side, ["tip_angle"])["tip_angle"] for side in either)
    # The chart's slope is about 1 rad per unit: 1e-8 is ten times the step.
    np.testing.assert_allclose(one, other, atol=1e-8)


@pytest.mark.parametrize(
    ("params", "gravity"),
    [
        ([[0.1]], [[0, 0, -1]]),
        ([[0.1, 0.2, 0.3]], [[0, 0, -1]]),
        ([[[0.1, 0.2]]], [[0, 0, -1]]),
        ([[0.1, 0.2]] * 2, [[0, 0, -1]]),
        ([[0.1, 0.2]], [0, 0, -1]),
        ([[0.1, 0.2]], [[0, 0]]),
        ([[0.1, 0.2]], [[0, 0, 0]]),
        ([[0.1, 0.2]], [[0, 0, np.nan]]),
        ([[0.1, np.nan]], [[0, 0, -1]]),
    ],
)
def test_wrong_arguments_of_read_are_refused(
    cone: StabilityMap, params: object, gravity: object
) -> None:
    with pytest.raises(InputError, match=r"\(got "):
        cone.read(params, gravity)  # type: ignore[arg-type]


def test_an_unknown_channel_is_refused(folder: Path) -> None:
    alone = lutgen.load_map(folder / "alone.h5")
    with pytest.raises(InputError, match="no channel 'height'"):
        alone.channel("height")
    with pytest.raises(InputError, match="no channel 'tip_angle'"):
        alone.read([[0.1, 0.2]], [[0, 0, -1]], ["tip_angle"])


def test_a_map_of_round_contacts_is_written_and_read_like_any_other(tmp_path: Path) -> None:
    recipe = lutgen.parse_recipe(rover(channels=ALL_CHANNELS, nodes=9, max_tilt=60.0))
    lutgen.sweep(recipe, tmp_path / "rover.h5")
    stability_map = lutgen.load_map(tmp_path / "rover.h5")
    directions = recipe.chart.directions().reshape(-1, 3)
    want = lutgen.evaluate(recipe, [[0.4]], directions, ("tip_angle", "sdg"))
    got = stability_map.read(np.full((len(directions), 1), 0.4), directions)
    clear = np.abs(want["tip_angle"][0]) > 1e-9
    for name in ("tip_angle", "sdg"):
        np.testing.assert_allclose(got[name][clear], want[name][0][clear], rtol=1e-6, atol=1e-9)


def test_two_sweeps_a_second_apart_write_the_same_bytes(tmp_path: Path) -> None:
    recipe = lutgen.parse_recipe(tripod())
    for name in ("first.h5", "second.h5"):
        lutgen.sweep(recipe, tmp_path / name)
        # HDF5 keeps times in whole seconds.
        time.sleep(1.1)
    assert (tmp_path / "first.h5").read_bytes() == (tmp_path / "second.h5").read_bytes()
