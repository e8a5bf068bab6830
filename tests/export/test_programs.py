"""Exports in other people's programs: several at once, any flags, any build system, any name."""

import json
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from firmware_export.emit import check_name, package
from firmware_export.emit.package import try_out
from firmware_export.protocol import Joint, Policy
from lutgen.errors import ExportError
from tests.fixtures.compiled import STRICT, compile_c, run
from tests.fixtures.exports import rover_export, tripod_export
from tests.fixtures.length import LONG
from tests.fixtures.places import ROOT

NAMES = ("one", "two", "three")
# Levels and freedoms of the compiler.
FLAGS = (
    "-Ofast -march=native -flto -ffp-contract=fast",
    "-std=gnu17 -Os -ffinite-math-only",
)
if LONG:
    FLAGS += ("-Ofast", "-O0", "-O2", "-O3", "-Os", "-std=gnu99 -O1 -ffp-contract=fast")
# Prints a hash of statuses and bits of one map, or of all of them in turn.
MAIN = """\
#include <stdio.h>
#include <string.h>
INCLUDES
static unsigned hash = 2166136261u;
static void mix(const void *data, unsigned size)
{
  const unsigned char *byte = (const unsigned char *)data;
  while (size--) {
    hash = (hash ^ *byte++) * 16777619u;
  }
}
/* Of numbers that no flag rounds otherwise. */
static void ask(const smap_t *map, smap_pose_t *pose, unsigned bytes, float a, float b)
{
  int i;
  for (i = 0; i < 400; i++) {
    const float params[2] = {a + (float)i / 1024.0f, b};
    const float g[3] = {(float)(i - 200) / 512.0f, 0.1f, -1.0f};
    const short down[3] = {(short)(10 * (i - 200)), 100, -1000};
    smap_reading_t r;
    smap_reading_i_t w;
    int s = smap_pose(map, params, pose, (unsigned short)bytes, SMAP_FLOAT | SMAP_INTEGER);
    mix(&s, sizeof s);
    s = smap_at(pose, g, &r);
    mix(&s, sizeof s), mix(&r.sdg, 4), mix(&r.tip_angle, 4), mix(&r.height, 4), mix(r.over, 2);
    s = smap_at_i(pose, down, &w);
    mix(&s, sizeof s), mix(&w.sdg, 2), mix(&w.tip, 2), mix(w.over, 2);
    s = smap_read(map, params, g, &r);
    mix(&s, sizeof s), mix(&r.tip_angle, 4);
  }
}
int main(void)
{
CALLS
  return 0;
}
"""


def main_of(names):
    calls = []
    for name in names:
        calls.append(f"  {{ static {name}_pose_t pose; hash = 2166136261u;")
        calls.append(f"    ask(&{name}, &pose.pose, sizeof pose, 0.2f, 0.3f);")
        calls.append(f'    printf("{name} %08x %d\\n", hash, (int)smap_check(&{name})); }}')
    includes = "\n".join(f'#include "{name}.h"' for name in names)
    return MAIN.replace("INCLUDES", includes).replace("CALLS", "\n".join(calls))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder of three exports, all of whose sources are thrown together in it, too."""
    place = tmp_path_factory.mktemp("programs")
    exports = (tripod_export("one"), rover_export("two"), tripod_export("three", codec="grid"))
    for export in exports:
        package.write(export, place / export.name)
        for path in (place / export.name).glob("*.[ch]"):
            shutil.copy(path, place)
    return place


def said(folder, flags, names, compiler="cc"):
    """Compile a program with some maps; return what it prints, or that it does not compile."""
    (folder / "main.c").write_text(main_of(names))
    words = [compiler, *flags.split(), "main.c", *(f"{name}.c" for name in names), "-o", "main"]
    built = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    if built.returncode:
        return [line for line in built.stderr.splitlines() if "#error" in line or "error: " in line]
    return run(folder, "./main").splitlines()


@pytest.fixture(scope="module")
def alone(folder):
    return [line for name in NAMES for line in said(folder, "-std=c99 -O0", (name,))]


@pytest.mark.parametrize("flags", FLAGS)
def test_each_map_answers_beside_others_the_bits_that_it_answers_alone(folder, alone, flags):
    assert len({line.split()[1] for line in alone}) == 3
    assert all(line.endswith(" 0") for line in alone)
    assert said(folder, flags, NAMES) == alone


@pytest.mark.needs("clang")
def test_clang_gives_the_same_bits_or_refuses(folder, alone):
    assert said(folder, "-Os", NAMES, "clang") == alone
    assert "without -ffast-math" in said(folder, "-O2 -ffast-math", ("one",), "clang")[0]
    # Every pose is invalid: nothing is answered rather than something else.
    (found,) = said(folder, "-O3 -mfma -ffp-contract=fast", ("one",), "clang")
    assert found != alone[0]
    assert found.endswith(" 0")


def test_shared_libraries_of_several_maps_do_not_meet(folder, alone):
    for name in NAMES:
        library = f"lib{name}.so"
        compile_c(["-shared", "-fPIC", "-O1", "-o", library, f"{name}.c"], folder)
        seen = run(folder, "nm", "-D", "--defined-only", library).splitlines()
        own = {name, f"{name}_tables", "_init", "_fini"}
        assert {line.split()[-1] for line in seen} <= own
    (folder / "main.c").write_text(main_of(NAMES))
    links = [f"-l{name}" for name in NAMES]
    compile_c(["main.c", "-L.", *links, "-Wl,-rpath,.", "-o", "main"], folder)
    assert run(folder, "./main").splitlines() == alone


@pytest.mark.needs("cmake")
def test_cmake_installs_packages_that_programs_find(folder, alone, tmp_path):
    prefix = tmp_path / "prefix"
    for name in NAMES:
        build = tmp_path / name
        prefixed = f"-DCMAKE_INSTALL_PREFIX={prefix}"
        run(folder, "cmake", "-S", name, "-B", str(build), prefixed)
        run(folder, "cmake", "--build", str(build))
        run(build, f"./{name}_example")
        run(folder, "cmake", "--install", str(build))
    app = tmp_path / "app"
    app.mkdir()
    (app / "main.c").write_text(main_of(NAMES))
    found = "\n".join(f"find_package(smap_{name} REQUIRED)" for name in NAMES)
    links = " ".join(f"smap_{name}::smap_{name}" for name in NAMES)
    (app / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.13)\nproject(app C)\n{found}\n"
        "add_executable(app main.c)\n"
        f"target_link_libraries(app PRIVATE {links})\n"
    )
    run(app, "cmake", "-B", "b", f"-DCMAKE_PREFIX_PATH={prefix}")
    run(app, "cmake", "--build", "b")
    assert run(app, "b/app").splitlines() == alone


def test_library_files_name_what_is_compiled_and_the_sketch_is_c_plus_plus(folder):
    content = json.loads((folder / "one" / "library.json").read_text())
    lines = (folder / "one" / "library.properties").read_text().splitlines()
    properties = dict(line.split("=", 1) for line in lines if not line.startswith("#"))
    assert content["name"] == properties["name"] == "smap_one"
    assert content["version"] == properties["version"]
    assert len(content["version"].split(".")) == 3
    assert content["headers"] == properties["includes"] == "one.h"
    # What has a main of its own is no part of the library.
    assert content["build"]["srcFilter"] == ["+<one.c>"]
    assert "cmake: zephyr" in (folder / "one" / "zephyr" / "module.yml").read_text()
    assert "../one.c" in (folder / "one" / "zephyr" / "CMakeLists.txt").read_text()
    for example in ("read", "alarm"):
        compile_c(["-Ione", "-DARDUINO=1", "-c", f"one/examples/{example}.c", "-o", "x.o"], folder)
    # An Arduino sketch is C++ with a core around it.
    core = (
        "#include <stdint.h>\nstruct S { void begin(long) {} void println(const char *) {} "
        "void println(double) {} };\nstatic S Serial;\n"
        "void delay(unsigned long) {}\nvoid setup();\nvoid loop();\n"
    )
    sketch = core + (folder / "one" / "examples" / "one" / "one.ino").read_text()
    (folder / "sketch.cpp").write_text(sketch)
    words = "g++ -std=c++17 -Wall -Wextra -Wno-unused -Wdouble-promotion -Ione -DARDUINO=1 -c"
    subprocess.run([*words.split(), "sketch.cpp", "-o", "sketch.o"], cwd=folder, check=True)


def test_the_alarm_goes_from_clear_to_danger_and_back_with_hysteresis(folder):
    for name in ("one", "three"):
        flags = ["-std=c99", *STRICT, f"-I{name}", f"{name}/{name}.c", f"{name}/examples/alarm.c"]
        compile_c([*flags, "-o", "alarm"], folder)
        lines = run(folder, "./alarm").splitlines()
        # Before anything is known; then the bump, at x = 32000, is not heard.
        assert [line.rsplit(" ", 1)[1] for line in lines] == [
            *("danger", "clear", "warning", "danger", "warning", "clear")
        ]
        places = [int(line[4:9]) for line in lines[1:]]
        assert max(places) < 32000
        # It falls at smaller angles than it rises.
        assert places[1] > places[4]
        assert places[2] > places[3]
        assert len((folder / name / "examples" / "alarm.c").read_text().splitlines()) <= 120


def test_a_name_that_is_accepted_compiles_and_runs():
    for name in ("pose", "PI2", "q", "read_i"):
        assert check_name(name) == name
    for name in ("pose", "q"):
        files = package.contents(tripod_export(name))[0]
        assert "compiled and run" in try_out(files, name), name


def test_a_name_of_a_function_of_the_c_library_is_refused_where_it_is_tried():
    # The map would take the place of what a library calls.
    for name in ("fopen64", "localtime_r", "sinf"):
        assert check_name(name) == name
        with pytest.raises(ExportError, match=f"has a function of this name .*{name}_map"):
            try_out(package.contents(tripod_export(name))[0], name)


def test_without_a_compiler_the_trial_says_so(monkeypatch):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    assert try_out({}, "robot") == "not compiled: there is no C compiler here"


def test_what_does_not_compile_is_not_written(tmp_path, monkeypatch):
    files, _ = package.contents(tripod_export())
    broken = files | {"tripod.c": files["tripod.c"].replace(b"SMAP_OWN_BLOB[", b"SMAP OWN BLOB[")}
    with pytest.raises(ExportError, match="does not compile or run"):
        try_out(broken, "tripod")
    monkeypatch.setattr(package, "contents", lambda export: (broken, {}))
    with pytest.raises(ExportError):
        package.write(tripod_export(), tmp_path / "e", lambda text: None)
    assert not (tmp_path / "e").exists()
    assert list(tmp_path.iterdir()) == []


STUB = ROOT / "tests/fixtures/rclcpp_stub.hpp"
HEADERS = (
    *("rclcpp/rclcpp", "sensor_msgs/msg/imu", "sensor_msgs/msg/joint_state"),
    *("std_msgs/msg/float64_multi_array", "std_msgs/msg/u_int8"),
    *("diagnostic_msgs/msg/diagnostic_array", "visualization_msgs/msg/marker"),
)
JOINTS = (Joint(0.0, 0.002, 0.01, 1.0, 1e-4, 1.0, 0.1, 0.1),) * 2
POLICY = Policy(
    *(np.full((2, 2, 2), 100, np.uint8), 1.0, JOINTS, 0.02, 0.06, 0.05, (0.3, 0.2, 0.1), 0.5)
)


@pytest.mark.needs("c++")
@pytest.mark.parametrize("policy", [None, POLICY], ids=["read", "policy"])
def test_the_node_tells_how_the_robot_stands_and_steers_it_with_a_policy(tmp_path, policy):
    export = replace(tripod_export("feet"), policy=policy)
    package.write(export, tmp_path / "feet")
    for name in HEADERS:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / f"{name}.hpp").write_text(f'#include "{STUB}"\n')
    compile_c(["-Ifeet", "-c", "feet/feet.c", "-o", "map.o"], tmp_path)
    words = "-std=c++17 -Wall -Wextra -Werror -Ifeet -I. feet/examples/ros2_node.cpp map.o -o node"
    run(tmp_path, "c++", *words.split())
    said = run(tmp_path, "./node").splitlines()
    assert said[0] == "node feet_stability"
    assert [line for line in said if line.startswith("level")] == [
        "level 3: no samples of the IMU or the joints",
        "level 0: stands",
        "level 2: unknown: the map holds no such direction",
    ]
    params = np.array([[0.3, 0.1]])
    exact = export.model.exact(params, np.array([[[0.0, 0.0, -1.0]]]))
    angles = [float(line.split()[1]) for line in said if line.startswith("tip_angle_deg")]
    assert angles[0] == pytest.approx(np.degrees(exact.tip_angle[0, 0]), abs=0.01)
    assert angles[1] < 0.0
    assert [line for line in said if line.startswith("marker")] == [
        *("marker  1 0", "marker base_link 0 1", "marker base_link 1 0")
    ]
    # One cycle on level ground, no faster than a joint may go.
    commands = [float(line.split()[1]) for line in said if line.startswith("command")]
    assert len(commands) == (4 if policy else 0)
    if policy:
        assert np.abs(np.array(commands) - [*params[0], *params[0]]).max() <= 0.0201
        assert np.abs(np.array(commands[:2]) - params[0]).max() > 0.005
    assert any(line.startswith("fatal") for line in said) is False
