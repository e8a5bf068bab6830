"""smap_config.h: which features of the runtime an export needs, and how large.

The list of switches and the comment of each come from the runtime's own files: those of the codecs
stand with their structs in smap.h, the others in smap_config.h.  So a new switch needs no line here
unless every map has a say in it.
"""

import re
from functools import cache
from importlib.resources import files

from firmware_export.codecs import codec as info
from firmware_export.emit.text import LICENCE
from firmware_export.protocol import CBody, Export
from lutgen.errors import ExportError

# (name, the runtime's own value, comment)
Entry = tuple[str, str, str]
_ENTRY = re.compile(r"#ifndef (\w+)\n#define \1(?: (\S+))? /\* (.*?) \*/\n#endif\n", re.DOTALL)
# What an application may set by itself: it depends on the target, not on the map.
_TARGET = ("SMAP_SHARED", "SMAP_HARDWARE_ROOT", "SMAP_FLASH")
# avr-gcc makes no object of more than 32767 bytes; elsewhere one object is read faster.
_CHUNKS = """\
#ifndef SMAP_GRID_CHUNKS
#ifdef __AVR__
#define SMAP_GRID_CHUNKS 1 /* {comment} */
#else
#define SMAP_GRID_CHUNKS 0
#endif
#endif"""
# Built for one map the runtime is faster, and larger where the compiler unrolls; with -Os (gcc and
# clang then define the macro) the size counts.  The preprocessor cannot compare names: the last
# macro is the one that NAME.c looks for.
_SHARED = """\
#ifndef SMAP_SHARED
#if defined(__AVR__) || defined(__OPTIMIZE_SIZE__)
#define SMAP_SHARED 1 /* {comment} */
#else
#define SMAP_SHARED 0
#endif
#endif
#if !SMAP_SHARED
#define SMAP_ONLY {export}
#define SMAP_ONLY_FILE "{export}.c"
#define SMAP_BUILT_FOR_{export}
#endif"""
# avr-gcc reads constants from flash only where they have an address space of their own, which needs
# C with GNU extensions; else they are copied to RAM.  Other targets have them in flash anyway.
_FLASH = """\
#ifndef SMAP_FLASH
#if defined(__AVR__) && defined(__FLASH) && !defined(__STRICT_ANSI__)
#define SMAP_FLASH __flash /* type qualifier of tables; needs -std=gnu99 or later */
#define SMAP_PLACE __attribute__((__progmem__)) /* attribute of descriptors */
#ifdef __FLASH1 /* more than 64 KiB of flash */
#define SMAP_FAR __memx /* type qualifier of what may lie anywhere in it: chunks */
#endif
#else
#define SMAP_FLASH
#endif
#elif defined(__AVR__) && !defined(SMAP_PLACE)
#error "SMAP_FLASH and SMAP_PLACE say the same of two things: set both, or neither"
#endif
#ifndef SMAP_PLACE
#define SMAP_PLACE
#endif"""


@cache
def runtime_file(name: str) -> str:
    """Return the text of a file of the runtime."""
    folder = files("firmware_export") / "runtime"
    try:
        return (folder / name).read_text(encoding="utf-8")
    except OSError as error:
        raise ExportError(
            f"{name}: this file of the runtime cannot be read (got {error.strerror}); "
            "install lutgen again."
        ) from error


@cache
def runtime_version() -> int:
    """Return SMAP_VERSION of the runtime."""
    found = re.search(r"#define SMAP_VERSION (\d+)", runtime_file("smap.h"))
    if found is None:
        raise ExportError("smap.h: SMAP_VERSION is missing (got nothing); install lutgen again.")
    return int(found[1])


@cache
def entries() -> tuple[Entry, ...]:
    """Return every setting of the runtime: those of the codecs, then those of all."""
    found = _ENTRY.findall(runtime_file("smap.h") + runtime_file("smap_config.h"))
    return tuple((name, value, " ".join(comment.split())) for name, value, comment in found)


def settings(export: Export, body: CBody) -> dict[str, int]:
    """Return the settings that a map needs, by name, in the order of `entries`.

    The `config` of its tables adds to and overrides what the codec needs.
    """
    codec, model = export.codec, export.model
    given = {
        info(codec).switches[export.arithmetic]: 1,
        "SMAP_MAX_PARAMS": max(model.k, 1),
        "SMAP_SPHERE": int(model.faces == 6),
        **dict(body.config),
    }
    known = {name for name, _, _ in entries()}
    for name in given:
        if name not in known:
            raise ExportError(
                f"codec {codec}: the runtime has no setting {name} (got {given[name]}); "
                "correct the codec's c_body or smap_config.h."
            )
    result = {}
    for name, value, comment in entries():
        if name in _TARGET:
            continue
        if name in given:
            result[name] = given[name]
        elif value in ("0", "1"):
            result[name] = 0
        elif f"codec `{codec}`" in comment or "codec `" not in comment:
            result[name] = int(value)
    return result


def features(export: Export, body: CBody) -> frozenset[str]:
    """Return the switches that a map has on: what its code size depends on.

    A switch that is no mere on and off comes with its value, such as ``SMAP_MODES=8``.
    """
    switches = {name for name, value, _ in entries() if value in ("0", "1")}
    return frozenset(
        name if value == 1 else f"{name}={value}"
        for name, value in settings(export, body).items()
        if value and name in switches
    )


def config_text(export: Export, body: CBody) -> str:
    """Return smap_config.h of an export."""
    needed = settings(export, body)
    comments = {name: comment for name, _, comment in entries()}
    lines = [
        f"/* smap_config.h of {export.name}, generated by lutgen: what the runtime is built with.",
        " * A firmware with several maps takes for each line what serves all of them, first of all",
        " * SMAP_SHARED 1. */",
        "#ifndef SMAP_CONFIG_H",
        "#define SMAP_CONFIG_H",
        "",
        _SHARED.format(comment=comments["SMAP_SHARED"], export=export.name),
    ]
    for name, value, comment in entries():
        if name == "SMAP_GRID_CHUNKS" and body.chunked:
            lines.append(_CHUNKS.format(comment=comment))
        elif name in needed or name == "SMAP_HARDWARE_ROOT":
            setting = str(needed.get(name, value))
            lines += [f"#ifndef {name}", f"#define {name} {setting} /* {comment} */", "#endif"]
    return LICENCE + "\n".join([*lines, _FLASH, "", "#endif", ""])
