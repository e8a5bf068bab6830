"""Maps that lack, misname and overstate things, that reach outside of themselves, or are damaged.

Most have lost their seal first: a sealed one is refused for any change, before it is read.
"""

import io
import random
import struct
from typing import Any

import h5py
import numpy as np

from lutgen.mapping import plan
from lutgen.recipe import parse_recipe
from proofs.fuzzing import hostile
from proofs.fuzzing.case import Case
from proofs.fuzzing.hostile import pick
from proofs.fuzzing.recipes import mutated
from proofs.fuzzing.seeds import recipes, swept

__all__ = ["edited", "endless", "make", "unsealed"]

ANY = frozenset((0, 1, 2, 3))
REFUSED = frozenset((1, 2))
SEAL, OTHER = b"lutgen-digest-", b"Lutgen-digest-"
OUTSIDE = ("external", "virtual", "link")
VALUES: tuple[Any, ...] = (
    *("", "x", b"\xff\xfe", 0, -1, 2**63 - 1, float("nan"), 1e308, "a" * 60_000, "[" * 50_000),
    *(np.zeros(0, np.uint8), np.ones((3, 3)), np.array([b"ab", b"c"]), h5py.Empty("f")),
)
# Of the file, of a dataset, then what becomes of the bytes.
CHANGES = (
    *("attribute", "attribute", "no attribute", "own attribute", "recipe", "values", "values"),
    *(
        "shape",
        "type",
        "contiguous",
        "object",
        "filter",
        "drop",
        "rename",
        "soft",
        "group",
        "claim",
    ),
    *OUTSIDE,
)


def unsealed(data: bytes) -> bytes:
    """Return a map without a digest, which HDF5 may edit."""
    assert SEAL in data
    return data.replace(SEAL, OTHER)


def endless(data: bytes) -> bytes:
    """Return a map whose second text has no number and no size: HDF5 goes to it for ever."""
    first = data.index(b"GCOL") + 16
    size = int.from_bytes(data[first + 8 : first + 16], "little")
    second = first + 16 + -(-size // 8) * 8
    return data[:second] + bytes(16) + data[second + 16 :]


def edited(rng: random.Random, data: bytes, what: str) -> bytes:
    """Return a map without a seal in which one thing is changed."""
    memory = io.BytesIO(unsealed(data))
    with h5py.File(memory, "r+") as file:
        if what in ("attribute", "no attribute", "recipe"):
            _attribute(rng, file, what)
        elif what == "claim":
            _claim(rng, file)
        else:
            _dataset(rng, file, what)
    return memory.getvalue()


def _attribute(rng: random.Random, file: Any, what: str) -> None:
    name = pick(rng, sorted(file.attrs))
    if what == "no attribute":
        del file.attrs[name]
    elif what == "attribute":
        file.attrs[name] = pick(rng, VALUES)
    else:
        text = mutated(rng, file.attrs["recipe"])[0]
        try:
            file.attrs["recipe"] = text.replace("\x00", "")[:60_000]
            if rng.random() < 0.7:  # as if it had been swept
                digest = parse_recipe(file.attrs["recipe"], "r.toml").digest
                file.attrs["recipe_sha256"] = digest
        except (ValueError, RecursionError, MemoryError, OSError, RuntimeError):
            pass  # then the map holds what is no recipe


def _claim(rng: random.Random, file: Any) -> None:
    """Let the map say that it has more postures than would fit on a disc."""
    count = pick(rng, (60_000, 3_000, 2**31, 10**12))
    text = recipes()["tripod"].replace("reach = 4, swing = 3", f"reach = {count}, swing = {count}")
    file.attrs["recipe"] = text
    try:
        recipe = parse_recipe(text, "r.toml")
        file.attrs["recipe_sha256"] = recipe.digest
        layout = plan(recipe)
        shape = (*(axis.size for axis in recipe.grid.axes), *recipe.chart.shape)
        for name in recipe.channels:
            old = file[name]
            chunks = getattr(layout, "chunks", None) or old.chunks
            del file[name]
            file.create_dataset(name, shape, "f4", chunks=chunks, fillvalue=np.nan)
    except (ValueError, RecursionError, MemoryError, OSError, TypeError, OverflowError):
        pass  # refused: the recipe alone claims it


def _dataset(rng: random.Random, file: Any, what: str) -> None:
    name = pick(rng, ["sdg", "tip_angle", *sorted(file)])
    old = file[name]
    if not isinstance(old, h5py.Dataset):
        return
    values, attributes = old[...], dict(old.attrs)
    if what == "own attribute":
        old.attrs[pick(rng, [*attributes, "scale_factor"])] = pick(rng, VALUES)
        return
    if what == "values":
        if values.size and values.dtype.kind in "fiu":
            flat = values.reshape(-1)
            bad = pick(rng, (np.nan, np.inf, -1e38, 1e-40, 0.0))
            flat[rng.randrange(flat.size)] = bad if values.dtype.kind == "f" else 255
            old[...] = values
        return
    del file[name]
    if what == "rename":
        file[pick(rng, ("x", "sdg2", "grün"))] = values
    elif what == "soft":
        file[name] = h5py.SoftLink(pick(rng, ("/nowhere", f"/{name}", "/tip_angle")))
    elif what == "group":
        file.create_group(name)
    elif what == "object":
        file.create_dataset(name, values.shape, h5py.string_dtype())
    elif what in OUTSIDE:
        _outside(file, name, values, what)
    elif what != "drop":
        _rebuilt(rng, file, name, values, what)
    if name in file and isinstance(file.get(name, getlink=True), h5py.HardLink):
        for key, value in attributes.items():
            if key not in ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"):
                file[name].attrs[key] = value


def _outside(file: Any, name: str, values: Any, what: str) -> None:
    """Let a dataset be other files' bytes."""
    if what == "external":
        secret = [("secret", 0, values.nbytes)]
        file.create_dataset(name, values.shape, values.dtype, external=secret)
    elif what == "virtual":
        layout = h5py.VirtualLayout(values.shape, values.dtype)
        layout[...] = h5py.VirtualSource("other.h5", name, values.shape)
        file.create_virtual_dataset(name, layout)
    else:
        file[name] = h5py.ExternalLink("other.h5", f"/{name}")


def _rebuilt(rng: random.Random, file: Any, name: str, values: Any, what: str) -> None:
    if what == "shape":
        shape = list(values.shape) or [1]
        shape[rng.randrange(len(shape))] = pick(rng, (0, 1, 2, 100))
        values = np.resize(values, shape)
    elif what == "type":
        kind = pick(rng, ("f8", ">f4", "i4", "S4", "c8", "?", "f2", "u8"))
        with np.errstate(all="ignore"):
            values = np.nan_to_num(values).astype(kind)
    more: dict[str, Any] = {}
    if what == "filter" and values.ndim:
        filters = ({"compression": "gzip"}, {"shuffle": True}, {"compression": "lzf"})
        more = pick(rng, (*filters, {"fletcher32": True}))
    elif what != "contiguous" and values.ndim and values.size:
        more = {"chunks": values.shape}
    file.create_dataset(name, data=values, **more)


def _bytes(rng: random.Random, data: bytes) -> bytes:
    """Return bytes damaged as files are: cut, holed, or with fields of HDF5 overwritten."""
    if rng.random() < 0.5:
        return hostile.damaged(rng, data)
    if rng.random() < 0.02:
        return endless(data)
    at = 8 * rng.randrange(len(data) // 8)
    word = struct.pack("<Q", pick(rng, (0, 1, 2**32 - 1, 2**63, 2**64 - 1, at, len(data))))
    return data[:at] + word + data[at + 8 :]


def _words(rng: random.Random, file: str) -> tuple[str, ...]:
    down = ",".join(f"{rng.uniform(-1, 1):.3g}" for _ in range(3))
    words = (
        ("info", file, "--json"),
        ("info", file, "--json", "--unsealed"),
        ("info", file, "--json", "--unsealed"),
        ("info", file, "--verify", "--json"),
        ("info", file, "--verify"),
        ("eval", file, "--json", "-g", down),
        ("eval", file, "--json", "-g", down, "-p", "reach=0.2"),
        ("limits", file, "--json"),
        ("optimum", file, "--json", "--method", "map", "-g", down),
    )
    if rng.random() < 0.02:
        return ("plot", file, "-o", "map.svg", "--kind", pick(rng, ("contour", "sphere", "curve")))
    return tuple(pick(rng, words))


def make(rng: random.Random) -> Case:
    """Return a case of a map, now and then as a part file to go on with."""
    sound = swept("tripod")
    files = {"other.h5": swept("rover"), "secret": b"\x2a\x00\x80\x3f" * 2000}
    if rng.random() < 0.2:
        # Every byte of a sealed map is under its digest.
        data = _bytes(rng, sound)
        words = pick(rng, (("info", "m.h5", "--verify"), _words(rng, "m.h5")))
        sure = data != sound and "--verify" in words
        must = REFUSED if sure else ANY
        return Case("sealed: bytes", files | {"m.h5": data}, words, must, ("map.svg",))
    what = pick(rng, CHANGES)
    data = edited(rng, sound, what)
    if rng.random() < 0.3:
        what, data = f"{what} bytes", _bytes(rng, data)
    if rng.random() < 0.06:
        files |= {"r.toml": recipes()["tripod"].encode(), "m.h5.part": data}
        words = ("sweep", "r.toml", "-o", "m.h5", "--resume", "--threads", "1")
        then = (("info", "m.h5", "--verify", "--json"),)
        return Case(f"part: {what}", files, words, ANY, ("m.h5", "m.h5.part"), then)
    files["m.h5"] = data
    return Case(f"unsealed: {what}", files, _words(rng, "m.h5"), ANY, ("map.svg",))
