"""The four emulated targets: compilers, flags, emulators and how their counters count."""

from dataclasses import dataclass

STRICT = ("-std=c99", "-ffp-contract=off")
# avr-gcc knows address spaces in GNU C only; it never fuses a multiplication and an addition.
GNU = ("-std=gnu99", "-ffp-contract=off")
QEMU_ARM = (
    "-nographic -monitor none -serial none -chardev stdio,id=s "
    "-semihosting-config enable=on,target=native,chardev=s "
    "-icount shift=10,sleep=off,align=off -kernel"
)


@dataclass(frozen=True)
class Board:
    """An emulated target.

    Parameters
    ----------
    name, title : str
        For ``--only`` and the baseline; for people.
    tool : str
        The C compiler.
    flags, link : tuple of str
        Of the compiler, also when it links; of the linker.
    emulator : tuple of str
        Command; the image's name follows it.
    options : tuple of str
        Levels of optimisation.
    unit : str
        What is counted; empty where nothing is.
    ticks : float
        Ticks of the counter for one unit.
    flash, ram : int
        Bytes.
    order : str
        Byte order, as NumPy writes it.
    sparse : int
        One query in so many is asked, of the hash and of the counts.
    """

    name: str
    title: str
    tool: str
    flags: tuple[str, ...]
    link: tuple[str, ...]
    emulator: tuple[str, ...]
    options: tuple[str, ...] = ("-O2",)
    unit: str = "instructions"
    ticks: float = 1.0
    flash: int = 1 << 22
    ram: int = 1 << 22
    order: str = "<"
    sparse: int = 1

    @property
    def programs(self) -> tuple[str, str]:
        """What has to be installed."""
        return self.tool, self.emulator[0]


def _arm(flash: int, ram: int) -> tuple[str, ...]:
    """Return what links an image for an ARM: the C library's start, and the part's memory."""
    places = {"flash": 0, "flash_size": flash, "ram": 0x20000000, "ram_size": ram}
    defined = (f"-Wl,--defsym=__{name}={value:#x}" for name, value in places.items())
    return ("--oslib=semihost", "--crt0=hosted", "-Wl,--gc-sections", *defined)


BOARDS = (
    Board(
        *("m4f", "Cortex-M4F", "arm-none-eabi-gcc"),
        (
            *["-mthumb", "-mcpu=cortex-m4", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"],
            *("--specs=picolibc.specs", *STRICT),
        ),
        _arm(1 << 22, 1 << 22),
        tuple(f"qemu-system-arm -M mps2-an386 {QEMU_ARM}".split()),
        options=("-O2", "-Os"),
        ticks=25.6,
    ),
    Board(
        *("m0", "Cortex-M0+", "arm-none-eabi-gcc"),
        (
            *["-mthumb", "-mcpu=cortex-m0plus", "-mfloat-abi=soft", "--specs=picolibc.specs"],
            *STRICT,
        ),
        _arm(256 << 10, 16 << 10),
        tuple(f"qemu-system-arm -M microbit {QEMU_ARM}".split()),
        ticks=16.384,
        flash=256 << 10,
        ram=16 << 10,
    ),
    Board(
        *("avr", "ATmega2560", "avr-gcc", ("-mmcu=atmega2560", *GNU), ("-Wl,--gc-sections",)),
        ("simavr", "-m", "atmega2560", "-f", "16000000"),
        options=("-Os",),
        unit="cycles",
        flash=256 << 10,
        ram=8 << 10,
        sparse=4,
    ),
    Board(
        *("ppc", "PowerPC, big-endian", "powerpc-linux-gnu-gcc", STRICT, ("-static",)),
        ("qemu-ppc",),
        unit="",
        order=">",
    ),
)
