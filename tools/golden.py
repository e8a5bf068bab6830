"""Golden set: whether this checkout answers as an older commit does, to the bit.

python -m tools.golden COMMIT [--groups channels,maps]

Builds COMMIT in a temporary folder, runs this file on both checkouts at the same time, a core each,
and lists the rows that differ.  Processors differ in the last bits, so nothing is stored.  A row
that raises is the text of its exception.  Takes six minutes on 2 idle cores; exits with 1 where a
row differs.
"""

import argparse
import contextlib
import hashlib
import io
import json
import os
import random
import re
import runpy
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
CASES = ROOT.parent / "shared" / "cases"
GALLERY = sorted((ROOT / "maps").glob("*.toml"))
NAMED = [ROOT / "maps" / f"{name}.toml" for name in ("paper_two", "absolem", "markhor")]
CHANNELS = ("sdg", "height", "tip_angle", "margin", "energy_margin", "facet", "status")
FIGURES = ("curve", "surface", "contour", "sphere", "polar", "robot", "metrics")
COMMANDS = ("check", "limits", "eval", "optimum", "metrics", "budget", "path --points 20")
COMMANDS += ("wheels --velocity 1,0.2", "control")
GROUPS = "channels,maps,imports,answers,broken,figures,exports"
BY_CODE = """[robot]
name = "code"
length_unit = "m"
python = "CODE:postures"
parameter = [{ name = "lift", min = 0.0, max = 1.0, unit = "m" }]
[sweep]
samples = { lift = 9 }
gravity = { chart = "sphere", nodes = 9, channels = ["tip_angle"] }
"""


def command(name, path, *options):
    """Run a command in this process; return its exit code and everything that it printed."""
    said, code = io.StringIO(), 0
    sys.argv = ["lutgen", name, str(path), *options]
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            runpy.run_module("lutgen", run_name="__main__")
        except SystemExit as end:
            code = end.code or 0
    return f"{code}\n{said.getvalue()}"


def answer(line, path):
    """Return what a command prints with --json."""
    name, *options = line.split()
    return command(name, path, *options, "--json")


def moved(text, dice, spread, rise=0.0):
    """Return a recipe whose contacts are elsewhere."""
    place = re.compile(r"^position = (\[.*\])", re.MULTILINE)
    by = [lambda x: x * dice.uniform(1 - spread, 1 + spread) + rise]
    return place.sub(lambda found: f"position = {[*map(by[0], json.loads(found[1]))]}", text)


def seeded(number):
    """Write a robot: points, spheres, discs, two rims, forces, a com in a ball, or by code."""
    dice, kind, path = random.Random(number), number % 7, Path(f"seeded_{number}.toml")
    text = moved(dice.choice(GALLERY[:5]).read_text(), dice, 0.1)
    if kind < 2:
        text = re.sub(("^(radius|axis) = .*", "^axis = .*")[kind], "", text, flags=re.MULTILINE)
    elif kind == 3:
        rims = re.findall(r"\[\[robot\.contact\]\]\n(?:.+\n)+", text)
        text += moved("".join(rims), dice, 0, 1e-3).replace('name = "', 'name = "rim_')
    elif kind == 4:
        pull = [dice.gauss(0, 5) for _ in range(3)]
        text += '[[robot.force]]\nname = "rope"\nlink = "body"\nposition = [0.1, 0, 0.1]\n'
        text += f"force = {pull}\n"
    elif kind == 5:
        text = text.replace("[robot]\n", "[robot]\ncom_uncertainty = 0.01\n")
    elif kind == 6:
        feet = [[dice.uniform(-1, 1), dice.uniform(-1, 1), -1.0] for _ in range(dice.randint(3, 9))]
        code = f"import numpy as np\ndef postures(q):\n    return np.array({feet}) * (1 + "
        path.with_suffix(".py").write_text(code + "q[:, :, None]), np.zeros((len(q), 3))\n")
        text = BY_CODE.replace("CODE", path.stem)
    path.write_text(text)
    return path


@cache
def imported(path):
    """Import a robot description; return the recipe, which begins with what the command said."""
    recipe = Path(f"{path.parent.parent.name}_{path.stem}.toml")
    said = command("import", path, "-o", str(recipe))
    recipe.write_text(f"# {said!r}\n" + (recipe.read_text() if recipe.exists() else ""))
    return recipe


def questions(path, count, directions):
    """Return random postures (rad or lengths), directions and the names of the parameters."""
    dice = np.random.default_rng(1)
    own = tomllib.loads(path.read_text())["robot"].get("parameter", [])
    scale = [np.pi / 180 if one["unit"] == "deg" else 1.0 for one in own]
    low, high = np.array([[one["min"], one["max"]] for one in own]).reshape(-1, 2).T * scale
    down = dice.normal(size=(directions, 3)) * 0.5 - (0, 0, 1)
    return dice.uniform(low, high, (count, len(own))), down, [one["name"] for one in own]


def values(channel, find, argument):
    """Return a channel of a robot on 300 postures x 200 directions."""
    import lutgen

    path = find(argument)
    params, down, _ = questions(path, 300, 200)
    recipe = lutgen.load_recipe(path, allow_python=True)
    return lutgen.evaluate(recipe, params, down, channels=(channel,))[channel]


def datasets(path):
    """Sweep a recipe; return the digest of every dataset of its map."""
    import h5py

    import lutgen

    lutgen.sweep(lutgen.load_recipe(path), f"{path.stem}.h5")
    with h5py.File(f"{path.stem}.h5") as file:
        return str([(n, digest(d[()])) for n, d in file.items() if isinstance(d, h5py.Dataset)])


def export(arithmetic, path):
    """Export a recipe and compile it; return digests of its tables and of 20,000 answers."""
    import firmware_export

    name, folder = path.stem, Path(f"{path.stem}_{arithmetic}")
    firmware_export.export(path, folder, arithmetic=arithmetic, points=20_000)
    params, down, names = questions(path, 20_000, 20_000)
    steps = "".join(f"{name}_{one}_Q(x[{k}]), ".upper() for k, one in enumerate(names))
    macros = [f"-DMAP={name}", f"-DCOUNT={len(names)}", f"-DSTEPS={steps.replace('X[', 'x[')}"]
    sources = ["-I", folder, "-include", f"{name}.h", folder / f"{name}.c", ROOT / "tools/golden.c"]
    subprocess.run(["cc", *macros, *sources, "-lm", "-o", folder / "golden"], check=True)
    asked = np.hstack((params, down)).astype(np.float32).tobytes()
    said = subprocess.run(folder.resolve() / "golden", input=asked, capture_output=True, check=True)
    tables = re.findall(r"uint8_t \w+\[\d+\] = {([^}]*)}", (folder / f"{name}.c").read_text())
    return " ".join(map(digest, ("".join(tables), said.stdout, said.stderr)))


def checked(number):
    """Break a line of a recipe; return the exit code of `check` and the keys that it names."""
    dice = random.Random(number)
    lines = dice.choice(GALLERY).read_text().splitlines()
    at = dice.choice([k for k, line in enumerate(lines) if "=" in line])
    key, value = lines[at].split("=", 1)
    wrong = ("= -1e9", '= "x"', f"x = {value}", "= []", "= {}", f"= {value}\n{key} = 1")
    lines[at] = key + dice.choice(wrong)
    Path("broken.toml").write_text("\n".join(lines))
    said = command("check", "broken.toml")
    return said[0] + " ".join(re.findall("key (`[^`]*`)", said))


def drawn(kind, path):
    """Draw a figure; return digests of the numbers in it: lines, areas, colours and images."""
    from matplotlib.figure import Figure

    found, save = [], Figure.savefig

    def noted(figure, *args, **options):
        save(figure, *args, **options)
        for artist in (one for axes in figure.axes for one in axes.get_children()):
            for get in ("get_xydata", "get_array", "get_offsets"):
                found.append(digest(getattr(artist, get, str)()))
            found.extend(digest(path.vertices) for path in getattr(artist, "get_paths", list)())

    Figure.savefig = noted
    try:
        return command("plot", path, "--kind", kind, "-o", f"{path.stem}_{kind}.png") + str(found)
    finally:
        Figure.savefig = save


def digest(value):
    """Return sixteen digits for an array (in float64), bytes or a text."""
    if isinstance(value, str):
        value = value.replace(str(Path.cwd()), ".").encode()
    elif not isinstance(value, bytes):
        value = np.ascontiguousarray(value, np.float64).tobytes()
    return hashlib.sha256(value).hexdigest()[:16]


def rows():
    """Return the groups: of each its rows, a function and its arguments."""
    urdfs = [*sorted(CASES.rglob("*.urdf")), *sorted(CASES.glob("../robots/*.urdf"))]
    try:
        from proofs.robots import STAND, data

        urdfs += [data() / f"{path}.urdf" for path in STAND.values()]
    except SystemExit as missing:
        print(f"published robots are skipped: {missing}", file=sys.stderr)
    finds = [(Path, path) for path in [*GALLERY, *sorted(CASES.rglob("*.toml"))]]
    finds += [*((imported, path) for path in urdfs), *((seeded, n) for n in range(60))]
    few = [path for path in GALLERY if path.read_text().count("[[robot.contact]]") == 3]
    return {
        "channels": [(values, name, *find) for find in finds for name in CHANNELS],
        "maps": [(datasets, path) for path in GALLERY],
        "imports": [(lambda path: imported(path).read_text(), path) for path in urdfs],
        "answers": [(answer, line, path) for path in NAMED for line in COMMANDS],
        "broken": [(checked, number) for number in range(300)],
        "figures": [(drawn, kind, path) for path in NAMED for kind in FIGURES],
        "exports": [
            *((export, "float", path) for path in GALLERY),
            *((export, "integer", path) for path in few),
        ],
        "tables": [(export, "integer", path) for path in GALLERY if path not in few],
    }


def record(groups):
    """Compute rows in this folder and leave them in rows.json."""
    found = {}
    for group, row, *arguments in ((name, *row) for name in groups for row in rows()[name]):
        told = ("/".join(x.parts[-3:]) if isinstance(x, Path) else str(x) for x in arguments)
        name = f"{group}: " + " ".join(one for one in told if not one.startswith("<"))
        try:
            found[name] = digest(row(*arguments))
        except Exception as error:
            found[name] = f"{type(error).__name__}: {error}"[:100]
    Path("rows.json").write_text(json.dumps(found))


def start(root, folder, groups):
    """Build the C library of a checkout and begin to record its rows in a folder."""
    folder.mkdir()
    build = [sys.executable, "setup.py", "--quiet", "build_ext", "--inplace"]
    subprocess.run(
        build, cwd=root, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    environment = {**os.environ, "PYTHONPATH": str(root), "NUMBA_NUM_THREADS": "1"}
    words = [sys.executable, "-P", __file__, "", "--groups", groups]
    return subprocess.Popen(words, cwd=folder, env=environment)


def main():
    """Compare the two checkouts; return 1 where a row differs."""
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("commit", help="any name that git knows")
    parser.add_argument("--groups", default=GROUPS, help=f"{GROUPS} (default); tables (slow)")
    asked = parser.parse_args()
    if not asked.commit:
        return record(asked.groups.split(","))
    worktree = ["git", "-C", str(ROOT), "worktree"]
    with tempfile.TemporaryDirectory() as folder:
        old, folders = Path(folder, "checkout"), [Path(folder, name) for name in ("old", "new")]
        subprocess.run([*worktree, "add", "-f", "--detach", old, asked.commit], check=True)
        try:
            both = [start(*pair, asked.groups) for pair in zip((old, ROOT), folders, strict=True)]
            if any([one.wait() for one in both]):
                return 2
            before, now = (json.loads((one / "rows.json").read_text()) for one in folders)
        finally:
            subprocess.run([*worktree, "remove", "--force", old], check=True)
    same = Counter(name.split(":")[0] for name, value in now.items() if before.get(name) == value)
    for name in sorted(before | now):
        if before.get(name) != now.get(name):
            print(f"{name}: {before.get(name, 'missing')} -> {now.get(name, 'missing')}")
    print("\n".join(f"{group}: {count} rows are the same" for group, count in same.items()))
    return int(before != now)


if __name__ == "__main__":
    sys.exit(main())
