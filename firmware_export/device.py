"""An export folder that is read: by the tables in its report, nothing is compiled."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from firmware_export.emit import load_report
from firmware_export.host import FULL_SCALE, Host, in_units
from firmware_export.protocol import restored
from lutgen.errors import InputError, LutgenError
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
            raise InputError(
                f"{path}: cannot be read (got {error.strerror}); export again."
            ) from error
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise InputError(
                f"{folder}: the tables of its report are damaged (got {type(error).__name__}: "
                f"{error}); export again."
            ) from error
        if not same:
            raise InputError(
                f"{path}: is not the file that was exported (got the digest {digest[:12]}, its "
                f"report says {str(tables['source_sha256'])[:12]}); export again."
            )

    def read(
        self, params: Sequence[float], gravity: Sequence[float]
    ) -> tuple[str, dict[str, float]]:
        """Query the C at one point: params (k,), also beyond the axes, and gravity (3,), down.

        Returns the status without its SMAP_, and the channels in rad and length: NaN where the map
        does not hold one.
        """
        if self.integer:
            return self._read_integer(params, gravity)
        codes, readings = self.host.read([params], [gravity])
        values = map(float, readings[0])
        return STATUS[int(codes[0])], dict(zip(EXPORTABLE, values, strict=True))

    def _read_integer(
        self, params: Sequence[float], gravity: Sequence[float]
    ) -> tuple[str, dict[str, float]]:
        row = []
        for parameter, value in zip(self.report["parameters"], params, strict=True):
            low, high = parameter["min"], parameter["max"]
            code = round((value - low) / (high - low) * FULL_SCALE)
            # Above the upper end there are no steps: off range.
            row.append(max(code, -FULL_SCALE - 1) if value <= high else -FULL_SCALE - 1)
        # The longest vector of the same direction that fits resolves it best.
        longest = max(map(abs, gravity))
        down = [round(part / longest * FULL_SCALE) for part in gravity]
        codes, readings = self.host.read_i([row], [down])
        values = in_units(readings, self.report["steps"])[0].tolist()
        return STATUS[int(codes[0])], dict(zip(EXPORTABLE, values, strict=True))

    def recipe(self) -> Recipe:
        """Return the recipe that the report holds, its code left alone; refuse another one."""
        stored: Any = self.report.get("recipe")
        try:
            text, urdf = stored["text"], stored["urdf"]
            name = f"{self._directory} (recipe inside)"
            recipe = parse_recipe(text, name, inert=True, urdf=urdf)
        except LutgenError:
            raise
        except (KeyError, TypeError, AttributeError) as error:
            raise InputError(
                f"{self._directory}: its report does not hold the recipe (got one of lutgen "
                f"{self.report.get('lutgen_version')}); export again."
            ) from error
        if recipe.digest != self.report.get("recipe_sha256"):
            raise InputError(
                f"{self._directory}: the recipe of its report was changed (got the digest "
                f"{recipe.digest[:12]}, not {str(self.report.get('recipe_sha256'))[:12]}); "
                "export again."
            )
        return recipe
