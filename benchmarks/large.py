"""A 6-D map of 9 GB, killed on its way, resumed and compared: `python -m benchmarks.large [NODES]`.

Absolem with its four flippers moving one by one, over a cone.  Needs twice that in build/.
"""

import filecmp
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# 13^4 postures and 193^2 directions, two channels: 2.1 thousand million values.
SAMPLES, NODES = 13, 193
LIMIT_MB = 600.0


def six_dimensional(text: str, nodes: int) -> str:
    """Return the recipe of Absolem with one parameter for each flipper, and no rocking."""
    names = [f"{end}_{side}" for end in ("front", "rear") for side in ("left", "right")]
    parameters = "".join(
        f'[[robot.parameter]]\nname = "{name}"\nmin = -180.0\nmax = 180.0\nunit = "deg"\n\n'
        for name in names
    )
    start, end = text.index("[[robot.parameter]]"), text.index("[[robot.link]]")
    text = text[:start] + parameters + text[end:]
    for name in names:
        pattern = rf'(name = "{name}_flipper".*?parameter = ")\w+'
        text = re.sub(pattern, rf"\g<1>{name}", text, count=1, flags=re.DOTALL)
    samples = ", ".join(f"{name} = {SAMPLES}" for name in names)
    for old, new in (
        (r"samples = .*", f"samples = {{ {samples} }}"),
        (r"nodes = \d+", f"nodes = {nodes}"),
        (r"channels = .*", 'channels = ["sdg", "tip_angle"]'),
        (r"rock_angle = .*", "rock_angle = 0.0"),
    ):
        text = re.sub(old, new, text, count=1)
    return text


def run(*arguments: str, kill: Callable[[], bool] | None = None) -> float:
    """Run lutgen, and kill it as soon as `kill` says so; return the seconds that it took."""
    begin = time.perf_counter()
    code = "from lutgen.cli import main; main()"
    process = subprocess.Popen([sys.executable, "-c", code, *arguments], cwd=ROOT)
    while process.poll() is None:
        time.sleep(0.05)
        if kill is not None and kill():
            process.kill()
    if kill is None and process.returncode != 0:
        raise SystemExit(f"lutgen {' '.join(arguments)}: exit {process.returncode}")
    return time.perf_counter() - begin


def main() -> None:
    """Sweep, kill, resume, verify, sweep again, compare."""
    nodes = int(sys.argv[1]) if len(sys.argv) > 1 else NODES
    (ROOT / "build").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=ROOT / "build", prefix="large-") as name:
        folder = Path(name)
        recipe, killed, whole = (str(folder / n) for n in ("six.toml", "killed.h5", "whole.h5"))
        text = (ROOT / "maps" / "absolem.toml").read_text("utf-8")
        Path(recipe).write_text(six_dimensional(text, nodes), "utf-8")
        size = 4 * 2 * SAMPLES**4 * nodes**2

        def third() -> bool:
            part = Path(killed + ".part")
            return part.exists() and part.stat().st_blocks * 512 > size / 3

        print(f"killed after {run('sweep', recipe, '-o', killed, kill=third):.1f} s", flush=True)
        if Path(killed).exists():
            raise SystemExit("the sweep ended before it could be killed")
        print(f"resumed in {run('sweep', recipe, '-o', killed, '--resume'):.1f} s", flush=True)
        print(f"verified in {run('info', killed, '--verify'):.1f} s", flush=True)
        print(f"uninterrupted in {run('sweep', recipe, '-o', whole):.1f} s", flush=True)
        same = filecmp.cmp(killed, whole, shallow=False)
        size = os.stat(whole).st_size  # noqa: PTH116
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"{size / 1e9:.2f} GB, at most {memory:.0f} MB resident, files the same: {same}")
    if not same or memory > LIMIT_MB:
        raise SystemExit("that is not as it should be")


if __name__ == "__main__":
    main()
