"""Public definitions of stability margins, written down from the papers and asked beside ours.

All of them judge one polygon of points on the ground.  Each takes its corners (k, 3) relative to
the com, counter-clockwise seen from below (as `points` of `lutgen.analysis.Facet`), and
directions of gravity (g, 3), unit vectors pointing down in the same frame.  Each returns (g,), the
smallest over the sides; a weight of 1 is meant where a definition asks for one.

- `static_margin`: McGhee and Frank, 1968.
- `zmp_distance`: the zero-moment point of Vukobratovic against the sides, in the plane of the
  ground; without motion that point is where gravity's ray pierces the plane.
- `energy_margin`: normalised energy stability margin, Hirose et al., as Garcia and de Santos (2005)
  write it: |R| (1 - cos theta) cos psi, with the sign of theta.
- `force_angle`: Papadopoulos and Rey, 1996, in the form of 2000: theta d |f|.

The library hector_stability_metrics has the first, third and fourth of them for gravity along -z;
tests compare with values that it gives.
"""

import numpy as np

from lutgen.vector import Floats


def _sides(corners: Floats) -> tuple[Floats, Floats]:
    """Return where each side begins (k, 3), and its direction (k, 3), a unit vector."""
    along = np.roll(corners, -1, axis=0) - corners
    return corners, along / np.linalg.norm(along, axis=1, keepdims=True)


def static_margin(corners: Floats, down: Floats) -> Floats:
    """Return the distance from the com to the nearest side, after projection along gravity."""
    begin, along = _sides(corners)
    # Of a side, and of gravity: the normal, in the horizontal plane, that points inward.
    normal = np.cross(down[:, None], along[None])
    length = np.linalg.norm(normal, axis=2)
    # A side that is vertical has no distance in that plane but that of its foot.
    with np.errstate(invalid="ignore", divide="ignore"):
        inward = (normal * -begin[None]).sum(axis=2) / length
    return np.asarray(np.where(length > 1e-12, inward, np.inf).min(axis=1))


def zmp_distance(corners: Floats, down: Floats) -> Floats:
    """Return the distance from the zero-moment point to the nearest side, in the ground's plane."""
    begin, along = _sides(corners)
    normal = np.cross(along[0], along[1])
    normal /= np.linalg.norm(normal)
    rate = down @ normal
    with np.errstate(invalid="ignore", divide="ignore"):
        point = down * ((corners[0] @ normal) / rate)[:, None]
    inward = np.cross(normal, along)
    return np.asarray(((point[:, None] - begin[None]) * inward[None]).sum(axis=2).min(axis=1))


def energy_margin(corners: Floats, down: Floats) -> Floats:
    """Return the least rise of the com over a side, negative beyond it."""
    begin, along = _sides(corners)
    arm = (begin * along).sum(axis=1, keepdims=True) * along - begin
    reach = np.linalg.norm(arm, axis=1)
    normal = np.cross(along[None], down[:, None])
    slant = np.linalg.norm(normal, axis=2)
    with np.errstate(invalid="ignore", divide="ignore"):
        aside = -(normal * arm[None]).sum(axis=2) / slant
    theta = np.arcsin(np.clip(aside / reach, -1.0, 1.0))
    # The cosine of the side's inclination is the length of its horizontal part.
    return np.asarray((np.sign(theta) * reach * (1.0 - np.cos(theta)) * slant).min(axis=1))


def force_angle(corners: Floats, down: Floats) -> Floats:
    """Return the force-angle measure of gravity alone, per unit of weight."""
    begin, along = _sides(corners)
    arm = begin - (begin * along).sum(axis=1, keepdims=True) * along
    force = down[:, None] - (down[:, None] * along[None]).sum(axis=2)[..., None] * along[None]
    size = np.linalg.norm(force, axis=2)
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = force / size[..., None]
    distance = np.linalg.norm(arm[None] - (arm[None] * unit).sum(axis=2)[..., None] * unit, axis=2)
    cosine = (arm[None] / np.linalg.norm(arm, axis=1)[None, :, None] * unit).sum(axis=2)
    turn = (np.cross(arm[None], unit) * along[None]).sum(axis=2)
    theta = np.sign(-turn) * np.arccos(np.clip(cosine, -1.0, 1.0))
    return np.asarray((theta * distance * size).min(axis=1))


MARGINS = {
    "static_margin": static_margin,
    "zmp_distance": zmp_distance,
    "energy_margin": energy_margin,
    "force_angle": force_angle,
}
