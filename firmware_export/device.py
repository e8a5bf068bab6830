"""An export folder that is read: by the tables in its report, nothing is compiled."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from firmware_export.emit import load_report
from firmware_export.host import FULL_SCALE, Host, in_units
from firmware_export.protocol import restored
from lutgen.errors import InputError, reject
from lutgen.files import digest as file_digest
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import Recipe, parse_recipe

# smap_status_t by its numbers.
STATUS = ("OK", "ROCKS", "TIPS", "OFF_CHART", "OFF_RANGE", "CORRUPT", "INVALID")


class ExportFolder:
    """The answers of an export folder; its `report`, `blob` and `host`.

    Raises
    ------
    InputError
        If the folder is not an export, its C file was changed, or its report holds no tables.
    """

    def __init__(self, directory: str | os.PathLike[str]) -> None:
        folder = self._directory = Path(directory)
        self.report = load_report(folder)
        self.integer = self.report["arithmetic"] == "integer"
        tables: Any = self.report.get("tables")
        path = folder / f"{self.report['name']}.c"
        try:
            digest = file_digest(path.read_bytes())
            same, self.blob = digest == tables["source_sha256"], restored(tables)
            self.host = Host(self.blob)
            if self.host.check() != 0:  # a read could leave its memory
                raise ValueError("smap_check refuses them")
        except OSError as error:
            reject(path, "cannot be read", error.strerror, "export again", InputError)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            what, got = "the tables of its report are damaged", f"{type(error).__name__}: {error}"
            reject(folder, what, got, "export again", InputError)
        if not same:
            said = str(tables["source_sha256"])[:12]
            got = f"the digest {digest[:12]}, its report says {said}"
            reject(path, "is not the file that was exported", got, "export again", InputError)

    def read(
        self, params: Sequence[float], gravity: Sequence[float]
    ) -> tuple[str, dict[str, float]]:
        """Query the C at one point: params (k,), also beyond the axes, and gravity (3,), down.

        Returns the status without its SMAP_, and the channels in rad and length: NaN where the map
        does not hold one.
        """
        values: NDArray[Any]
        if self.integer:
            codes, whole = self.host.read_i(*self._steps(params, gravity))
            values = in_units(whole, self.report["steps"])
        else:
            codes, values = self.host.read([params], [gravity])
        return STATUS[int(codes[0])], dict(zip(EXPORTABLE, values[0].tolist(), strict=True))

    def _steps(
        self, params: Sequence[float], gravity: Sequence[float]
    ) -> tuple[list[list[int]], list[list[int]]]:
        """Return a posture in steps of its axes, and gravity as whole numbers."""
        row = []
        for parameter, value in zip(self.report["parameters"], params, strict=True):
            low, high = parameter["min"], parameter["max"]
            code = round((value - low) / (high - low) * FULL_SCALE)
            # Above the upper end there are no steps: off range.
            row.append(max(code, -FULL_SCALE - 1) if value <= high else -FULL_SCALE - 1)
        # The longest vector of the same direction that fits resolves it best.
        longest = max(map(abs, gravity))
        return [row], [[round(part / longest * FULL_SCALE) for part in gravity]]

    def recipe(self) -> Recipe:
        """Return the recipe that the report holds, its code left alone; refuse another one."""
        stored: Any = self.report.get("recipe")
        try:
            text, urdf = stored["text"], stored["urdf"]
            name = f"{self._directory} (recipe inside)"
            recipe = parse_recipe(text, name, inert=True, urdf=urdf)
        except (KeyError, TypeError, AttributeError):
            what, got = "its report does not hold the recipe", self.report.get("lutgen_version")
            reject(self._directory, what, f"one of lutgen {got}", "export again", InputError)
        if recipe.digest != self.report.get("recipe_sha256"):
            what = "the recipe of its report was changed"
            said = str(self.report.get("recipe_sha256"))[:12]
            got = f"the digest {recipe.digest[:12]}, not {said}"
            reject(self._directory, what, got, "export again", InputError)
        return recipe
