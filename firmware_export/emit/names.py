"""Check the name of an export: it becomes a C identifier, a prefix and file names."""

import re

from lutgen.errors import InputError, reject

# C99 distinguishes external names by their first 31 characters only.
LONGEST = 31

# C99 to C23, then what C++ adds.
KEYWORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline
    int long register restrict return short signed sizeof static struct switch typedef union
    unsigned void volatile while alignas alignof bool constexpr false nullptr static_assert
    thread_local true typeof typeof_unqual asm fortran
    and and_eq bitand bitor catch char8_t char16_t char32_t class co_await co_return co_yield compl
    concept consteval constinit const_cast decltype delete dynamic_cast explicit export final
    friend import module mutable namespace new noexcept not not_eq operator or or_eq override
    private protected public reinterpret_cast requires static_cast template this throw try typeid
    typename using virtual wchar_t xor xor_eq
"""
# Names in any case that every C library, compilers or the headers of Arduino define.  The trial
# compilation refuses all others that the C library of this machine has.
TAKEN = """
    main errno null nan infinity eof stdin stdout stderr assert offsetof abort exit malloc free
    memcpy memmove memset memcmp printf puts read write open close link index time log gamma y0 pow
    setup loop arduino serial wire spi eeprom servo stream print high low input output pi bit byte
    word map min max abs round sq delay millis f_cpu digitalread digitalwrite
    linux unix i386 arm avr mips riscv esp32 esp8266
"""


def _fault(name: str) -> str | None:
    """Return what is wrong with a name, or None."""
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name):
        return "is no C identifier"
    if name.startswith("_"):
        return "starts with an underscore, which C reserves"
    if "__" in name:
        return "has two underscores in a row, which C++ reserves"
    if name.lower().startswith("smap"):
        return "starts with smap, which the runtime uses"
    if name in KEYWORDS.split():
        return "is a keyword of C or C++"
    if name.lower() in TAKEN.split():
        return "is taken by C libraries, compilers or Arduino"
    if re.search(r"_t$|_pose(_i)?$|_state$|_control$", name.lower()):
        return "ends like a type of C or a part of the export"
    if len(name) > LONGEST:
        return f"has more than {LONGEST} characters"
    return None


def check_name(name: str) -> str:
    """Return a name that an export may have; refuse any other."""
    fault = _fault(name)
    if fault is not None:
        way_out = f"give another, such as --name {default_name(name)}"
        reject("export name", f"{name!r} {fault}", repr(name), way_out, InputError)
    return name


def default_name(text: str) -> str:
    """Return an allowed name that resembles a text, such as a robot's name.

    Examples
    --------
    >>> default_name("3-leg robot"), default_name("int"), default_name("paper_two")
    ('map_3_leg_robot', 'int_map', 'paper_two')
    """
    name = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9]", "_", text)).strip("_")
    if not name or name[0].isdigit() or name.lower().startswith("smap"):
        name = f"map_{name}".rstrip("_")
    name = name[:LONGEST].rstrip("_")
    return name if _fault(name) is None else f"{name[: LONGEST - 4]}_map"


def macro(text: str) -> str:
    """Return the upper-case form of a name that macros have: letters, digits, underscores."""
    return re.sub(r"[^A-Z0-9]", "_", text.upper())
