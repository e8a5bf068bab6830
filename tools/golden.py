"""Golden set: whether this checkout answers as an older commit does, to the bit.

python -m tools.golden COMMIT [GROUP ...]

Builds COMMIT in a temporary folder, runs this file on both checkouts, and prints the `diff` of
their rows.  Processors differ in the last bits, so nothing is stored.
"""

import hashlib
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import lutgen
from firmware_export import export
from firmware_export.device import ExportFolder

ROOT = Path(__file__).resolve().parent.parent
GALLERY = sorted((ROOT / "maps").glob("*.toml"))
NAMED = [ROOT / "maps" / f"{name}.toml" for name in ("paper_two", "absolem", "markhor")]
# Inputs that were once wrong, and published robots, which come with the package of `make robots`.
WRONG, PUBLISHED = ROOT.parent / "shared", Path(np.__file__).parents[1] / "cmeel.prefix/share"
CHANNELS = ("sdg", "height", "tip_angle", "margin", "energy_margin", "facet", "status")
KINDS = ("curve", "surface", "contour", "sphere", "polar", "robot")
COMMANDS = ("limits", "eval", "optimum", "metrics", "budget", "path --points 20")
# What a seeded robot is made to have.
EDITS = (
    ("^(radius|axis) = .*", ""),  # points
    ("^axis = .*", ""),  # spheres
    (r'(\[\[robot\.contact\]\]\nname = ")(.+\n(?:.+\n)+)', r"\1\2\n\1rim_\2"),  # two rims a wheel
    (r"\[robot\]\n", "[robot]\ncom_uncertainty = 0.01\n"),
    (r"\Z", '\n[[robot.force]]\nname = "f"\nlink = "body"\nposition = [0, 0, 0]\nforce=[1, 2, 3]'),
    ("", ""),
)


def said(*words):
    """Run a command; return its exit code, what it prints, and the file `new` that it writes."""
    for path in Path().glob("new.*"):
        path.unlink()
    line = [sys.executable, "-P", "-m", "lutgen", *map(str, words)]
    done = subprocess.run(line, capture_output=True)
    made = [path.read_bytes() for path in Path().glob("new.*")]
    return [bytes([done.returncode]), done.stdout, done.stderr, *made]


def recipe_of(source):
    """Load a recipe: of a TOML file, of a robot description, or of the seeded robot of a number."""
    new = Path("new.toml")
    if isinstance(source, int):
        dice = random.Random(source)
        text = re.sub(*dice.choice(EDITS), dice.choice(GALLERY).read_text(), flags=re.M)
        text = re.sub(r"\d\.\d+", lambda x: str(float(x[0]) * dice.uniform(0.9, 1.1)), text)
        new.write_text(text)
    elif source.suffix == ".urdf":
        said("import", source, "-o", new)
    else:
        new = source
    return lutgen.load_recipe(new)


def postures(recipe, count, directions):
    """Return random params (rad or lengths) and directions."""
    dice = np.random.default_rng(1)
    low, high = np.array([[p.minimum, p.maximum] for p in recipe.parameters]).reshape(-1, 2).T
    down = dice.normal(size=(directions, 3)) * 0.5 - (0, 0, 1)
    return dice.uniform(low, high, (count, len(low))), down


def channels(source):
    """Return every channel of a robot on 300 postures x 200 directions."""
    recipe = recipe_of(source)
    found = lutgen.evaluate(recipe, *postures(recipe, 300, 200), channels=CHANNELS)
    return [np.asarray(found[name]) for name in CHANNELS]


def maps(path):
    """Sweep a recipe; return every channel of its map."""
    recipe = lutgen.load_recipe(path)
    lutgen.sweep(recipe, "map.h5", force=True)
    return [lutgen.load_map("map.h5").channel(name) for name in recipe.channels]


def exports(path):
    """Export a recipe; return its tables and the answers of the C to 20,000 queries."""
    export(path, "export", points=20_000, force=True)
    made = ExportFolder("export")
    return [made.blob.bytes, *made.host.read(*postures(recipe_of(path), 20_000, 20_000))]


def broken(number):
    """Break a line of a recipe; return the exit code of `check` and the keys that it names."""
    dice = random.Random(number)
    text = dice.choice(GALLERY).read_text()
    line = dice.choice([*re.finditer(r"^(\w+) = .*", text, flags=re.M)])
    other = dice.choice((" = -1e9", ' = "x"', "x = 1", " = []", " = {}"))
    Path("broken.toml").write_text(text[: line.end(1)] + other + text[line.end() :])
    code, *printed = said("check", "broken.toml")
    return [code, *re.findall(rb"key (`[^`]*`)", b"".join(printed))]


def rows():
    """Yield the group of each row, the function that computes it, and its arguments."""
    robots = sorted([*WRONG.rglob("*.urdf"), *PUBLISHED.rglob("*.urdf")])
    sources = (*GALLERY, *sorted(WRONG.rglob("*.toml")), *robots, *range(60))
    yield from (("channels", channels, one) for one in sources)
    yield from (("imports", said, "import", one, "-o", "new.toml") for one in robots)
    yield from (("maps", maps, one) for one in GALLERY)
    yield from (("exports", exports, one) for one in GALLERY)
    for one in NAMED:
        yield from (("answers", said, *line.split(), one, "--json") for line in COMMANDS)
        drawn = ("-q", "plot", one, "-o", "new.svg", "--kind")
        yield from (("figures", said, *drawn, kind) for kind in KINDS)
    yield from (("broken", broken, one) for one in range(300))


def record(groups):
    """Print the digest of each row of some groups, or the text of what it raises."""
    for group, find, *given in rows():
        if not groups or group in groups:
            try:
                value = hashlib.sha256(b"\0".join(map(bytes, find(*given)))).hexdigest()[:16]
            except Exception as error:
                value = f"{type(error).__name__}: {error}"[:100]
            print(group, *given, value, flush=True)


def compare(commit, groups):
    """Compare the two checkouts; return 1 where a row differs."""
    with tempfile.TemporaryDirectory() as folder:
        unpack = f"git -C '{ROOT}' archive --prefix=old/ '{commit}' | tar -x"
        subprocess.run(unpack, shell=True, cwd=folder, check=True)
        for root, name in ((Path(folder, "old"), "before"), (ROOT, "now")):
            run = ["env", f"PYTHONPATH={root}", sys.executable, "-P"]
            build = [*run, "setup.py", "-q", "build_ext", "--inplace"]
            subprocess.run(build, cwd=root, check=True, capture_output=True)
            with Path(folder, name).open("w") as out:
                words = [*run, __file__, "--record", *groups]
                subprocess.run(words, cwd=folder, stdout=out, check=True)
        return subprocess.run(["diff", "before", "now"], cwd=folder).returncode


if __name__ == "__main__":
    first, *groups = sys.argv[1:] or sys.exit(__doc__)
    sys.exit(record(groups) if first == "--record" else compare(first, groups))
