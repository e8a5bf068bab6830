"""Which names an export may have: it becomes a C identifier, a prefix and file names."""

import re
from pathlib import Path

from lutgen.errors import InputError

# C99 distinguishes external names by their first 31 characters only.
LONGEST = 31

# C99 to C23, then what C++ adds.
_KEYWORDS = """
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
# Names that the C library, compilers, the runtime or Arduino's headers have taken, in any case.
_TAKEN = """
    main errno null nan infinity eof stdin stdout stderr assert offsetof setup loop smap int8_t
    uint8_t int16_t uint16_t int32_t uint32_t int64_t uint64_t size_t ptrdiff_t intptr_t uintptr_t
    intmax_t uintmax_t int_fast8_t int_fast16_t int_fast32_t int_least8_t linux unix i386 arm arm64
    avr mips sparc vax sun m68k hpux pic riscv xtensa esp32 esp8266 arduino f_cpu serial high low
    input output byte word boolean delay millis micros pi abort abs acos acosh alloca alphasort asin
    asinh atan atan2 atanh atexit atof atoi atol atoll bcmp bcopy bsearch bzero cabs cacos calloc
    carg casin catan cbrt ccos ceil cexp cimag clearerr clock clog conj copysign cos cosh cpow cproj
    creal csin csqrt ctan ctime difftime div drem erf erfc exit exp exp10 exp2 expm1 fabs fclose
    fdim feof ferror fflush ffs fgetc fgets fgetpos finite floor fma fmax fmin fmod fopen fork
    fpclassify fprintf fputc fputs fread free freopen frexp fscanf fseek fsetpos ftell fwrite gamma
    getc getchar getenv gets gettext gmtime huge_val hypot ilogb index imaxabs imaxdiv isalnum
    isalpha isascii isblank iscntrl isdigit isfinite isgraph isgreater isinf isless islower isnan
    isnormal isprint ispunct isspace isunordered isupper iswalnum isxdigit j0 j1 jn labs ldexp ldiv
    lgamma llabs lldiv llrint llround localeconv localtime log log10 log1p log2 logb longjmp lrint
    lround malloc mblen mbstowcs mbtowc memccpy memchr memcmp memcpy memmove mempcpy memset mktime
    modf nanf nearbyint nextafter nexttoward perror pow pow10 printf putc putchar puts qsort raise
    rand realloc remainder remove remquo rename rewind rindex rint round scalb scalbln scalbn scanf
    setbuf setjmp setlocale setvbuf signal signbit significand sin sincos sinh snprintf sprintf sqrt
    srand sscanf stpcpy strcat strchr strcmp strcoll strcpy strcspn strdup strerror strftime strlen
    strncat strncmp strncpy strpbrk strrchr strspn strstr strtod strtof strtok strtol strtold
    strtoll strtoul strxfrm system tan tanh tgamma time tmpfile tmpnam toascii tolower toupper
    towlower trunc ungetc va_arg va_end va_list va_start vfprintf vprintf vsnprintf vsprintf wchar_t
    wint_t y0 y1 yn bool true false complex imaginary i noreturn
    pinmode digitalwrite digitalread analogread analogreference analogwrite analogreadresolution
    analogwriteresolution notone tone yield pulsein pulseinlong shiftout shiftin attachinterrupt
    detachinterrupt randomseed map makeword bit lowbyte highbyte bitread bitset bitclear bitwrite
    bittoggle interrupts nointerrupts min max constrain radians degrees sq led_builtin sda scl ss
    mosi miso sck wire spi eeprom servo stream print string progmem serial1 serial2 serial3 keyboard
    mouse
"""
KEYWORDS = frozenset(re.findall(r"\w+", _KEYWORDS))
TAKEN = frozenset(re.findall(r"\w+", _TAKEN))
# What else the C libraries of Linux (glibc), of picolibc and of AVR define, POSIX and their own: a
# map of such a name would take a function's place, and be called where a library asks for that.
LIBRARIES = frozenset((Path(__file__).parent / "libc_names.txt").read_text("utf-8").split())
# What libraries append to a function for other kinds of numbers.
_KIND = re.compile(r"(f128|f32x?|f64x?|64)$")


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
    if name in KEYWORDS:
        return "is a keyword of C or C++"
    # The C library has its functions for single and for long numbers, too.
    if name.lower() in TAKEN or (name[-1] in "fl" and name[:-1] in TAKEN and len(name) > 3):
        return "is taken by the C library or by a file of the export"
    if name in LIBRARIES or _KIND.sub("", name) in LIBRARIES | TAKEN:
        return "is taken by the C library of some target"
    if re.search(r"_(pose(_i)?|state)(_t)?$|_control$", name.lower()):
        return "ends like the types of a pose or the parts of control"
    if len(name) > LONGEST:
        return f"has more than {LONGEST} characters"
    return None


def check_name(name: str) -> str:
    """Return a name that an export may have; refuse any other.

    Examples
    --------
    >>> check_name("paper_two")
    'paper_two'
    """
    fault = _fault(name)
    if fault is not None:
        raise InputError(
            f"export name: {name!r} {fault} (got {name!r}); give another, such as "
            f"--name {default_name(name)}."
        )
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
