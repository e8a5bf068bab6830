"""Real robots from their URDF files, where those are; both are other people's files."""

from lutgen.urdf.read import load_urdf
from proofs.descriptions import FOLDER
from proofs.physics.cases import Case, any_direction
from proofs.physics.robots import any_posture

# Name of the file, and up to which tilt (deg) it is tried.
ROBOTS = {"absolem": 80.0, "husky": 75.0}
NUMBER = 250


def real_cases() -> tuple[dict[str, Case], list[str]]:
    """Return a case for each robot that is there, and a sentence for each that is not."""
    try:
        from lutgen.recipe.proposal import import_urdf
    except ImportError:
        return {}, ["the robots of URDF files are left out: lutgen cannot import them yet"]
    found, absent = {}, []
    for name, tilt in ROBOTS.items():
        path = FOLDER / f"{name}.urdf"
        if not path.is_file():
            absent.append(f"{name} is left out: {path} is not there; set LUTGEN_ROBOTS")
            continue
        recipe = import_urdf(load_urdf(path)).recipe
        found[f"{name.capitalize()}, URDF"] = Case(any_posture(recipe), any_direction(tilt), NUMBER)
    return found, absent
