"""The C code of an export, compiled for this machine and asked from Python.

Two ways: a shared library that is called through ctypes, and a program that reads queries from a
file, which can be built with sanitizers.  Both loop over the queries in C.
"""

import ctypes
import os
import shlex
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from firmware_export.emit import load_report
from firmware_export.host.reader import READING, READING_I
from lutgen.errors import ExportError, InputError

__all__ = ["FLAGS", "HostLibrary", "compile_c"]

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")
# Seconds; the largest tables compile in a few.
_PATIENCE = 300.0

# The loop over queries, and the program around it.  @NAME@ and @PARAMS@ are replaced.
_LOOP = """\
#include "@NAME@.h"

#if @INTEGER@
typedef int16_t number_t;
typedef smap_reading_i_t answer_t;
#define READ smap_read_i
#else
typedef float number_t;
typedef smap_reading_t answer_t;
#define READ smap_read
#endif

void batch(int64_t count, const number_t *params, const number_t *gravity, int8_t *status,
           answer_t *reading);

void batch(int64_t count, const number_t *params, const number_t *gravity, int8_t *status,
           answer_t *reading)
{
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] = (int8_t)READ(&@NAME@, params + i * @PARAMS@, gravity + i * 3, reading + i);
  }
}
"""
_PROGRAM = """\
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int count, char **names)
{
  number_t row[@PARAMS@ + 3];
  FILE *in = count == 3 ? fopen(names[1], "rb") : NULL;
  FILE *out = count == 3 ? fopen(names[2], "wb") : NULL;
  if (!in || !out) {
    return 2;
  }
  while (fread(row, sizeof row, 1, in) == 1) {
    int8_t status;
    answer_t answer;
    /* On the heap and of just that size, so that a read beyond an end is seen. */
    number_t *own = malloc((@PARAMS@ + 3) * sizeof *own);
    if (!own) {
      return 2;
    }
    memcpy(own, row, sizeof row);
    memset(&answer, 0, sizeof answer);
    batch(1, own, own + @PARAMS@, &status, &answer);
    free(own);
    if (fwrite(&status, 1, 1, out) != 1 || fwrite(&answer, sizeof answer, 1, out) != 1) {
      return 2;
    }
  }
  return fclose(out) || fclose(in) ? 2 : 0;
}
"""


def _columns(reading: NDArray[Any]) -> NDArray[np.float32]:
    """Return the floats of readings as columns."""
    return np.stack([reading[name] for name in ("sdg", "tip_angle", "height")], axis=1)


def compile_c(arguments: Sequence[str], folder: Path) -> None:
    """Run the host's C compiler (environment variable CC, else cc) in a folder."""
    compiler = shlex.split(os.environ.get("CC", "")) or ["cc"]
    try:
        done = subprocess.run(
            [*compiler, *arguments],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=_PATIENCE,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ExportError(
            f"{compiler[0]}: the C compiler cannot be run (got {type(error).__name__}); "
            "install one, or set CC to its name."
        ) from error
    if done.returncode:
        said = [line for line in done.stderr.splitlines() if "error" in line.lower()]
        first = (said or done.stderr.splitlines() or ["nothing"])[0].strip()
        raise ExportError(
            f"{compiler[0]}: the export does not compile (got {first!r}); export again."
        )


class HostLibrary:
    """An export folder, compiled.

    Parameters
    ----------
    directory : path
        Written by `package.write`.
    flags : sequence of str
        Of the compiler.

    Attributes
    ----------
    report : dict
        The content of NAME_report.json.
    """

    def __init__(self, directory: str | os.PathLike[str], flags: Sequence[str] = FLAGS) -> None:
        self._source = Path(directory).absolute()
        self._flags = tuple(flags)
        self.report = load_report(Path(directory))
        self.name = str(self.report["name"])
        self.params = len(self.report["parameters"])
        self.integer = self.report["arithmetic"] == "integer"
        self._library: ctypes.CDLL | None = None

    def read(
        self, params: ArrayLike, gravity: ArrayLike
    ) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
        """Ask smap_read.

        Parameters
        ----------
        params : (m, k) array_like
            rad or length.
        gravity : (m, 3) array_like
            Down, any length > 0.

        Returns
        -------
        status : (m,) int8
            See smap_status_t.
        reading : (m, 3) float32
            sdg, tip_angle, height.
        """
        self._refuse_other(integer=False)
        status, reading = self._ask(params, gravity)
        return status, _columns(reading)

    def read_i(
        self, params_q: ArrayLike, gravity_q: ArrayLike
    ) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
        """Ask smap_read_i.

        Parameters
        ----------
        params_q : (m, k) array_like of int
            0 to 32767 between the ends of each axis.
        gravity_q : (m, 3) array_like of int
            Down, any length > 0.

        Returns
        -------
        status : (m,) int8
            See smap_status_t.
        reading : (m, 3) int32
            sdg and height in steps, tip in 1 / 32767.
        """
        self._refuse_other(integer=True)
        status, reading = self._ask(params_q, gravity_q)
        columns = [reading[name].astype(np.int32) for name in ("sdg", "tip", "height")]
        return status, np.stack(columns, axis=1)

    def run_driver(
        self, params: ArrayLike, gravity: ArrayLike, flags: Sequence[str] = ()
    ) -> tuple[NDArray[np.int8], NDArray[Any]]:
        """Ask a program of its own, built with further flags such as ``-fsanitize=address``.

        Returns
        -------
        status, reading
            As `read` or `read_i`.  What the program wrote to stderr, and an exit code other than
            0, are an ExportError.
        """
        rows, downs = self._checked(params, gravity)
        with tempfile.TemporaryDirectory(prefix="lutgen-") as name:
            folder = Path(name)
            self._compile(folder, "driver.c", _LOOP + _PROGRAM, "driver", flags)
            np.concatenate([rows, downs], axis=1).tofile(folder / "queries")
            done = subprocess.run(
                [str(folder / "driver"), "queries", "answers"],
                cwd=folder,
                capture_output=True,
                text=True,
                timeout=_PATIENCE,
                check=False,
            )
            if done.returncode or done.stderr:
                said = (done.stderr.splitlines() or ["nothing"])[0]
                raise ExportError(
                    f"{self._source.name}: the compiled export failed (got exit code "
                    f"{done.returncode}: {said}); this is a fault of the runtime."
                )
            row = np.dtype([("status", "i1"), ("reading", self._reading)])
            answers = np.fromfile(folder / "answers", dtype=row)
        reading = np.ascontiguousarray(answers["reading"])
        if self.integer:
            columns = [reading[name].astype(np.int32) for name in ("sdg", "tip", "height")]
            return answers["status"].copy(), np.stack(columns, axis=1)
        return answers["status"].copy(), _columns(reading)

    @property
    def _reading(self) -> np.dtype[Any]:
        return READING_I if self.integer else READING

    def _refuse_other(self, integer: bool) -> None:
        if integer != self.integer:
            raise InputError(
                f"{self._source.name}: the export's arithmetic is another (got "
                f"{self.report['arithmetic']}); use {'read' if integer else 'read_i'}."
            )

    def _checked(self, params: ArrayLike, gravity: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return the queries as C wants them."""
        dtype = np.int16 if self.integer else np.float32
        rows = np.ascontiguousarray(params, dtype=dtype)
        downs = np.ascontiguousarray(gravity, dtype=dtype)
        if rows.ndim != 2 or downs.shape != (len(rows), 3) or rows.shape[1] != self.params:
            raise InputError(
                f"params and gravity must have the shapes (m, {self.params}) and (m, 3) "
                f"(got {rows.shape} and {downs.shape}); give one row for each query."
            )
        return rows, downs

    def _ask(self, params: ArrayLike, gravity: ArrayLike) -> tuple[NDArray[np.int8], NDArray[Any]]:
        rows, downs = self._checked(params, gravity)
        status = np.empty(len(rows), np.int8)
        reading = np.empty(len(rows), self._reading)
        self._loaded().batch(
            ctypes.c_int64(len(rows)),
            *(array.ctypes.data_as(ctypes.c_void_p) for array in (rows, downs, status, reading)),
        )
        return status, reading

    def _loaded(self) -> ctypes.CDLL:
        if self._library is None:
            with tempfile.TemporaryDirectory(prefix="lutgen-") as name:
                folder = Path(name)
                shared = ("-fPIC", "-shared")
                self._compile(folder, "batch.c", _LOOP, "batch.so", shared)
                # Once it is loaded, its file is no longer needed.
                self._library = ctypes.CDLL(str(folder / "batch.so"))
        return self._library

    def _compile(
        self, folder: Path, name: str, text: str, target: str, flags: Sequence[str]
    ) -> None:
        """Compile a generated file together with the export."""
        for key, value in (
            ("@NAME@", self.name),
            ("@PARAMS@", str(self.params)),
            ("@INTEGER@", str(int(self.integer))),
        ):
            text = text.replace(key, value)
        (folder / name).write_text(text, encoding="utf-8")
        sources = [str(self._source / f"{self.name}.c")]
        compile_c(
            [*self._flags, *flags, "-I", str(self._source), name, *sources, "-o", target], folder
        )
