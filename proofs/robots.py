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
import sys
from collections.abc import Sequence
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
from lutgen.urdf import (
    Meshes,
    Sources,
    UrdfRobot,
    centre_of_mass,
    load_srdf,
    load_urdf,
    places,
    read_motion,
    srdf_beside,
)
from proofs.physics.body import recipe_posture
from proofs.physics.page import MEASURED, page
from proofs.physics.release import falls
from proofs.physics.start import pierced

PAGE = MEASURED / "robots.md"
# Files in the folder of robots: those that stand, and those that are bolted down or fly.
STAND = {
    "a1": "a1_description/urdf/a1",
    "alexander": "alexander_description/urdf/alexander_v1.lowerBodyOnly",
    "anymal b": "anymal_b_simple_description/robots/anymal",
    "anymal c": "anymal_c_simple_description/urdf/anymal",
    "b1": "b1_description/urdf/b1",
    "b1 with z1": "b1_description/urdf/b1-z1",
    "baxter": "baxter_description/urdf/baxter",
    "bolt": "bolt_description/robots/bolt",
    "centauro": "centauro_description/urdf/centauro",
    "g1": "g1_description/urdf/g1_29dof_rev_1_0",
    "go1": "go1_description/urdf/go1",
    "go2": "go2_description/urdf/go2",
    "hyq": "hyq_description/robots/hyq_no_sensors",
    "icub": "icub_description/robots/icub",
    "laikago": "laikago_description/urdf/laikago",
    "pr2": "pr2_description/urdf/pr2",
    "romeo": "romeo_description/urdf/romeo",
    "solo": "solo_description/robots/solo",
    "solo12": "solo_description/robots/solo12",
    "talos": "talos_data/robots/talos_reduced",
    "tiago": "tiago_description/robots/tiago",
    "tiago pro": "tiago_pro_description/robots/tiago_pro",
}
REFUSED = {
    "allegro hand": "allegro_hand_description/urdf/allegro_left_hand",
    "double pendulum": "double_pendulum_description/urdf/double_pendulum",
    "finger edu": "finger_edu_description/robots/finger_edu",
    "iris": "iris_description/robots/iris",
    "kinova": "kinova_description/robots/kinova",
    "panda": "panda_description/urdf/panda",
    "so100": "so_arm_description/urdf/so100",
    "talos left arm": "talos_data/robots/talos_left_arm",
    "ur5": "ur_description/urdf/ur5_robot",
    "xarm7": "xarm_description/urdf/xarm7",
    "z1": "z1_description/urdf/z1",
}
TILTED = ("a1", "anymal b", "b1", "baxter", "go2", "hyq", "laikago", "pr2", "solo", "tiago pro")
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
    cells = (
        *(name, source, f"{touching}{' (meshes)' if made.guessed else ''}", parameters(made)),
        f"{rounded_down(math.degrees(body)):.2f}" if stands else "tips on level ground",
        f"{rounded_down(math.degrees(ground.guaranteed)):.2f}" if stands else "-",
        f"{math.degrees(limits.worst.heading):.1f}" if stands else "-",
        *("equal" if not faults or "engine" in faults[0] else "differ", share),
    )
    return Row(cells, tuple(f"{name}: {fault}" for fault in faults))


def refused(name: str, path: Path) -> Row:
    """Return the row of a robot that does not stand on the ground."""
    try:
        imported(path)
    except LutgenError as error:
        why = str(error).removeprefix(f"{path}: ")
        good = why.startswith("nothing stands on the ground")
        return Row((name, why), () if good else (f"{name}: refused for another reason: {why}",))
    return Row((name, "imported"), (f"{name}: is imported",))


def table(head: str, rows: Sequence[Row]) -> str:
    """Return rows as Markdown."""
    columns = head.count("|") - 1
    lines = [head, "|" + "---|" * columns, *(f"| {' | '.join(row.cells)} |" for row in rows)]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run everything, or the robots that are named."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="robots of the table (default: all)")
    parser.add_argument("--update", action="store_true", help=f"write {PAGE.name}")
    options = parser.parse_args()
    if options.update and options.names:
        parser.error("--update is for all robots; name none")
    folder = data()
    wanted = set(options.names or (*STAND, *REFUSED))
    stand, bolted = [], []
    for name, file in STAND.items():
        if name in wanted:
            try:
                stand.append(measured(name, folder / f"{file}.urdf"))
            except LutgenError as error:
                stand.append(Row((name, str(error)), (f"{name}: {error}",)))
            print(" | ".join(stand[-1].cells), flush=True)
    for name, file in REFUSED.items():
        if name in wanted:
            bolted.append(refused(name, folder / f"{file}.urdf"))
            print(" | ".join(bolted[-1].cells), flush=True)
    if options.update:
        text = PAGE.read_text(encoding="utf-8")
        head = (
            "| robot | posture | contacts | parameters | body tilt, guaranteed (deg) "
            "| ground tilt, guaranteed (deg) | worst heading (deg) | mass and com | engine |"
        )
        text = page(text, "stand", table(head, stand))
        text = page(text, "refused", table("| robot | said |", bolted))
        PAGE.write_text(text, encoding="utf-8")
    faults = [fault for row in (*stand, *bolted) for fault in row.faults]
    for fault in faults:
        print(f"missed: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
