"""Parse XML that nobody vouches for.

Owns the refusal of document types: without them there are no entities, so none that expands and
none that names a file.  Tags keep their namespace prefix as written.
"""

from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from lutgen.errors import RecipeError

MAX_DEPTH = 100


def parse_xml(content: bytes, source: str) -> Element:
    """Return the root element of XML in an encoding that it declares, UTF-8 otherwise.

    RecipeError is raised for what is not well-formed, for a document type declaration and for
    elements nested deeper than 100.
    """
    builder = TreeBuilder()
    depth = 0

    def refuse(what: str, got: str, way_out: str) -> NoReturn:
        line = parser.CurrentLineNumber
        raise RecipeError(f"{source}: line {line}: {what} (got {got}); {way_out}.")

    def doctype(name: str, *_: object) -> None:
        refuse("has a document type declaration", f"<!DOCTYPE {name[:40]}", "remove it")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            refuse(f"elements are nested deeper than {MAX_DEPTH}", f"<{tag[:40]}>", "flatten them")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, LookupError, ValueError) as error:
        if isinstance(error, RecipeError):
            raise
        raise RecipeError(f"{source}: is not XML (got {error}); correct that line.") from None
    return builder.close()
