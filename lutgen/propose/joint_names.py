"""What the name of a joint says beside the side that it is on.

Owns which words are sides.  Whether joints are alike is not known here.
"""

import re
from collections.abc import Sequence

# Parts of a name that say where a joint is and not what it is.
SIDES = frozenset(
    (
        *("left", "right", "l", "r", "middle", "mid", "ml", "mr", "lm", "rm"),
        *("front", "fore", "f", "fl", "fr", "lf", "rf"),
        *("rear", "hind", "back", "h", "rl", "rr", "lr", "lh", "rh", "hl", "hr"),
        *("bl", "br", "lb", "rb"),
    )
)
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def stem(name: str) -> tuple[str, ...]:
    """Return what a joint's name says beside the side that it is on, in lower case.

    Examples
    --------
    >>> stem("FL_hip_joint") == stem("rear_right_hip")
    True
    >>> stem("LHipYawPitch")
    ('hip', 'yaw', 'pitch')
    """
    words = [word.lower() for word in WORD.findall(name)]
    return tuple(word for word in words if word not in SIDES and word != "joint")


def common_name(names: Sequence[str]) -> str:
    """Return a name for joints that are alike: the words that all of them have.

    Examples
    --------
    >>> common_name(["FL_hip_joint", "FR_hip_joint"])
    'hip'
    >>> common_name(["hip_yaw_1", "hip_yaw_2"])
    'hip_yaw'
    """
    own = [word for word in WORD.findall(names[0]) if word.lower() in stem(word)]
    words = [
        shown
        for shown, *same in zip(own, *(stem(name) for name in names), strict=False)
        if len(set(same)) == 1
    ]
    return "_".join(words) or names[0]
