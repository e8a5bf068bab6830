"""Fonts: letters for names in any script, as far as this machine has them."""

import logging
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from matplotlib import font_manager

log = logging.getLogger("lutgen")

# DejaVu comes with matplotlib; the others are asked for letters that it lacks, if installed.
KNOWN = (
    *("DejaVu Sans", "Noto Sans CJK SC", "Noto Sans CJK JP", "Noto Sans CJK KR", "Noto Sans SC"),
    *("Noto Sans JP", "Source Han Sans SC", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei"),
    *("IPAGothic", "Unifont", "Droid Sans Fallback", "PingFang SC", "Hiragino Sans"),
    *("Apple SD Gothic Neo", "Microsoft YaHei", "Yu Gothic", "Malgun Gothic", "Arial Unicode MS"),
    *("Noto Sans Devanagari", "Noto Sans Thai", "Noto Sans Bengali", "Noto Sans Tamil"),
)
_MISSING = re.compile(r"Glyph (\d+) .* missing from")


@cache
def families() -> tuple[str, ...]:
    """Return the fonts to take letters from, the first that has one."""
    installed = {font.name for font in font_manager.fontManager.ttflist}
    return tuple(name for name in KNOWN if name in installed)


@contextmanager
def said_once() -> Iterator[None]:
    """Say in one sentence which letters no font has, whatever is drawn within a with block."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    missing = set()
    for warning in caught:
        if found := _MISSING.search(str(warning.message)):
            missing.add(chr(int(found[1])))
        else:
            place = (warning.filename, warning.lineno)
            warnings.warn_explicit(warning.message, warning.category, *place)
    if missing:
        letters = "".join(sorted(missing))
        log.warning(
            "no font here has the letters %s, which are drawn as boxes; install one that has, such "
            "as Noto Sans CJK",
            letters if len(letters) < 20 else f"{letters[:20]}...",
        )
