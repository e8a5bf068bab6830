"""Published robots imported without editing anything, against pinocchio and the physics engine.

python -m proofs.robots [NAME...] [--update]

The robots are those of the package example-robot-data (the extra `robots`), which are other
people's files and not kept here.  Each is imported, with its meshes, in the posture that its SRDF
names or with its joints at zero; mass and com are compared with pinocchio's, and of `TILTED` the
tilt limits in steps of 15 deg with MuJoCo.  `--update` writes docs/measured/robots.md.  Exits
with 1 where anything differs that should not.
"""

import argparse
import importlib.util
import math
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lutgen.analysis import (
    Posture,
    even_headings,
    level_frames,
    posture_limits,
    rounded_down,
    tilt_limits,
    tilted,
)
from lutgen.errors import LutgenError
from lutgen.propose import Imported, import_urdf
from lutgen.recipe import Recipe, postures
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.joints import read_motion
from lutgen.urdf.links import centre_of_mass, places
from lutgen.urdf.meshes import Meshes
from lutgen.urdf.read import load_urdf
from lutgen.urdf.sources import Sources
from lutgen.urdf.srdf import load_srdf, srdf_beside
from proofs.physics.body import recipe_posture
from proofs.physics.release import falls
from proofs.physics.start import pierced
from targets.marks import MEASURED, between, markdown

PAGE = MEASURED / "robots.md"
# Robots whose tilt limits are compared with the engine's.
TILTED = (
    *("a1", "anymal_b_simple/anymal", "b1", "baxter", "go2", "hyq/hyq_no_sensors", "laikago"),
    *("pr2", "solo", "tiago_pro"),
)
# kg and m, against pinocchio, which rounds no angles of few digits; deg, against the engine.
SAME, ROUNDED, CLOSE, HEADINGS = 1e-9, 1e-5, 0.2, 24


@dataclass(frozen=True)
class Row:
    """What came of a robot: cells of the table, and what is wrong with it."""

    cells: tuple[str, ...]
    faults: tuple[str, ...]


def data() -> Path:
    """Return the folder of robots of the package; SystemExit where it is not installed."""
    found = importlib.util.find_spec("cmeel")
    roots = [Path(one).parent for one in (found.submodule_search_locations or ())] if found else []
    for root in [*roots, *map(Path, sys.path)]:
        folder = root / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
        if folder.is_dir():
            return folder
    sys.exit("example-robot-data is not installed; `pip install lutgen[robots]`")


def named(path: Path) -> str:
    """Return the robot's name: of its folder, and of its file where that is another."""
    folder = path.relative_to(data()).parts[0].removesuffix("_description").removesuffix("_data")
    return folder if path.stem == folder else f"{folder}/{path.stem}"


def standing(path: Path, robot: UrdfRobot) -> tuple[dict[str, float], str]:
    """Return the posture (rad, m) that import takes, and where it comes from."""
    file = srdf_beside(path)
    srdf = load_srdf(file, robot) if file is not None else None
    name = srdf.standing() if srdf is not None else None
    if srdf is None or name is None:
        return {}, "zero, no SRDF names one to stand in"
    return srdf.posture(name), f"{name}, SRDF"


def imported(path: Path) -> tuple[UrdfRobot, dict[str, float], str, Imported]:
    """Return description, posture and its source, and what import makes of it without options."""
    robot = load_urdf(path)
    posture, source = standing(path, robot)
    return (
        robot,
        posture,
        source,
        import_urdf(robot, posture=posture, meshes=Meshes(Sources(path.parent))),
    )


def parameters(made: Imported) -> str:
    """Return the parameters in words, with how many joints each drives where it is not one."""
    counts = {name: len(joints) for name, joints in made.couples.items()}
    names = [p.name for p in made.recipe.parameters]
    return ", ".join(f"{n} ({counts[n]} joints)" if n in counts else n for n in names) or "none"


def weighed(path: Path, robot: UrdfRobot, posture: dict[str, float], recipe: Recipe) -> list[str]:
    """Return how mass and com differ from pinocchio's, of the description and of the recipe."""
    import pinocchio

    model = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
    data = model.createData()
    q = pinocchio.neutral(model)
    motion = read_motion(robot, None, posture)
    for joint in robot.joints:
        if joint.kind == "fixed" or not model.existJointName(joint.name):
            continue
        drive = motion.drive(joint.name)
        value = drive.offset + (drive.scale * motion.rest[drive.by] if drive.by else 0.0)
        entry = model.joints[model.getJointId(joint.name)]
        at = entry.idx_q
        q[at : at + entry.nq] = [value] if entry.nq == 1 else [math.cos(value), math.sin(value)]
    com = np.asarray(pinocchio.centerOfMass(model, data, q))
    mass = float(pinocchio.computeTotalMass(model))
    found = [("mass", abs(math.fsum(link.mass for link in robot.links) - mass))]
    found.append(("mass of the recipe", abs(math.fsum(one.mass for one in recipe.links) - mass)))
    own = centre_of_mass(robot, places(robot, motion))
    theirs = postures(recipe, np.array([recipe.home_params]))[1][0]
    found += [("com", float(np.abs(own - com).max()))]
    found += [("com of the recipe", float(np.abs(theirs - com).max()))]
    most = ROUNDED if robot.rounded else SAME
    return [f"{what} differs by {off:.2g}" for what, off in found if off > most]


def engine(recipe: Recipe) -> list[float]:
    """Return by how much (deg) the engine's verdict is off the limit, for each heading; inf beyond.

    The robot, feet as found and joints held, is let go where it stands on level ground, under
    gravity 0.2 deg before and 0.2 deg after each limit.
    """
    home = np.array([recipe.home_params])
    posture = recipe_posture(recipe, home[0])
    headings = even_headings(HEADINGS)
    limits = tilt_limits(recipe, home, headings, "plane")[0]
    frame = level_frames(recipe, home, "plane")[0]
    begin = pierced(posture, -frame[None, :, 2])[0]
    if begin is None:
        return [math.inf] * HEADINGS
    found = []
    for heading, limit in zip(headings, limits, strict=True):
        wrong = 0
        for side in (-1.0, 1.0):
            down = np.asarray(frame @ tilted(limit + side * math.radians(CLOSE), heading))
            wrong += falls(posture, begin, down) != (side > 0.0)
        found.append(math.inf if wrong else CLOSE)
    return found


def measured(name: str, path: Path) -> Row:
    """Return the row of a robot that stands."""
    robot, posture, source, made = imported(path)
    recipe = made.recipe
    faults = weighed(path, robot, posture, recipe)
    home = np.array(recipe.home_params)
    limits = posture_limits(Posture(recipe, home))
    body, ground = limits.guaranteed, limits.ground
    kinds = [contact.kind for contact in recipe.contacts]
    touching = ", ".join(
        f"{kinds.count(kind)} {kind}{'s' if kinds.count(kind) > 1 else ''}"
        for kind in dict.fromkeys(kinds)
    )
    share = "-"
    if name in TILTED:
        off = engine(recipe)
        within = sum(math.isfinite(one) for one in off)
        share = f"{within} of {len(off)}"
        faults += [f"engine differs in {len(off) - within} headings"] if within < len(off) else []
    stands = body > 0.0
    com = " ".join(f"{x:.3f}" for x in postures(recipe, home[None])[1][0])
    cells = (
        *(name, f"{math.fsum(one.mass for one in recipe.links):.4g}", com),
        *(source, f"{touching}{' (meshes)' if made.guessed else ''}", parameters(made)),
        f"{rounded_down(math.degrees(body)):.2f}" if stands else "tips on level ground",
        f"{rounded_down(math.degrees(ground.guaranteed)):.2f}" if stands else "-",
        f"{math.degrees(limits.worst.heading):.1f}" if stands else "-",
        *("equal" if not faults or "engine" in faults[0] else "differ", share),
    )
    return Row(cells, tuple(f"{name}: {fault}" for fault in faults))


def main() -> int:
    """Run everything, or the robots that are named."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="robots of the table (default: all)")
    parser.add_argument("--update", action="store_true", help=f"write {PAGE.name}")
    options = parser.parse_args()
    if options.update and options.names:
        parser.error("--update is for all robots; name none")
    found = {named(path): path for path in sorted(data().rglob("*.urdf"))}
    stand: list[Row] = []
    refused: dict[str, list[str]] = {}
    for name, path in found.items():
        if not options.names or name in options.names:
            try:
                stand.append(measured(name, path))
                print(" | ".join(stand[-1].cells), flush=True)
            except LutgenError as error:
                said = re.sub(r" \(got [^)]*\)", "", str(error).removeprefix(f"{path}: "))
                refused.setdefault(said, []).append(name)
                print(f"{name} | {said}", flush=True)
    if options.update:
        head = (
            "| robot | mass (kg) | com (m) | posture | contacts | parameters "
            "| body tilt, guaranteed (deg) | ground tilt, guaranteed (deg) "
            "| worst heading (deg) | mass and com | engine |"
        )
        rows = [[", ".join(names), said] for said, names in refused.items()]
        between(PAGE, "stand", markdown(head, [list(row.cells) for row in stand]))
        between(PAGE, "refused", markdown("| robots | said |", rows))
    faults = [fault for row in stand for fault in row.faults]
    for fault in faults:
        print(f"missed: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
