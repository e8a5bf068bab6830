"""The columns of the matrix: compilers, flags, emulators and how their counters count."""

import shutil
from dataclasses import dataclass, field

OPTIMISATIONS = ("-O2", "-Os")
FAST = ("-O2",)
STRICT = ("-std=c99", "-ffp-contract=off")
# avr-gcc knows address spaces in GNU C only; it never fuses a multiplication and an addition.
GNU = ("-std=gnu99", "-ffp-contract=off")
ARM_PACKAGES = {
    "arm-none-eabi-gcc": "gcc-arm-none-eabi picolibc-arm-none-eabi",
    "qemu-system-arm": "qemu-system-arm",
}
RISCV_PACKAGES = {
    "riscv64-unknown-elf-gcc": "gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf",
    "qemu-system-riscv32": "qemu-system-misc",
}
AVR_PACKAGES = {"avr-gcc": "gcc-avr avr-libc", "simavr": "simavr"}
WASM_PACKAGES = {"clang": "clang", "wasm-ld": "lld", "node": "nodejs"}


@dataclass(frozen=True)
class Board:
    """One column.

    Parameters
    ----------
    name : str
        Short, for ``--only`` and the baseline.
    title : str
        For people.
    prefix : str
        Of the compiler's tools.
    flags : tuple of str
        For the compiler, also when it links.
    link : tuple of str
        For linking.
    emulator : tuple of str
        Command; the image's name follows it.
    packages : dict
        Program to the Debian packages that bring it.
    ticks : float
        Ticks of the counter for one unit of `unit`.
    flash, ram : int
        Bytes; an image beyond them does not fit.
    unit : str
        What is counted; empty where nothing is.
    options : tuple of str
        Optimisations: of boards that differ in little from another, one.
    """

    name: str
    title: str
    prefix: str
    flags: tuple[str, ...]
    link: tuple[str, ...]
    emulator: tuple[str, ...]
    packages: dict[str, str] = field(hash=False)
    ticks: float = 1.0
    flash: int = 1 << 22
    ram: int = 1 << 22
    unit: str = "instructions"
    options: tuple[str, ...] = OPTIMISATIONS

    @property
    def family(self) -> str:
        """`arm`, `riscv`, `avr` or `wasm`."""
        return {"arm-none-eabi-": "arm", "avr-": "avr", "": "wasm"}.get(self.prefix, "riscv")

    def missing(self) -> list[str]:
        """Return the Debian packages of the programs that are not installed."""
        found = [pack for tool, pack in self.packages.items() if shutil.which(tool) is None]
        return sorted(" ".join(found).split())


def _picolibc(flash: int, flash_size: int, ram: int, ram_size: int) -> tuple[str, ...]:
    places = (("flash", flash), ("flash_size", flash_size), ("ram", ram), ("ram_size", ram_size))
    return (
        *("--oslib=semihost", "--crt0=hosted", "-Wl,--gc-sections"),
        *(f"-Wl,--defsym=__{name}={value:#x}" for name, value in places),
    )


def _arm(
    name: str,
    title: str,
    machine: str,
    cpu: str,
    ticks: float,
    memory: tuple[int, int, int, int] = (0, 1 << 22, 0x20000000, 1 << 22),
    options: tuple[str, ...] = OPTIMISATIONS,
) -> Board:
    flags = (*f"-mthumb {cpu} --specs=picolibc.specs".split(), *STRICT)
    emulator = (
        f"qemu-system-arm -M {machine} -nographic -monitor none -serial none -chardev stdio,id=s "
        "-semihosting-config enable=on,target=native,chardev=s "
        "-icount shift=10,sleep=off,align=off -kernel"
    )
    return Board(
        *(name, title, "arm-none-eabi-", flags, _picolibc(*memory), tuple(emulator.split())),
        *(ARM_PACKAGES, ticks, memory[1], memory[3]),
        options=options,
    )


def _riscv(name: str, title: str, cpu: str, options: tuple[str, ...] = OPTIMISATIONS) -> Board:
    flags = (*f"{cpu} -mcmodel=medany --specs=picolibc.specs".split(), *STRICT)
    emulator = (
        "qemu-system-riscv32 -M virt -bios none -nographic -monitor none -serial none "
        "-chardev stdio,id=s -semihosting-config enable=on,target=native,chardev=s "
        "-icount shift=0,sleep=off -kernel"
    )
    link = _picolibc(0x80000000, 0x400000, 0x80400000, 0x400000)
    prefix = "riscv64-unknown-elf-"
    board = (name, title, prefix, flags, link, tuple(emulator.split()), RISCV_PACKAGES)
    return Board(*board, options=options)


def _avr(
    name: str,
    title: str,
    mcu: str,
    memory: tuple[int, int],
    options: tuple[str, ...] = OPTIMISATIONS,
) -> Board:
    emulator = ("simavr", "-m", mcu, "-f", "16000000")
    flags = (f"-mmcu={mcu}", *GNU)
    board = (name, title, "avr-", flags, ("-Wl,--gc-sections",), emulator, AVR_PACKAGES)
    flash, ram = memory
    return Board(*board, flash=flash, ram=ram, unit="cycles", options=options)


BOARDS = (
    _arm(
        *("m0", "Cortex-M0", "microbit", "-mcpu=cortex-m0 -mfloat-abi=soft", 16.384),
        (0, 256 << 10, 0x20000000, 16 << 10),
    ),
    _arm(
        *("m3", "Cortex-M3", "mps2-an385", "-mcpu=cortex-m3 -mfloat-abi=soft", 25.6),
        options=FAST,
    ),
    _arm(
        *("m4f", "Cortex-M4F", "mps2-an386"),
        *("-mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16", 25.6),
    ),
    _arm(
        *("m7f", "Cortex-M7F", "mps2-an500"),
        *("-mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16", 25.6),
        options=FAST,
    ),
    _arm(
        *("m33", "Cortex-M33", "mps2-an505"),
        *("-mcpu=cortex-m33 -mfloat-abi=hard -mfpu=fpv5-sp-d16", 20.48),
        (0x10000000, 1 << 22, 0x38000000, 1 << 22),
        options=FAST,
    ),
    _riscv("rv32imc", "RV32IMC", "-march=rv32imc -mabi=ilp32"),
    _riscv("rv32imafc", "RV32IMAFC", "-march=rv32imafc -mabi=ilp32f", FAST),
    _avr("mega328p", "ATmega328P", "atmega328p", (32 << 10, 2 << 10)),
    _avr("mega2560", "ATmega2560", "atmega2560", (256 << 10, 8 << 10), FAST),
    Board(
        *("wasm", "WebAssembly", ""),
        ("--target=wasm32", "-mcpu=mvp", "-ffreestanding", *STRICT),
        (
            *("-nostdlib", "-Wl,--no-entry", "-Wl,--export=run"),
            *(f"-Wl,--export={name}" for name in ("queries", "text", "length")),
        ),
        ("node", "run.mjs"),
        WASM_PACKAGES,
        unit="",
    ),
)


def board(name: str) -> Board:
    """Return a column by name."""
    return {one.name: one for one in BOARDS}[name]
