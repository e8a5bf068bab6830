"""The drawings of the two phases of a read and of the rooms, in docs/explanation, as SVG.

`python -m tools.flow_drawing` writes both.  A test compares the rooms with the folders.
"""

from tools.frames_drawing import FOLDER, ORANGE, arrow, sheet
from tools.rests_drawing import BLUE, GREEN, INK, WASH, words

# The way of the data, room by room, with what leaves it.
LUTGEN = (
    ("urdf", "links, joints"),
    ("recipe", "postures"),
    ("support", "facets, region"),
    ("channels", "numbers"),
    ("mapping", "a map file"),
    ("analysis", "one posture"),
    ("search", "the best one"),
    ("plot", "figures"),
    ("paper", "its report"),
    ("cli", "commands"),
)
EXPORT = (
    ("truth", "exact answers"),
    ("protocol", "a blob"),
    ("contacts", "codec"),
    ("grid", "codec"),
    ("verdict", "codec"),
    ("emit", "C files"),
    ("certify", "errors"),
    ("choose", "the smallest"),
    ("control", "a policy"),
    ("explore", "a page"),
)


def box(
    x: float, y: float, size: tuple[float, float], said: tuple[str, str], fill: str = WASH
) -> str:
    """Return a box with a name and, below it, what comes out of it."""
    look = f'rx="4" fill="{fill}" stroke="{INK}"'
    middle = x + size[0] / 2
    return "\n".join(
        [
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{size[0]}" height="{size[1]}" {look}/>',
            words(middle, y + size[1] / 2 + (-4 if said[1] else 4), said[0], 'class="head"'),
            *([words(middle, y + size[1] / 2 + 13, said[1], 'class="mid"')] if said[1] else []),
        ]
    )


def rooms() -> str:
    """Return the rooms in two rows of five for each package."""
    lines = []
    for row, (package, listed) in enumerate((("lutgen", LUTGEN), ("firmware_export", EXPORT))):
        top = 24.0 + 190.0 * row
        lines.append(words(14, top, package, 'style="font-weight:bold"'))
        for place, said in enumerate(listed):
            x, y = 14.0 + 165.0 * (place % 5), top + 12 + 74.0 * (place // 5)
            lines.append(box(x, y, (140.0, 50.0), said))
            if place % 5 < 4:
                lines.append(arrow((x + 142, y + 25), (x + 163, y + 25)))
    lines.append(
        words(
            14,
            400,
            "Each room sees only rooms before it.  Of lutgen, firmware_export sees all but cli, ",
        )
    )
    lines.append(
        words(
            14,
            416,
            "and only cli sees firmware_export.  Below: what stands beside them and only looks on.",
        )
    )
    for place, name in enumerate(("tests", "proofs", "targets", "benchmarks", "tools")):
        lines.append(box(14.0 + 165.0 * place, 426, (140.0, 34.0), (name, ""), "white"))
    return sheet("The rooms of the two packages in the order of the data", lines, 470)


def reading() -> str:
    """Return the two phases of a read, and how often each happens."""
    lines = [
        box(14, 40, (170, 56), ("joints", "when they have moved"), "white"),
        box(240, 40, (170, 56), ("smap_pose", "facets, axes, gaps")),
        box(466, 40, (170, 56), ("pose", "the caller's memory"), "#d9efe6"),
        arrow((186, 68), (238, 68)),
        arrow((412, 68), (464, 68)),
        box(14, 150, (170, 56), ("accelerometer", "every sample"), "white"),
        box(466, 150, (170, 56), ("smap_at", "one facet, its axes")),
        box(690, 150, (136, 56), ("reading", "status, tip angle"), "#d9efe6"),
        arrow((186, 178), (464, 178)),
        arrow((551, 98), (551, 148)),
        arrow((638, 178), (688, 178)),
        words(14, 22, "what depends on the posture, once: thousands of instructions"),
        words(14, 136, "what depends on gravity, often: hundreds of instructions"),
    ]
    start, step = 80.0, 17.0
    lines.append(words(14, 252, "pose"))
    lines.append(words(14, 278, "read"))
    for k in range(43):
        x = start + step * k
        if k % 14 == 0:
            lines.append(f'<rect x="{x:.1f}" y="238" width="14" height="18" fill="{ORANGE}"/>')
        lines.append(f'<rect x="{x + 6:.1f}" y="266" width="3" height="14" fill="{BLUE}"/>')
    lines.append(
        f'<path d="M80 290 H812" stroke="{GREEN}" stroke-width="1.5" marker-end="url(#tip)"/>'
    )
    lines.append(words(782, 306, "time"))
    return sheet("The two phases of a read: once a posture, and once a sample", lines, 316)


DRAWINGS = {"rooms.svg": rooms, "reading.svg": reading}

if __name__ == "__main__":
    for name, drawing in DRAWINGS.items():
        (FOLDER / name).write_text(drawing(), encoding="utf-8")
