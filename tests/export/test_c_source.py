"""The emitted C: what it says, how it looks, and that compilers take it."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_export.emit import family_row, package
from firmware_export.emit.facts import axis_macros, report
from firmware_export.emit.names import LONGEST, check_name, default_name
from firmware_export.emit.render import WIDTH, block_comment, plain_text, texts
from firmware_export.emit.runtime import control_file, control_text, runtime_file, runtime_text
from firmware_export.host import RUNTIME, family_of
from firmware_export.protocol import CArray, Export, literal
from lutgen.errors import InputError
from lutgen.recipe.recipe import parse_recipe
from targets import size
from tests.fixtures.compiled import STRICT, compile_c, run
from tests.fixtures.exports import coded_export, rover_export, tripod_export
from tests.fixtures.recipes import tripod

C99 = ["-std=c99", "-ffp-contract=off"]
CXX = ["-x", "c++", "-std=c++17", "-ffp-contract=off"]
BUILDS = [
    pytest.param(
        compiler, language, marks=pytest.mark.needs(compiler, *["g++"] * ("c++" in language))
    )
    for compiler in ("gcc", "clang")
    for language in (C99, CXX)
]
# The text of a family between its marks.
RUNTIME_TEXT = re.compile(r"/\* ==== the runtime .*?/\* ==== end of the runtime .*? ==== \*/", re.S)
KINDS = ("contacts", "rover", "grid", "integer")


@pytest.fixture(scope="module")
def exports():
    return {
        "contacts": tripod_export("feet"),
        "rover": rover_export(),
        "grid": tripod_export("table", codec="grid"),
        "integer": tripod_export("whole", codec="grid", arithmetic="integer"),
    }


@pytest.fixture(scope="module")
def folders(exports, tmp_path_factory):
    place = tmp_path_factory.mktemp("exports")
    for name, export in exports.items():
        package.write(export, place / name)
    return {name: place / name for name in exports}


def build(folder, *flags, compiler="cc", sources=()):
    names = sources or tuple(sorted(path.name for path in folder.glob("*.c")))
    command = [compiler, *flags, "-fsyntax-only", *names]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(("compiler", "language"), BUILDS)
def test_every_compiler_takes_every_file_and_every_family_without_a_warning(
    folders, compiler, language, tmp_path
):
    for kind in KINDS:
        done = build(folders[kind], *language, *STRICT, compiler=compiler)
        assert (done.returncode, done.stderr) == (0, ""), kind
    for family in size.FAMILIES if compiler == "gcc" else ():
        for control in {False, bool(control_file(family))}:
            (tmp_path / "all.c").write_text(size.program(family, control), encoding="utf-8")
            done = build(tmp_path, *language, *STRICT, f"-I{RUNTIME}", compiler=compiler)
            assert done.returncode == 0, done.stderr


def test_a_machine_or_a_header_that_the_c_is_not_for_is_refused(folders, tmp_path):
    shutil.copytree(folders["contacts"], tmp_path / "copy")
    header = tmp_path / "copy" / "smap.h"
    other = re.sub(r"#define SMAP_VERSION \d+", "#define SMAP_VERSION 999", header.read_text())
    # A header that says what that of a machine with bytes of 16 bits would.
    limits = tmp_path / "copy" / "limits.h"
    limits.write_text("#include_next <limits.h>\n#undef CHAR_BIT\n#define CHAR_BIT 16\n")
    assert "need bytes of 8 bits" in build(limits.parent, "-I.", *C99, sources=("feet.c",)).stderr
    limits.unlink()
    header.write_text(other)
    done = build(header.parent, *C99, sources=("feet.c",))
    assert re.search(r'#error "feet needs smap.h of version \d+', done.stderr)


@pytest.mark.needs("avr-gcc")
@pytest.mark.parametrize("kind", KINDS)
def test_on_avr_everything_is_read_from_flash(folders, tmp_path, kind):
    shutil.copytree(folders[kind], tmp_path / "copy")
    name = next((tmp_path / "copy").glob("*_report.json")).name.removesuffix("_report.json")
    flags = ["-mmcu=atmega328p", "-Os", "-Wall", "-Wextra", "-Wno-unused-variable"]
    sizes = {}
    for standard in ("gnu99", "c99"):
        command = ["avr-gcc", f"-std={standard}", *flags, "-c", f"{name}.c", "-o", "map.o"]
        run(tmp_path / "copy", *command)
        text = run(tmp_path / "copy", "avr-size", "-A", "map.o")
        found = re.findall(r"^\.(data|bss|rodata|progmem)\S*\s+(\d+)", text, re.MULTILINE)
        sizes[standard] = {section: int(size) for section, size in found if int(size)}
    # The addresses of the functions, and the map's own; the blob is in flash.
    assert sizes["gnu99"].pop("progmem") > 100
    assert sum(sizes["gnu99"].values()) <= 48
    # Without address spaces avr-gcc has no way but RAM.
    assert "progmem" not in sizes["c99"]


def test_generated_text_is_ascii_without_long_lines_tabs_or_trailing_blanks(folders):
    for folder in folders.values():
        for path in [*folder.glob("*.[ch]"), folder / "CMakeLists.txt"]:
            text = RUNTIME_TEXT.sub("", path.read_bytes().decode("ascii"))
            if path.name == "smap.h":
                continue
            assert text.endswith("\n")
            assert not text.endswith("\n\n")
            for line in text.split("\n"):
                assert len(line) <= WIDTH, f"{path.name}: {line}"
                assert line == line.rstrip(), f"{path.name}: {line!r}"
                assert "\t" not in line


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_a_float_reads_back_as_the_same_single(value):
    text = literal(value)
    assert re.fullmatch(r"-?\d+\.?\d*(e[-+]\d+)?f", text)
    assert "." in text or "e" in text
    assert np.float32(text[:-1]).tobytes() == np.float32(value).tobytes()


@given(st.text(max_size=60))
def test_no_text_can_end_a_comment_or_continue_a_line(text):
    shown = plain_text(text)
    assert shown.isascii()
    assert not set(re.findall(r"\*/|/\*|\\|\?\?", shown))
    assert block_comment(text).count("*/") == 1


def test_a_robot_with_an_unusual_name_gives_c_that_compiles(tmp_path):
    export = tripod_export("odd")
    robot = replace(export.recipe, name='a */ int x;\n /* 5° \\ "quoted" ??/')
    package.write(replace(export, recipe=robot), tmp_path / "odd")
    done = build(tmp_path / "odd", *C99, *STRICT)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_integer_form_of_a_constant_is_rounded_and_clamped(tmp_path, monkeypatch):
    export = tripod_export("feet", codec="grid", arithmetic="integer")
    steps = (("sdg", 0.001), ("height", 0.0005))
    monkeypatch.setattr(Export, "body", replace(export.body, lengths=steps))
    export = replace(export, channels=("sdg", "tip_angle", "height"))
    text = dict(texts(export, report(export)))["feet.h"]
    (tmp_path / "smap.h").write_text(runtime_file("smap.h"))
    (tmp_path / "feet.h").write_text(text)
    low, high = export.recipe.parameters[1].minimum, export.recipe.parameters[1].maximum
    values = [low - 1.0, low - 1e-5, low, 0.0, 0.123, 0.7, high, high + 1.0]
    # Just below the upper end: no rounding may carry it beyond 32767.
    values += [float(np.nextafter(np.float32(high), np.float32(0.0)))]
    items = ", ".join(f"FEET_SWING_Q({literal(value)})" for value in values)
    (tmp_path / "main.c").write_text(
        '#include <stdio.h>\n#include "feet.h"\nint main(void) {\n'
        f"  const int16_t q[] = {{{items}}};\n  int once = 0;\n"
        "  if (FEET_SWING_Q(0) != FEET_SWING_Q(once++ * 2) || once != 1) return 1;\n"
        f'  for (int i = 0; i < {len(values)}; i++) printf("%d\\n", q[i]);\n'
        '  printf("%.9g %.9g\\n", (double)FEET_SDG_STEP, (double)FEET_HEIGHT_STEP);\n'
        "  return 0;\n}\n"
    )
    compile_c([*C99, *STRICT, "main.c", "-o", "main"], tmp_path)
    *found, last = run(tmp_path, "./main").splitlines()
    # One step is 5e-5 rad, single precision of 0.87 rad is 6e-8.  Beyond the lower end steps go on
    # below 0, rounded away from it; beyond the upper end there are none: off range.
    inside = [round((v - low) / (high - low) * 32767) for v in values[2:6]]
    assert [int(line) for line in found] == [-20861, -1, *inside, 32767, -32768, 32767]
    assert [float(number) for number in last.split()] == pytest.approx([0.001, 0.0005], rel=1e-6)


def test_every_parameter_has_a_macro_of_its_own():
    for first, macros in (
        ("Swing", ("TRIPOD_SWING", "TRIPOD_PARAM_1_SWING")),
        ("params", ("TRIPOD_PARAM_0_PARAMS", "TRIPOD_SWING")),
        ("swing_q", ("TRIPOD_SWING_Q", "TRIPOD_PARAM_1_SWING")),
    ):
        text = tripod().replace('"reach"', f'"{first}"').replace("reach =", f"{first} =")
        assert axis_macros(replace(tripod_export(), recipe=parse_recipe(text))) == macros


def test_values_that_do_not_fit_their_type_are_refused():
    for ctype, value in (("uint8_t", 256), ("int8_t", -129), ("uint16_t", 0.5), ("float", np.nan)):
        with pytest.raises(InputError, match=f"do not fit {ctype}"):
            CArray("codes", ctype, np.array([value]))


def test_the_text_of_a_family_is_the_same_bytes_in_every_export(folders, exports):
    coded = package.contents(coded_export("coded", "legs"))[0]["coded.c"].decode()
    shown = [(folders["contacts"] / "feet.c").read_text(), coded]
    first, second = (RUNTIME_TEXT.findall(text) for text in shown)
    assert first == second == [runtime_text("points")]
    assert "smap_series_positions" in first[0]
    for export in exports.values():
        body = export.body
        text = runtime_text(family_of(body.codec, export.integer))
        assert '#include "' not in text.replace("#define SMAP_STEERED_BY", "")
        assert text.count("---- core:") == 1
        assert family_row(family_of(body.codec, export.integer), {})["code"] > 1000
    assert "smap_run_step" in control_text("points")


def test_a_name_that_c_cannot_have_is_refused():
    faults = {
        "no C identifier": ["", "3legs", "a-b", "größe", "a b", "a\n"],
        "underscore": ["_map", "a__b"],
        "starts with smap": ["smap", "SMAP_x", "Smap2"],
        "keyword": ["int", "restrict", "class", "nullptr"],
        "taken": ["NULL", "main", "printf", "read", "y0", "map", "linux", "digitalRead", "setup"],
        "ends like": ["uint8_t", "smart_t", "a_pose", "a_pose_i", "a_control"],
        "31 characters": ["x" * (LONGEST + 1)],
    }
    for fault, names in faults.items():
        for name in names:
            with pytest.raises(InputError, match=f"export name.*{fault}") as caught:
                check_name(name)
            assert repr(name) in str(caught.value)


@given(st.text())
def test_any_robot_has_a_name_that_c_can_have(text):
    assert check_name(default_name(text))
    for name in ("paper_two", "Map2", "x", "x" * LONGEST):
        assert check_name(name) == default_name(name) == name
