"""The drawing of rests, stages and gaps in docs/reference/conventions.md, as SVG.

`python -m tools.rests_drawing` writes it.  Three robots on wheels are seen from their right side:
what their planes are is their hull, and how high the com is while they roll is computed from it.
"""

import math
from dataclasses import dataclass
from pathlib import Path

TARGET = Path(__file__).resolve().parents[1] / "docs/reference/rests.svg"
WIDTH, HEIGHT, PANEL = 840, 430, 280
GREEN, GREY, INK, BLUE, WASH = "#009E73", "#8c8c8c", "#222222", "#0072B2", "#f0f0f0"


@dataclass(frozen=True)
class Drawn:
    """A robot as it is drawn: its wheels (x, z) from the nose back, and what each plane is.

    `kinds` of the planes from one wheel to the next: "rest A", "stage"; `caught` colours the gap.
    """

    title: str
    wheels: tuple[tuple[float, float], ...]
    radius: float
    kinds: tuple[str, ...]
    caught: bool
    said: str


ROBOTS = (
    Drawn(
        "a gap",
        ((0.5, -0.3), (0.0, -0.42), (-0.5, -0.3)),
        0.15,
        ("rest A", "rest B"),
        True,
        "caught: it has not the energy",
    ),
    Drawn(
        "a gap with a stage",
        ((0.5, -0.3), (0.04, -0.42), (-0.04, -0.42), (-0.5, -0.3)),
        0.15,
        ("rest A", "stage", "rest B"),
        True,
        "caught on either side of the stage",
    ),
    Drawn(
        "not caught",
        ((0.16, -0.42), (0.0, -0.462), (-0.16, -0.42)),
        0.07,
        ("rest A", "rest B"),
        False,
        "not caught: it goes on over the end",
    ),
)


def normals(robot: Drawn) -> list[float]:
    """Return the pitch (rad) of each plane: how far its outward normal is turned to the nose."""
    pairs = zip(robot.wheels, robot.wheels[1:], strict=False)
    return [math.atan2(a[1] - b[1], a[0] - b[0]) for a, b in pairs]


def contact(robot: Drawn, wheel: int, pitch: float) -> tuple[float, float]:
    """Return where a wheel touches a plane of a pitch."""
    x, z = robot.wheels[wheel]
    return x + robot.radius * math.sin(pitch), z - robot.radius * math.cos(pitch)


def height(robot: Drawn, pitch: float) -> float:
    """Return how high the com is above level ground when its down direction has a pitch."""
    return robot.radius + max(x * math.sin(pitch) - z * math.cos(pitch) for x, z in robot.wheels)


def balance(robot: Drawn) -> float:
    """Return the height of the com where it balances in the middle: half-way over its gap."""
    return height(robot, 0.0)


def path(points: list[tuple[float, float]], look: str, closed: bool = False) -> str:
    """Return a path through points on the paper."""
    steps = " L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    return f'<path d="M{steps}{" Z" if closed else ""}" {look}/>'


def words(x: float, y: float, text: str, look: str = "") -> str:
    """Return a text around a place on the paper."""
    return f'<text x="{x:.1f}" y="{y:.1f}" {look}>{text}</text>'


def side_view(robot: Drawn, left: float) -> list[str]:
    """Return the upper picture: the robot, its planes, and the directions of gravity."""
    scale = 195.0 if robot.wheels[0][0] > 0.3 else 270.0
    top = 62.0

    def on(point: tuple[float, float]) -> tuple[float, float]:
        return left + PANEL / 2 + scale * point[0], top - scale * point[1]

    turns, last = normals(robot), len(robot.wheels) - 1
    com = on((0.0, 0.0))
    lines = []
    for k, kind in enumerate(robot.kinds):
        here, there = contact(robot, k, turns[k]), contact(robot, k + 1, turns[k])
        fill = f'fill="{GREEN}" fill-opacity="0.30"'
        if kind == "stage":
            fill = 'fill="url(#rocks)"'
        lines.append(path([com, on(here), on(there)], fill, closed=True))
    for k in range(1, last):
        rim = [
            on(contact(robot, k, turns[k - 1] + (turns[k] - turns[k - 1]) * part / 12))
            for part in range(13)
        ]
        fill = 'fill="url(#rocks)"' if robot.caught else 'fill="url(#tips)"'
        lines.append(path([com, *rim], fill, closed=True))
        lines.append(path(rim, f'fill="none" stroke="{BLUE}" stroke-width="3.5"'))
    for k in range(len(robot.kinds)):
        ends = [on(contact(robot, wheel, turns[k])) for wheel in (k, k + 1)]
        lines.append(path(ends, f'stroke="{INK}" stroke-width="1.6"'))
    for end, turn in ((0, turns[0]), (last, turns[-1])):
        side = 1.0 if end == 0 else -1.0
        out = contact(robot, end, turn)
        beyond = (out[0] + side * 22 / scale, out[1] + 40 / scale)
        lines.append(path([com, on(out), on(beyond)], 'fill="url(#tips)"', closed=True))
    look = f'fill="none" stroke="{INK}" stroke-width="1"'
    for wheel in robot.wheels:
        x, y = on(wheel)
        lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{scale * robot.radius:.1f}" {look}/>')
    lines.append(f'<circle cx="{com[0]:.1f}" cy="{com[1]:.1f}" r="3.5" fill="{INK}"/>')
    lines.append(words(com[0] + 8, com[1] - 4, "com"))
    lines.append(words(left + PANEL / 2, 22, robot.title, 'class="head"'))
    names = ("rest B", "stage" if "stage" in robot.kinds else "arc", "rest A")
    for side, name in zip((-1, 0, 1), names, strict=True):
        lines.append(words(com[0] + 68 * side, 226, name, 'text-anchor="middle"'))
    return lines


def height_curve(robot: Drawn, left: float) -> list[str]:
    """Return the lower picture: how high the com is while the robot rolls on level ground."""
    outer = max(math.atan2(x, -z) for x, z in robot.wheels)
    reach = outer + math.radians(7.0)
    lowest = min(height(robot, reach * i / 200) for i in range(-200, 201))
    highest = max(height(robot, reach * i / 200) for i in range(-200, 201))
    floor, room = 372.0, 92.0

    def on(pitch: float, high: float) -> tuple[float, float]:
        return (
            left + PANEL / 2 + 118.0 * pitch / reach,
            floor - room * (high - lowest) / (highest - lowest),
        )

    curve = [on(p, height(robot, p)) for p in (reach * i / 200 for i in range(-200, 201))]
    ends = [(left + PANEL / 2 + 118.0 * side, floor + 8) for side in (1, -1)]
    lines = [path([*curve, *ends], f'fill="{WASH}"', closed=True)]
    lines.append(path(curve, f'fill="none" stroke="{INK}" stroke-width="1.4"'))
    level = balance(robot)
    dashes = f'stroke="{BLUE}" stroke-width="1" stroke-dasharray="4 3"'
    lines.append(path([on(-reach, level), on(reach, level)], dashes))
    x, y = on(0.0, level)
    lines.append(f'<circle cx="{x:.1f}" cy="{y - 5:.1f}" r="5" fill="{BLUE}"/>')
    turns = normals(robot)
    for k, kind in enumerate(robot.kinds):
        if kind != "stage":
            x, y = on(turns[k], height(robot, turns[k]))
            lines.append(words(x, y + 13, kind[-1], 'text-anchor="middle"'))
    lines.append(words(left + PANEL / 2, 404, robot.said, 'text-anchor="middle"'))
    return lines


def pattern(name: str, colour: str, lean: int) -> str:
    """Return a hatching."""
    line = f'<path d="M0 0 V6" stroke="{colour}" stroke-width="1.6"/>'
    turned = f'width="6" height="6" patternTransform="rotate({lean})"'
    return f'<pattern id="{name}" patternUnits="userSpaceOnUse" {turned}>{line}</pattern>'


def drawing() -> str:
    """Return the SVG."""
    style = (
        "text { font: 12px 'DejaVu Sans', Arial, sans-serif; fill: #222222 } "
        ".head { font-weight: bold; text-anchor: middle }"
    )
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'width="{WIDTH}" height="{HEIGHT}" role="img">',
        "<title>Rests, stages and gaps of three robots, seen from the side</title>",
        f"<defs><style>{style}</style>{pattern('rocks', GREEN, 45)}{pattern('tips', GREY, -45)}"
        "</defs>",
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
    ]
    for place, robot in enumerate(ROBOTS):
        left = float(PANEL * place)
        lines += [*side_view(robot, left), *height_curve(robot, left)]
    lines.append(words(8, 257, "height of the com while it rolls on level ground:"))
    keys = (
        (f'fill="{GREEN}" fill-opacity="0.30"', "stands"),
        ('fill="url(#rocks)"', "rocks"),
        ('fill="url(#tips)"', "tips over"),
    )
    for place, (fill, name) in enumerate(keys):
        x = 540 + 92 * place
        lines.append(f'<rect x="{x}" y="247" width="18" height="11" {fill} stroke="{INK}"/>')
        lines.append(words(x + 24, 257, name))
    return "\n".join([*lines, "</svg>", ""])


if __name__ == "__main__":
    TARGET.write_text(drawing(), encoding="utf-8")
