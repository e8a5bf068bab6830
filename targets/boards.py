"""The four emulated targets: compilers, flags, emulators and how their counters count."""

import shutil
from dataclasses import dataclass, field

STRICT = ("-std=c99", "-ffp-contract=off")
# avr-gcc knows address spaces in GNU C only; it never fuses a multiplication and an addition.
GNU = ("-std=gnu99", "-ffp-contract=off")
QEMU_ARM = (
    "-nographic -monitor none -serial none -chardev stdio,id=s "
    "-semihosting-config enable=on,target=native,chardev=s "
    "-icount shift=10,sleep=off,align=off -kernel"
)
ARM_PACKAGES = {
    "arm-none-eabi-gcc": "gcc-arm-none-eabi picolibc-arm-none-eabi",
    "qemu-system-arm": "qemu-system-arm",
}


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
    packages : dict
        Program to the Debian packages that bring it.
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
    packages: dict[str, str] = field(hash=False)
    options: tuple[str, ...] = ("-O2",)
    unit: str = "instructions"
    ticks: float = 1.0
    flash: int = 1 << 22
    ram: int = 1 << 22
    order: str = "<"
    sparse: int = 1

    def missing(self) -> list[str]:
        """Return the Debian packages of the programs that are not installed."""
        found = [pack for tool, pack in self.packages.items() if shutil.which(tool) is None]
        return sorted(" ".join(found).split())


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
        ARM_PACKAGES,
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
        ARM_PACKAGES,
        ticks=16.384,
        flash=256 << 10,
        ram=16 << 10,
    ),
    Board(
        *("avr", "ATmega2560", "avr-gcc", ("-mmcu=atmega2560", *GNU), ("-Wl,--gc-sections",)),
        ("simavr", "-m", "atmega2560", "-f", "16000000"),
        {"avr-gcc": "gcc-avr avr-libc", "simavr": "simavr"},
        options=("-Os",),
        unit="cycles",
        flash=256 << 10,
        ram=8 << 10,
        sparse=4,
    ),
    Board(
        *("ppc", "PowerPC, big-endian", "powerpc-linux-gnu-gcc", STRICT, ("-static",)),
        ("qemu-ppc",),
        {
            "powerpc-linux-gnu-gcc": "gcc-powerpc-linux-gnu libc6-dev-powerpc-cross",
            "qemu-ppc": "qemu-user",
        },
        unit="",
        order=">",
    ),
)
