"""What is in a map file, for us and for others."""

import re

import h5py
import numpy as np
import pytest
import xarray
from blake3 import blake3

import lutgen
from lutgen.errors import InputError
from lutgen.quantities import CHANNELS
from tests.fixtures.places import ROOT
from tests.fixtures.recipes import tripod


def test_a_map_holds_what_evaluate_says_at_every_node(swept):
    for name in ("cone.h5", "sphere.h5", "alone.h5"):
        stability_map = lutgen.load_map(swept / name)
        recipe = stability_map.recipe
        want = lutgen.evaluate(
            recipe,
            recipe.grid.params(np.arange(recipe.grid.size)),
            recipe.chart.directions().reshape(-1, 3),
            recipe.channels,
        )
        for channel in recipe.channels:
            got = stability_map[channel]
            assert got.shape == (4, 3, *recipe.chart.shape)
            assert got.dtype == (np.uint8 if channel == "status" else np.float32)
            np.testing.assert_allclose(
                got.reshape(want[channel].shape), want[channel], rtol=1e-6, atol=1e-9
            )  # float32


def test_a_sweep_returns_the_map_and_says_in_short_what_it_is(tmp_path):
    recipe = lutgen.parse_recipe(tripod(channels=CHANNELS, nodes=9, max_tilt=60.0))
    stability_map = lutgen.sweep(recipe, tmp_path / "a.h5")
    assert stability_map.path == str(tmp_path / "a.h5")
    assert stability_map.recipe.digest == recipe.digest
    assert stability_map.axes == recipe.grid.axes
    assert stability_map.channels == CHANNELS
    said = repr(stability_map)
    assert "tripod (reach: 4, swing: 3, face: 1, v: 9, u: 9) sdg" in said
    assert len(said) < 160
    page = stability_map._repr_html_()
    assert "0 to 0.6" in page
    assert "&lt;StabilityMap tripod" in page
    with pytest.raises(InputError, match="no channel 'bogus'"):
        stability_map["bogus"]


def test_the_root_attributes_are_those_of_the_format_and_of_its_document(swept):
    recipe = lutgen.parse_recipe(tripod(channels=CHANNELS, nodes=9, max_tilt=60.0))
    page, _ = (ROOT / "docs/reference/format.md").read_text("utf-8").split("# The C tables")
    with h5py.File(swept / "cone.h5", "r") as file:
        found = dict(file.attrs)
        assert {*found, "urdf"} == set(re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE))
        assert found.pop("digest").startswith("lutgen-digest-3 at=")
        assert found == {
            "Conventions": "CF-1.10",
            "title": "stability map of tripod",
            "history": f"computed by `lutgen sweep` of lutgen {lutgen.__version__}",
            "lutgen_format": 2,
            "lutgen_definition": 3,
            "lutgen_version": lutgen.__version__,
            "recipe": recipe.text,
            "recipe_sha256": recipe.digest,
            "chart": "cone",
            "complete": 1,
        }


def test_values_are_contiguous_without_filters_and_end_the_file(swept):
    content = (swept / "cone.h5").read_bytes()
    with h5py.File(swept / "cone.h5", "r") as file:
        end = file["sdg"].id.get_offset()
        for name in CHANNELS:
            variable = file[name]
            assert (variable.chunks, variable.compression, variable.fletcher32) == (None,) * 2 + (
                False,
            )
            assert variable.id.get_offset() == end
            end += variable.nbytes
            start = variable.id.get_offset()
            assert content[start:end] == variable[...].astype(variable.dtype).tobytes()
            fill = variable.attrs.get("_FillValue")
            assert fill is None if name == "status" else np.isnan(fill).all()
        assert file["status"].dtype == np.uint8
        assert file["status"].attrs["flag_meanings"] == "stands rocks tips"
    assert end == len(content)


def test_digests_are_those_of_the_document(swept):
    # docs/reference/format.md, followed without our code.
    content = (swept / "cone.h5").read_bytes()
    with h5py.File(swept / "cone.h5", "r") as file:
        words = dict(word.split("=") for word in str(file.attrs["digest"]).split()[1:])
        digests = file["seal/blocks"][...]
        facts = [file.attrs[k] for k in ("recipe_sha256", "lutgen_definition", "lutgen_version")]
        facts.append(file["seal/blocks"].attrs["rows"])
        for index, name in enumerate(CHANNELS):
            text = "\n".join(map(str, ["lutgen block", *facts, name, 0]))
            start = file[name].id.get_offset()
            values = content[start : start + file[name].nbytes]
            want = blake3(values, key=blake3(text.encode()).digest()).digest()
            assert digests[0, index].tobytes() == want
        assert int(words["head"]) == file["sdg"].id.get_offset()
    assert int(words["size"]) == len(content)
    assert content.index(b"lutgen-digest-3 at=") == int(words["at"])
    head = content[: int(words["head"])].replace(words["blake3"].encode(), b"0" * 64)
    assert blake3(head).hexdigest() == words["blake3"]


def test_xarray_opens_a_map_as_the_map_gives_it(swept):
    data = lutgen.load_map(swept / "cone.h5").to_xarray()
    with xarray.open_dataset(swept / "cone.h5", engine="h5netcdf") as want:
        assert set(want.data_vars) == set(CHANNELS)
        assert set(want.coords) == {"reach", "swing", "face", "v", "u"}
        assert set(data.variables) == set(want.variables)
        for name, variable in want.variables.items():
            ours = data.variables[name]
            assert (ours.dims, ours.dtype) == (variable.dims, variable.dtype)
            np.testing.assert_array_equal(ours.values, variable.values)
            for key in ("units", "long_name"):
                assert ours.attrs[key] == variable.attrs[key]
        units = {name: want[name].attrs["units"] for name in want.variables}
        assert set(want.attrs) - set(data.attrs) == {"digest", "complete"}
    assert units == {
        **dict.fromkeys(("sdg", "height", "margin", "energy_margin", "reach"), "m"),
        **dict.fromkeys(("tip_angle", "swing"), "rad"),
        **dict.fromkeys(("least_share", "facet", "status", "face", "v", "u"), "1"),
    }
    # Level ground: no tilt, at the smallest reach and the middle swing.
    level = data.sel(reach=0.0, face=0).isel(swing=1).sel(u=0.0, v=0.0)
    recipe = lutgen.load_map(swept / "cone.h5").recipe
    params = [[axis.knots[k] for axis, k in zip(recipe.grid.axes, (0, 1), strict=True)]]
    exact = lutgen.evaluate(recipe, params, [[0, 0, -1]], CHANNELS)
    for name in CHANNELS:
        assert float(level[name]) == pytest.approx(exact[name][0, 0], rel=1e-6)  # float32
