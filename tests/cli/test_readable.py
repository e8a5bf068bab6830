"""Messages quote what was received: a terminal must not obey it, nor anyone have to scroll."""

import pytest

from lutgen.errors import readable
from tests.fixtures.commands import run


def test_a_message_without_anything_odd_stays_as_it_is() -> None:
    plain = "r.toml: robot.größe is unknown (got 3);\n\tdid you mean 'name'"
    assert readable(plain) == plain


@pytest.mark.parametrize(
    ("received", "shown"),
    [("\x1b[31m", "\\x1b[31m"), ("\x00", "\\x00"), ("\u202e", "\\u202e"), ("\x9b", "\\x9b")],
)
def test_what_a_terminal_would_obey_is_shown_as_an_escape(received: str, shown: str) -> None:
    assert readable(f"a{received}b") == f"a{shown}b"


def test_a_long_message_keeps_its_beginning_and_its_way_out() -> None:
    shown = readable(f"r.toml: robot.name is wrong (got '{'a' * 10_000}'); write a name")
    assert len(shown) < 2100
    assert shown.startswith("r.toml: robot.name is wrong")
    assert shown.endswith("'); write a name")


@pytest.mark.parametrize("words", [("check", "no\x1b[31m.toml"), ("check", "--no\x1b[31m")])
def test_the_command_line_shows_escapes_of_files_and_of_its_own_words(words: tuple[str]) -> None:
    result = run(*words)
    assert result.exit_code == 2
    assert "\x1b" not in result.stderr
    assert "x1b" in result.stderr
