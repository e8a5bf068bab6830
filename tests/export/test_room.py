"""The room of a pose: what is given up for want of it, on the chip as in the certificate."""

import subprocess
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import lutgen
from firmware_export.contacts import INFO as contacts
from firmware_export.contacts.codec import LIMITS
from firmware_export.emit import package
from firmware_export.host import STANDS
from firmware_export.truth import Model
from tests.fixtures.compiled import HostLibrary
from tests.fixtures.exports import host_of
from tests.fixtures.places import MAPS
from tests.fixtures.quadruped import quadruped

OK, TIPS = 0, 2


@cache
def export_of(name):
    recipe = quadruped() if name == "quadruped" else lutgen.load_recipe(MAPS / f"{name}.toml")
    return contacts.export(Model(recipe), name, ("tip_angle",))


def queries(export, postures, each):
    rng = np.random.default_rng(11)
    t = rng.random((postures, export.model.k))
    params = np.repeat(export.model.at(t), each, axis=0).astype(np.float32)
    gravity = rng.normal(size=(len(params), 3))
    gravity[:, 2] = -1.5 * np.abs(gravity[:, 2])
    return params, gravity.astype(np.float32)


def read_alike(export, folder, asked):
    """Return what certificates read; what was written to the folder answers so bit by bit."""
    status, reading = host_of(export).read(*asked)
    own_status, own_reading = HostLibrary(folder).read(*asked)
    assert status.tobytes() == own_status.tobytes()
    assert reading.tobytes() == own_reading.tobytes()
    return status, reading


@pytest.mark.needs("gcc")
def test_what_an_export_gives_up_the_certificate_gives_up_too(tmp_path):
    whole = export_of("marv")
    few = whole.tables.room._replace(gaps=1)
    small = replace(whole, tables=replace(whole.tables, room=few))
    package.write(small, tmp_path / "out")
    asked = queries(whole, 400, 20)
    status, reading = read_alike(small, tmp_path / "out", asked)
    more, tip = (one.copy() for one in host_of(whole).read(*asked))
    safe, could = np.isin(status, STANDS), np.isin(more, STANDS)
    assert not (safe & ~could).any()
    # Arcs of one wall may differ in their ends: by what rounding does to their directions.
    assert (reading[:, 1] <= tip[:, 1] + 4e-7)[safe].all()
    # Gaps are given up, and the rests beside them stay.
    assert 0 < (could & ~safe).sum() < 0.1 * could.sum()


@pytest.mark.needs("gcc")
@pytest.mark.parametrize("name", ["marv", "markhor", "quadruped", "tractor"])
def test_an_export_that_knows_its_robot_answers_as_code_for_any(name, tmp_path):
    # Certificates read with arrays that are larger than those of an export; absolem's and
    # articulated's are compared in tests/runtime.
    export = export_of(name)
    package.write(export, tmp_path / "out")
    read_alike(export, tmp_path / "out", queries(export, 8_000, 8))


@pytest.mark.parametrize("name", ["marv", "absolem", "quadruped"])
def test_hardly_a_posture_needs_more_room(name):
    whole = export_of(name)
    everything = replace(whole, tables=replace(whole.tables, room=LIMITS))
    given, enough = (host_of(one).read(*queries(one, 10_000, 1))[0] for one in (whole, everything))
    assert (given == enough).mean() > 0.9995


@pytest.mark.needs("gcc")
def test_a_robot_that_stands_nowhere_compiles_without_a_warning(tmp_path):
    # Its centre of mass is below all contacts: no posture has a facet to make room for.
    corners = ((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2))
    text = '[robot]\nname = "hung"\nlength_unit = "m"\n[[robot.link]]\nname = "body"\nmass = 3.0\n'
    text += "com = [0, 0, -2.0]\n" + "".join(
        f'[[robot.contact]]\nname = "c{n}"\nlink = "body"\nposition = [{x}, {y}, -0.3]\n'
        for n, (x, y) in enumerate(corners)
    )
    recipe = lutgen.parse_recipe(
        text + '[sweep.gravity]\nchart = "sphere"\nnodes = 3\nchannels = ["tip_angle"]\n'
    )
    export = contacts.export(Model(recipe), "hung", ("tip_angle",))
    package.write(export, tmp_path / "out")
    words = "gcc -std=c99 -O2 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -I. -c hung.c"
    done = subprocess.run(words.split(), cwd=tmp_path / "out", capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    status, reading = host_of(export).read(*queries(export, 1, 50))
    assert set(status.tolist()) == {TIPS}
    assert (reading[:, 1] == -np.float32(np.pi)).all()
