"""Parse untrusted XML, and read checked values of its elements.

Document types are refused: without them there are no entities, so none that expands and none that
names a file.  Tags keep their namespace prefix as written.  An angle is what its printed digits
stand for: a wheel whose axle is turned by 1.57 is not level, and no two are parallel.
"""

import math
from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from lutgen import bounds
from lutgen.arrays import Vector
from lutgen.errors import RecipeError, reject
from lutgen.parts import three

MAX_NAME = 200
# Sums and products over a chain of links stay far from infinity.
LARGEST = float(bounds.MAGNITUDE.most)


def parse_xml(content: bytes, source: str) -> Element:
    """Return the root element of XML in an encoding that it declares, UTF-8 otherwise.

    RecipeError is raised for what is not well-formed and for a document type declaration.
    """
    builder, parser = TreeBuilder(), expat.ParserCreate()

    def doctype(name: str, *_: object) -> None:
        what = f"line {parser.CurrentLineNumber}: has a document type declaration"
        reject(source, what, f"<!DOCTYPE {name[:40]}", "remove it")

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(content, True)
    except RecipeError:
        raise
    except (expat.ExpatError, LookupError, ValueError) as error:
        raise RecipeError(f"{source}: is not XML (got {error}); correct that line.") from None
    return builder.close()


class Elements:
    """Reads values of elements; every message names the file and the element."""

    def __init__(self, source: str) -> None:
        self.source = source

    def fail(self, where: str, what: str, got: object, way_out: str) -> NoReturn:
        """Refuse an element."""
        shown = repr(got)
        shown = shown if len(shown) <= 80 else shown[:77] + "..."
        reject(f"{self.source}: {where}", what, shown, way_out)

    def name(self, element: Element) -> str:
        """Return the name of the robot, a link or a joint."""
        name = element.get("name", "")
        if not name.strip():
            self.fail(f"a <{element.tag}>", "has no name", name, "name it")
        if len(name) > MAX_NAME or not name.isprintable():
            way_out = f"use at most {MAX_NAME} characters that can be printed"
            self.fail(f"a <{element.tag}>", "has an unusable name", name, way_out)
        return name

    def only(self, element: Element, tag: str, where: str) -> Element:
        """Return the one child of that tag, or one that says nothing."""
        found = element.findall(tag)
        if len(found) > 1:
            self.fail(where, f"has more than one <{tag}>", len(found), "keep one")
        return found[0] if found else Element(tag)

    def numbers(
        self, element: Element, key: str, where: str, count: int, most: float = LARGEST
    ) -> tuple[float, ...]:
        """Return so many numbers of at most `most` from an attribute."""
        text = element.get(key)
        values = floats(text or "")
        if len(values) != count or not all(abs(x) <= most for x in values):
            noun, form = ("number", "one number") if count == 1 else ("vector", "three numbers")
            way_out = f"write {key}='...' with {form} and blanks between several"
            self.fail(where, f"<{element.tag}> has no {noun} as {key}", text, way_out)
        return values

    def number(
        self,
        element: Element,
        key: str,
        where: str,
        default: float | None = None,
        most: float = LARGEST,
    ) -> float:
        """Return a number of at most `most` from an attribute."""
        if default is not None and key not in element.attrib:
            return default
        return self.numbers(element, key, where, 1, most)[0]

    def vector(self, element: Element, key: str, where: str, default: Vector) -> Vector:
        """Return three numbers of at most LARGEST from an attribute."""
        if key not in element.attrib:
            return default
        return three(self.numbers(element, key, where, 3))


def floats(text: str) -> tuple[float, ...]:
    """Return the numbers of a text with blanks between them; none if any is no number."""
    try:
        return tuple(math.nan if "_" in part else float(part) for part in text.split())
    except ValueError:
        return ()


# From how many decimals on a number is one of these parts of a turn, where its digits say so.
PARTS = ((math.pi / 2.0, 2), (math.pi / 4.0, 3), (math.pi / 12.0, 4))
# Nearer (rad) it is the part for any digits: single precision has no more of them.
SINGLE = 5e-7


def meant(text: str) -> float:
    """Return the angle (rad) that a printed number stands for.

    A part of a turn where the text is that number cut off or rounded at its last decimal: of
    quarters from two decimals on (1.57, 3.14), of eighths from three (0.785), of twenty-fourths
    from four (0.5236).  Any other number is what it says.
    """
    value = float(text)
    decimals = len(text.lower().partition("e")[0].partition(".")[2])
    plain = "e" not in text.lower()
    for part, least in PARTS:
        count = round(value / part)
        exact = count * part
        if count == 0 or abs(count) > 2.0 * math.pi / part + 0.5:
            continue
        off, last = abs(value - exact), 10.0**-decimals
        # A number cut off is nearer to zero than what it stands for.
        digits = off <= 0.5 * last * (1.0 + 1e-9) or (off < last and abs(value) < abs(exact))
        if off <= SINGLE or (plain and decimals >= least and digits):
            return exact
    return value


def parts_of_turns(printed: str) -> tuple[Vector, list[str]]:
    """Return the angles (rad) that three printed numbers stand for, and those that differ."""
    texts = printed.split()
    angles = three(map(meant, texts))
    pairs = zip(texts, angles, strict=True)
    return angles, [text for text, angle in pairs if abs(float(text) - angle) > SINGLE]
