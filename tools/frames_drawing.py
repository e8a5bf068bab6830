"""The drawings of frames and of the chart of gravity in docs/explanation, as SVG.

`python -m tools.frames_drawing` writes both.  Angles and places are computed: what is drawn at 30
deg is at 30 deg, and the outline on the chart is where a rectangle of contacts tips over.
"""

import math
from pathlib import Path

from tools.rests_drawing import BLUE, GREEN, GREY, INK, path, words

FOLDER = Path(__file__).resolve().parents[1] / "docs/explanation"
WIDTH, HEIGHT, PANEL = 840, 300, 280
ORANGE = "#B94700"
MID, HEAD = 'class="mid"', 'class="head"'
# Contacts of the robot on the chart, relative to its com: x, y and height.
FEET = ((0.45, 0.25), (-0.35, 0.25), (-0.35, -0.25), (0.45, -0.25))
DROP = 0.4
MAX_TILT = math.radians(60.0)


def sheet(title: str, lines: list[str], height: int = HEIGHT) -> str:
    """Return an SVG with a title for those who hear it."""
    style = (
        "text { font: 12px 'DejaVu Sans', Arial, sans-serif; fill: #222222 } "
        ".head { font-weight: bold; text-anchor: middle } .mid { text-anchor: middle }"
    )
    tip = '<path d="M0 0 L8 3 L0 6 Z" fill="context-stroke"/>'
    marker = (
        '<marker id="tip" markerWidth="8" markerHeight="6" refX="7" refY="3" orient="auto">'
        f"{tip}</marker>"
    )
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
            f'width="{WIDTH}" height="{height}" role="img">',
            f"<title>{title}</title>",
            f"<defs><style>{style}</style>{marker}</defs>",
            f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
            *lines,
            "</svg>",
            "",
        ]
    )


def arrow(start: tuple[float, float], end: tuple[float, float], colour: str = INK) -> str:
    """Return an arrow between two places on the paper."""
    look = f'fill="none" stroke="{colour}" stroke-width="2" marker-end="url(#tip)"'
    return path([start, end], look)


def _side(left: float, pitch: float, title: str) -> list[str]:
    """Return a robot seen from its right side, its nose lowered by a pitch (rad)."""
    middle = (left + PANEL / 2, 140.0)

    def on(x: float, z: float) -> tuple[float, float]:
        turn, scale = (math.cos(pitch), math.sin(pitch)), 150.0
        return (
            middle[0] + scale * (x * turn[0] + z * turn[1]),
            middle[1] + scale * (x * turn[1] - z * turn[0]),
        )

    outline = [on(-0.4, 0.12), on(0.3, 0.12), on(0.42, -0.1), on(-0.4, -0.1)]
    lines = [path(outline, f'fill="#f0f0f0" stroke="{INK}"', closed=True)]
    for x in (-0.3, 0.3):
        at = on(x, -0.18)
        lines.append(
            f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="18" fill="none" stroke="{INK}"/>'
        )
    ground = [on(-0.62, -0.3), on(0.62, -0.3)]
    lines.append(path(ground, f'stroke="{GREY}" stroke-width="2"'))
    ends = {"x": on(0.62, 0.0), "z": on(0.0, 0.5)}
    for name, end in ends.items():
        lines += [arrow(middle, end), words(end[0] + 6, end[1] - 4, name)]
    down = (middle[0], middle[1] + 100.0)
    lines += [
        arrow(middle, down, BLUE),
        words(down[0] + 8, down[1], "gravity_dir", f'style="fill:{BLUE}"'),
    ]
    up = (middle[0], middle[1] - 95.0)
    if pitch == 0.0:
        lines.append(
            words(middle[0] + 8, middle[1] - 56, "up_dir: accelerometer", f'style="fill:{ORANGE}"')
        )
        lines.append(
            words(middle[0] + 8, middle[1] - 42, "at rest reads this", f'style="fill:{ORANGE}"')
        )
    lines.append(arrow(middle, (up[0], up[1] + (25.0 if pitch == 0.0 else 0.0)), ORANGE))
    lines.append(f'<circle cx="{middle[0]:.1f}" cy="{middle[1]:.1f}" r="4" fill="{INK}"/>')
    lines.append(words(middle[0] - 34, middle[1] - 8, "com"))
    return [*lines, words(left + PANEL / 2, 22, title, HEAD)]


def frames() -> str:
    """Return the drawing of the body frame, of tilt and of heading."""
    tilt = math.radians(20.0)
    lines = _side(0.0, 0.0, "level: gravity_dir (0, 0, -1)")
    lines += _side(PANEL, tilt, "nose down by t: (sin t, 0, -cos t)")
    left, middle = 2.0 * PANEL, (2.5 * PANEL, 150.0)
    lines.append(words(left + PANEL / 2, 22, "heading: which side is low", HEAD))
    lines.append(words(left + PANEL / 2, 40, "seen from above, y to the left", MID))
    box = [(middle[0] - 32, middle[1] - 50), (middle[0] + 32, middle[1] - 50)]
    box += [(middle[0] + 32, middle[1] + 50), (middle[0] - 32, middle[1] + 50)]
    lines.append(path(box, f'fill="#f0f0f0" stroke="{INK}"', closed=True))
    for angle, said in ((0, "0: nose"), (90, "90: left"), (180, "180: tail"), (270, "270: right")):
        turn = math.radians(angle)
        end = (middle[0] - 80 * math.sin(turn), middle[1] - 80 * math.cos(turn))
        lines.append(arrow(middle, end, BLUE))
        shift = -8 if angle in (0,) else 16
        lines.append(words(end[0], end[1] + shift, said, MID))
    lines.append(words(140, 286, "seen from the right; y points away", MID))
    lines.append(words(420, 286, "the body frame turns with the robot", MID))
    lines.append(words(700, 286, "degrees, downhill in the body frame", MID))
    return sheet("The body frame, gravity and its opposite, tilt and heading", lines)


def _section(left: float) -> list[str]:
    """Return the cut through the sphere: even nodes of the chart, and their directions."""
    com, radius = (left + PANEL / 2, 80.0), 90.0
    floor = com[1] + radius
    lines = [words(left + PANEL / 2, 22, "even nodes on a plane below the com", HEAD)]
    reach = math.tan(math.radians(52.0))
    lines.append(
        path(
            [(com[0] - reach * radius, floor), (com[0] + reach * radius, floor)], f'stroke="{INK}"'
        )
    )
    arc = [
        (com[0] + radius * math.sin(a), com[1] + radius * math.cos(a))
        for a in (math.radians(k) for k in range(-90, 91, 5))
    ]
    lines.append(path(arc, f'fill="none" stroke="{GREY}"'))
    for k in range(-4, 5):
        x = com[0] + reach * radius * k / 4
        lines.append(path([com, (x, floor)], f'stroke="{BLUE}" stroke-width="0.8"'))
        lines.append(f'<circle cx="{x:.1f}" cy="{floor:.1f}" r="3" fill="{BLUE}"/>')
    lines.append(words(com[0] + 8, com[1] - 6, "com"))
    lines.append(words(left + PANEL / 2, 196, "u = g_x / -g_z,  v = g_y / -g_z", MID))
    lines.append(words(left + PANEL / 2, 214, "tilt = atan of the distance from the middle", MID))
    return lines


def outline() -> list[tuple[float, float]]:
    """Return (u, v) of the corners of the region: where the rays to the contacts meet the chart."""
    return [(x / DROP, y / DROP) for x, y in FEET]


def _square(left: float) -> list[str]:
    """Return the chart of a cone, with circles of equal tilt and the region of a robot."""
    half, scale = math.tan(MAX_TILT), 110.0 / math.tan(MAX_TILT)
    middle = (left + PANEL / 2, 160.0)

    def on(u: float, v: float) -> tuple[float, float]:
        return middle[0] - scale * v, middle[1] - scale * u

    corners = [on(half, half), on(half, -half), on(-half, -half), on(-half, half)]
    lines = [path(corners, f'fill="white" stroke="{INK}"', closed=True)]
    region = [on(u, v) for u, v in outline()]
    lines.append(path(region, f'fill="{GREEN}" fill-opacity="0.3" stroke="{GREEN}"', closed=True))
    for tilt in (20, 40, 60):
        size = scale * math.tan(math.radians(tilt))
        dash = f'fill="none" stroke="{GREY}" stroke-dasharray="4 3"'
        lines.append(f'<circle cx="{middle[0]}" cy="{middle[1]}" r="{size:.1f}" {dash}/>')
        lines.append(words(middle[0] + 0.71 * size, middle[1] - 0.71 * size, f"{tilt}°"))
    lines.append(words(left + PANEL / 2, 22, "chart cone: one face, |u|, |v| ≤ tan 60°", HEAD))
    lines.append(words(left + PANEL / 2, 40, "green: a rectangle of contacts stands", MID))
    lines.append(words(middle[0], 290, "the sides of the region are straight lines", MID))
    return lines


def _cross(left: float) -> list[str]:
    """Return the six faces of the chart of the whole sphere, unfolded."""
    side, middle = 56.0, (left + PANEL / 2, 150.0)
    places = {0: (0, 0), 1: (0, -1), 2: (0, 1), 3: (-1, 0), 4: (1, 0), 5: (2, 0)}
    middles = ("-z", "+x", "-x", "+y", "-y", "+z")
    lines = [words(left + PANEL / 2, 22, "chart sphere: six faces", HEAD)]
    for face, (across, down) in places.items():
        x, y = middle[0] + (across - 0.9) * side, middle[1] + (down - 0.5) * side
        fill = "#d9efe6" if face == 0 else "white"
        lines.append(
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{side}" height="{side}" '
            f'fill="{fill}" stroke="{INK}"/>'
        )
        lines.append(words(x + side / 2, y + 25, str(face), HEAD))
        lines.append(words(x + side / 2, y + 42, middles[face], MID))
    lines.append(words(left + PANEL / 2, 256, "face 0 is the cone; the direction in the", MID))
    lines.append(words(left + PANEL / 2, 272, "middle of each face is written in it", MID))
    return lines


def chart() -> str:
    """Return the drawing of the chart of gravity."""
    lines = [*_section(0.0), *_square(float(PANEL)), *_cross(2.0 * PANEL)]
    return sheet("How directions of gravity become the nodes of a table", lines)


DRAWINGS = {"frames.svg": frames, "chart.svg": chart}

if __name__ == "__main__":
    for name, drawing in DRAWINGS.items():
        (FOLDER / name).write_text(drawing(), encoding="utf-8")
