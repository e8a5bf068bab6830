"""Golden set: whether this checkout answers as an older commit does, to the bit.

python -m tools.golden COMMIT [GROUP ...]

Builds COMMIT in a temporary folder, runs this file on both checkouts, and lists the rows that
differ.  Processors differ in the last bits, so nothing is stored.  A row that raises is the text of
its exception.  Exits with 1 where a row differs.
"""

import hashlib
import json
import os
import random
import re
import subprocess
import sys
import tempfile
from collections import Counter
from functools import partial
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
CASES = ROOT.parent / "shared"
GALLERY = sorted((ROOT / "maps").glob("*.toml"))
NAMED = [ROOT / "maps" / f"{name}.toml" for name in ("paper_two", "absolem", "markhor")]
CHANNELS = ("sdg", "height", "tip_angle", "margin", "energy_margin", "facet", "status")
KINDS = ("curve", "surface", "contour", "sphere", "polar", "robot")
COMMANDS = ("limits", "eval", "optimum", "metrics", "budget", "path --points 20", "check")
# What each of the seeded robots has instead: points, spheres, two rims a wheel, a com in a ball,
# a force, and nothing else.
EDITS = (
    ("^(radius|axis) = .*", ""),
    ("^axis = .*", ""),
    (r'(\[\[robot\.contact\]\]\nname = ")(.+\n(?:.+\n)+)', r"\1\2\n\1rim_\2"),
    (r"\[robot\]\n", "[robot]\ncom_uncertainty = 0.01\n"),
    (
        r"\Z",
        '\n[[robot.force]]\nname = "f"\nlink = "body"\nposition = [0, 0, 0]\nforce = [1, 2, -3]',
    ),
    ("", ""),
)
READ = """#include <stdio.h>
int main(void) {
  float x[COUNT + 3];
  smap_reading_t r = {0};
  while (fread(x, sizeof x, 1, stdin) == 1)
    printf("%d %a %a %a\\n", smap_read(&MAP, x, x + COUNT, &r), r.sdg, r.tip_angle, r.height);
}"""


def digest(value):
    """Return sixteen digits for bytes, a text or an array (in float64)."""
    if isinstance(value, str):
        value = value.encode()
    elif not isinstance(value, bytes):
        value = np.ascontiguousarray(value, np.float64).tobytes()
    return hashlib.sha256(value).hexdigest()[:16]


def command(words):
    """Run a command; return its exit code and what it prints."""
    done = subprocess.run([sys.executable, "-P", "-m", "lutgen", *words], capture_output=True)
    return f"{done.returncode} {(done.stdout + done.stderr).decode()}"


def seeded(number):
    """Write a robot of the gallery with other numbers and one of the edits."""
    dice, path = random.Random(number), Path(f"seeded_{number}.toml")
    text = re.sub(*EDITS[number % len(EDITS)], dice.choice(GALLERY).read_text(), flags=re.M)
    path.write_text(re.sub(r"\d\.\d+", lambda x: str(float(x[0]) * dice.uniform(0.9, 1.1)), text))
    return path


def postures(recipe, count, directions):
    """Return random params (rad or lengths) and directions."""
    dice = np.random.default_rng(1)
    low, high = np.array([[p.minimum, p.maximum] for p in recipe.parameters]).reshape(-1, 2).T
    down = dice.normal(size=(directions, 3)) * 0.5 - (0, 0, 1)
    return dice.uniform(low, high, (count, len(low))), down


def imported(path):
    """Import a robot description; return its recipe, which begins with what the command says."""
    out = Path(f"{path.parent.name}_{path.stem}.toml")
    said = command(["import", str(path), "-o", str(out)])
    out.write_text(f"# {said!r}\n" + (out.read_text() if out.exists() else ""))
    return out


def values(find, argument):
    """Return the channels of a robot on 300 postures x 200 directions."""
    import lutgen

    recipe = lutgen.load_recipe(find(argument))
    found = lutgen.evaluate(recipe, *postures(recipe, 300, 200), channels=CHANNELS)
    return " ".join(digest(found[name]) for name in CHANNELS)


def dataset(path):
    """Sweep a recipe; return the digest of every channel of its map."""
    import lutgen

    recipe, out = lutgen.load_recipe(path), f"{path.stem}.h5"
    lutgen.sweep(recipe, out, force=True)
    return " ".join(digest(lutgen.load_map(out).channel(name)) for name in recipe.channels)


def export(path):
    """Export a recipe and compile it; return digests of its blob and of 20,000 answers in C."""
    import firmware_export
    import lutgen

    name, folder, recipe = path.stem, Path(f"{path.stem}_c"), lutgen.load_recipe(path)
    firmware_export.export(path, folder, points=20_000)
    (folder / "read.c").write_text(READ)
    given = [f"-DMAP={name}", f"-DCOUNT={len(recipe.parameters)}", "-include", f"{name}.h"]
    sources = ["-I", folder, folder / f"{name}.c", folder / "read.c", "-lm", "-o", folder / "read"]
    subprocess.run(["cc", *given, *sources], check=True)
    asked = np.hstack(postures(recipe, 20_000, 20_000)).astype(np.float32).tobytes()
    said = subprocess.run(folder.resolve() / "read", input=asked, capture_output=True, check=True)
    blob = json.loads((folder / f"{name}_report.json").read_text())["tables"]["blob"]
    return f"{digest(json.dumps(blob))} {digest(said.stdout)}"


def checked(number):
    """Break a line of a recipe; return the exit code of `check` and the keys that it names."""
    dice, path = random.Random(number), Path("broken.toml")
    lines = dice.choice(GALLERY).read_text().splitlines()
    at = dice.choice([k for k, line in enumerate(lines) if "=" in line])
    key, value = lines[at].split("=", 1)
    lines[at] = key + dice.choice(("= -1e9", '= "x"', f"x = {value}", "= []", "= {}"))
    path.write_text("\n".join(lines))
    said = command(["check", str(path)])
    return said[0] + " ".join(re.findall("key (`[^`]*`)", said))


def drawn(kind, path):
    """Draw a figure; return the digest of the file, in which a vector is a text."""
    out = Path(f"{path.stem}_{kind}.svg")
    return command(["plot", str(path), "--kind", kind, "-o", str(out)])[0] + out.read_text()


def rows():
    """Return a function for each row, by its name."""
    urdfs = sorted([*CASES.rglob("cases/**/*.urdf"), *CASES.glob("robots/*.urdf")])
    try:
        from proofs.robots import STAND, data

        urdfs += [data() / f"{path}.urdf" for path in STAND.values()]
    except (ImportError, SystemExit) as missing:
        print(f"published robots are skipped: {missing}", file=sys.stderr)
    tomls = [*GALLERY, *sorted(CASES.rglob("*.toml"))]
    found = {f"channels {path.stem}": partial(values, Path, path) for path in tomls}
    found |= {f"channels {path.stem}": partial(values, imported, path) for path in urdfs}
    found |= {f"channels seeded {n}": partial(values, seeded, n) for n in range(60)}
    found |= {f"imports {path.stem}": lambda p=path: imported(p).read_text() for path in urdfs}
    found |= {f"maps {path.stem}": partial(dataset, path) for path in GALLERY}
    found |= {f"exports {path.stem}": partial(export, path) for path in GALLERY}
    for path in NAMED:
        for line in COMMANDS:
            name, *rest = line.split()
            found[f"answers {line} {path.stem}"] = partial(
                command, [name, str(path), *rest, "--json"]
            )
        found |= {f"figures {kind} {path.stem}": partial(drawn, kind, path) for kind in KINDS}
    return found | {f"broken {number}": partial(checked, number) for number in range(300)}


def record(groups):
    """Compute the rows of some groups in this folder; leave them in rows.json."""
    found = {}
    for name, row in rows().items():
        if not groups or name.split()[0] in groups:
            try:
                found[name] = digest(row())
            except Exception as error:
                found[name] = f"{type(error).__name__}: {error}"[:100]
    Path("rows.json").write_text(json.dumps(found))


def compare(commit, groups):
    """Compare the two checkouts; return 1 where a row differs."""
    found, git = [], ["git", "-C", str(ROOT), "worktree"]
    with tempfile.TemporaryDirectory() as folder:
        old = Path(folder, "checkout")
        subprocess.run([*git, "add", "-qf", "--detach", old, commit], check=True)
        for root in (old, ROOT):
            build = [sys.executable, "setup.py", "-q", "build_ext", "--inplace"]
            subprocess.run(build, cwd=root, check=True, capture_output=True)
            place = Path(tempfile.mkdtemp(dir=folder))
            words = [sys.executable, "-P", __file__, "--record", *groups]
            subprocess.run(words, cwd=place, env=os.environ | {"PYTHONPATH": str(root)}, check=True)
            found.append(json.loads((place / "rows.json").read_text()))
        subprocess.run([*git, "remove", "--force", old], check=True)
    before, now = found
    differ = [name for name in sorted(before | now) if before.get(name) != now.get(name)]
    for name in differ:
        print(f"{name}: {before.get(name, 'missing')} -> {now.get(name, 'missing')}")
    same = Counter(name.split()[0] for name in now if name not in differ)
    print("the same:", ", ".join(f"{group} {count}" for group, count in same.items()))
    return int(bool(differ))


if __name__ == "__main__":
    first, *groups = sys.argv[1:] or sys.exit(__doc__)
    sys.exit(record(groups) if first == "--record" else compare(first, groups))
