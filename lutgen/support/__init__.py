"""One posture into its support facets and its standing region.

In reading order: `primitive`, `table`, `polygon`, `tilting`, `gather`, `facets`, `pivots`,
`region`, `rolling`, `gaps`.
"""

from lutgen.support.gaps import stand
from lutgen.support.polygon import plane_axes
from lutgen.support.primitive import (
    AXLE,
    DISC,
    FACE_ANGLE,
    FIRST,
    SPHERE,
    STICKS_OUT,
    lies_within,
    pack,
    support_contact,
    support_height,
)
from lutgen.support.region import ON_AXIS, cone_of, seat_under
from lutgen.support.rolling import arc_between, roll_over, turned
from lutgen.support.table import (
    MAX_PRIMITIVES,
    REGION,
    ROCKS,
    STANDS,
    TIPS,
    Acceptance,
    Region,
    acceptance,
    edge_after,
    empty_region,
    ends_of,
    is_inner,
    is_same_rest,
    record,
    rests_at,
    robot_size,
)
