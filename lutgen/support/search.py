"""One posture, from primitives to its standing region."""

from lutgen.jit import njit
from lutgen.support.covered import show
from lutgen.support.facets import find_facets
from lutgen.support.gaps import find_gaps
from lutgen.support.primitive import contact_count
from lutgen.support.region import add_boundary, add_rests
from lutgen.support.rests import find_rests
from lutgen.support.table import SHOWN, Acceptance, Region, robot_size
from lutgen.vector import Floats


@njit(bare=True)
def stand(region: Region, primitives: Floats, accept: Acceptance) -> None:
    """Find where one posture stands.

    Parameters
    ----------
    region : Region
        Overwritten; as `empty_region` makes it for so many primitives.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    accept : Acceptance
        Limits of facets and rests, and how far the robot rocks.
    """
    contacts = contact_count(primitives)
    places, axles = primitives[:contacts], primitives[contacts:]
    size = robot_size(places)
    count = show(places, size, region.shown, region.source)
    region.counts[SHOWN] = count
    shown = region.shown[:count]
    find_facets(shown, region, size, accept.steepest)
    find_rests(shown, axles, region, accept, size)
    add_rests(region)
    add_boundary(region, find_gaps(shown, region, accept))
