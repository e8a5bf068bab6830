"""The reference of C.  Owns how the two headers become a page: their comments, as they stand.

The headers are written for people, in one style: a comment before a function is its manual, one
behind a member or a constant says what it is, and a line of dashes begins a section.  What has no
comment of its own is told by the section.
"""

import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

__all__ = ["HEADERS", "Function", "functions", "page"]

_RUNTIME = Path(__file__).parents[2] / "firmware_export" / "runtime"
HEADERS = (_RUNTIME / "smap.h", _RUNTIME / "smap_control.h")
_HEAD = """# Every function of C

Made from the headers by `make docs`: these are the comments of `smap.h` and `smap_control.h` as
they stand in every export. [Firmware](../guide/firmware.md) and
[on-board control](../guide/control.md) show them at work; which name may change when is in the
[deprecation policy](deprecation.md).
"""
_SECTION = re.compile(r"/\* -{4,} (.*?) -+ \*/")
_COMMENT = re.compile(r"/\*(.*?)\*/", re.DOTALL)
_FUNCTION = re.compile(
    r"(?:/\*((?:[^*]|\*(?!/))*)\*/\n)?static inline (\w+) (\w+)\((.*?)\)\n\{", re.DOTALL
)
_RECORD = re.compile(r"typedef (struct|enum) \{(.*?)\} (\w+);", re.DOTALL)
_MEMBER = re.compile(r"^\s*([^/;]+);(?:\s*/\* (.*?) \*/)?$", re.MULTILINE)
_CONSTANT = re.compile(r"(\w+) = (-?\d+),?\s*(?:/\* (.*?) \*/)?")
_OPAQUE = re.compile(r"^typedef struct \w+ (\w+); +/\* (.*?) \*/", re.MULTILINE)
_FORMS = re.compile(r"^enum \{(.*?)\}; +/\* (.*?) \*/", re.MULTILINE)
_NUMBER = re.compile(r"^#define (SMAP_\w+)(?:\(([^)]*)\))? (\S.*)", re.MULTILINE)


@dataclass(frozen=True)
class Function:
    """A function of a header: its name, its whole declaration and what its comment says."""

    name: str
    declaration: str
    said: str


def _plain(comment: str) -> str:
    """Return a comment as a paragraph, without the stars of its lines."""
    return " ".join(line.strip().removeprefix("*").strip() for line in comment.splitlines()).strip()


def _escaped(text: str) -> str:
    """Return plain text as Markdown, with names of the program as code."""
    quoted = re.sub(r"(?<![`\w])(\w+_\w+(?:\[\d\])?)(?![`\w])", r"`\1`", text)
    pieces = re.split(r"(`[^`]*`)", quoted)
    return "".join(
        piece if piece.startswith("`") else re.sub(r"([*_<>\[\]|#])", r"\\\1", piece)
        for piece in pieces
    )


def functions(text: str) -> list[Function]:
    """Return the functions of a header in its order."""
    sections = [(match.start(), match[1]) for match in _SECTION.finditer(text)]
    found: list[Function] = []
    for match in _FUNCTION.finditer(text):
        comment = match[1] or ""
        if not comment or comment.lstrip().startswith("----"):
            # A section's line is no comment on a function, but better than none.
            whole = [one.name for one in found if f"{one.name}_i" == match[3]]
            before = [title for start, title in sections if start < match.start(3)]
            head = f"{before[-1][0].upper()}{before[-1][1:]}."
            comment = f"As {whole[0]}, in whole numbers." if whole else head
        arguments = " ".join(match[4].split())
        found.append(Function(match[3], f"{match[2]} {match[3]}({arguments})", _plain(comment)))
    return found


def _directive(kind: str, name: str, said: str, inside: str = "") -> str:
    """Return an entry of the page; what is inside has a shorter fence."""
    fence = "`````" if inside else "````"
    return f"{fence}{{c:{kind}}} {name}\n\n{_escaped(said)}\n{inside}\n{fence}"


def _records(text: str) -> list[str]:
    """Return the entries of a header's structures and enumerations."""
    found = [_directive("type", name, said) for name, said in _OPAQUE.findall(text)]
    for kind, body, name in _RECORD.findall(text):
        if name.endswith("_runtime_t"):
            continue
        if kind == "struct":
            rows = [
                _directive("member", " ".join(declared.split()), said)
                for declared, said in _MEMBER.findall(body)
            ]
        else:
            rows = [
                _directive("enumerator", one, f"{said} ({value})")
                for one, value, said in _CONSTANT.findall(body)
            ]
        found.append(_directive(kind, name, "", "\n" + "\n\n".join(rows)))
    for body, said in _FORMS.findall(text):
        found += [
            _directive("macro", one, f"{said} ({value})")
            for one, value, _ in _CONSTANT.findall(body)
        ]
    return found


def _macros(text: str) -> list[str]:
    """Return the entries of a header's numbers and macros."""
    found = []
    for name, arguments, value in _NUMBER.findall(text):
        head = f"{name}({arguments})" if arguments else name
        said = "" if arguments else f"Its value is {value.strip()}."
        before = re.search(rf"/\*((?:[^*]|\*(?!/))*)\*/\n#define {name}\b", text)
        found.append(_directive("macro", head, _plain(before[1]) if before else said))
    return found


def _manual(text: str) -> str:
    """Return the comment at a header's head, its program as a block of C."""
    comment = _COMMENT.findall(text)[1]
    lines = [re.sub(r"^ \* ?", "", line).rstrip() for line in comment.strip().splitlines()]
    found: list[str] = []
    for block in re.split(r"\n\s*\n", "\n".join(lines)):
        if block.startswith("    "):
            if found and found[-1].startswith("```"):
                found[-1] = f"{found[-1][:-4]}\n\n{textwrap.dedent(block)}\n```"
            else:
                found.append(f"```text\n{textwrap.dedent(block)}\n```")
        else:
            found.append(_escaped(" ".join(block.split())))
    return "\n\n".join(found)


def page() -> str:
    """Return the page."""
    pieces = [_HEAD]
    for path in HEADERS:
        text = path.read_text(encoding="utf-8")
        entries = [_directive("function", one.declaration, one.said) for one in functions(text)]
        pieces += [f"## {path.name}", _manual(text), "### Functions", *entries]
        pieces += ["### Types", *_records(text), "### Macros", *_macros(text)]
    return "\n\n".join(pieces) + "\n"
