"""The reference of the command line.  Owns how a click command becomes a section of a page.

The help texts are plain text with back-quotes and lines that begin with ``$``, and no
reStructuredText, so that no general extension can take them as they are.
"""

import re
from collections.abc import Iterator

import click

from lutgen.cli import main

__all__ = ["commands", "options", "page"]

_HEAD = """# Every command and option

Made from the sources by `make docs`; `lutgen COMMAND --help` prints the same. How commands behave
together, their exit codes and their completion in shells are in
[the command line](../guide/commands.md).
"""


def commands() -> dict[str, click.Context]:
    """Return the context of every command by its full name, that of the program itself first."""
    program = click.Context(main, info_name="lutgen", **main.context_settings)
    found = {"lutgen": program}
    for name in main.list_commands(program):
        command = main.get_command(program, name)
        assert command is not None
        found[f"lutgen {name}"] = click.Context(command, program, name)
    return found


def options(context: click.Context) -> list[click.Option]:
    """Return the options of a command that its help shows."""
    params = context.command.get_params(context)
    return [one for one in params if isinstance(one, click.Option) and not one.hidden]


def _escaped(text: str) -> str:
    """Return plain text as Markdown, with what stands between back-quotes left alone."""
    pieces = re.split(r"(`[^`]*`)", text)
    return "".join(
        piece if piece.startswith("`") else re.sub(r"([*_<>\[\]|#])", r"\\\1", piece)
        for piece in pieces
    )


def _paragraphs(help_text: str) -> Iterator[str]:
    """Yield the paragraphs of a help text; examples become blocks of text."""
    for one in re.split(r"\n\s*\n", help_text.strip()):
        lines = [line.strip() for line in one.splitlines()]
        lines = lines[1:] if lines[0] == "\b" else lines
        if lines[0].startswith(("$", "lutgen ")):
            yield "\n".join(["```text", *lines, "```"])
        else:
            yield _escaped(" ".join(lines))


def _entry(option: click.Option, context: click.Context) -> str:
    """Return the entry of an option."""
    metavar = "" if option.is_flag or option.count else f" {option.make_metavar(context)}"
    heads = ", ".join(f"{name}{metavar}" for name in (*option.opts, *option.secondary_opts))
    record = option.get_help_record(context)
    return f"````{{option}} {heads}\n\n{_escaped(record[1] if record else '')}\n````"


def _section(name: str, context: click.Context) -> str:
    """Return the section of one command."""
    usage = " ".join([name, *context.command.collect_usage_pieces(context)])
    return "\n\n".join(
        [
            f"## {name}",
            f"```{{program}} {name}\n```",
            f"```text\n{usage}\n```",
            *_paragraphs(context.command.help or ""),
            *(_entry(option, context) for option in options(context)),
        ]
    )


def page() -> str:
    """Return the page."""
    return "\n\n".join([_HEAD, *(_section(*one) for one in commands().items())]) + "\n"
