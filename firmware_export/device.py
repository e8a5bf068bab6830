"""An export folder that is asked: by the tables in its report, nothing is compiled."""

import hashlib
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from firmware_export.emit import load_report
from firmware_export.host import Host
from firmware_export.protocol import restored
from lutgen.errors import InputError, LutgenError
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import Recipe, parse_recipe

__all__ = ["ExportFolder"]

# smap_status_t by its numbers.
STATUS = ("OK", "ROCKS", "TIPS", "OFF_CHART", "OFF_RANGE", "CORRUPT", "INVALID")
# What smap_read_i calls a channel that is not held, and its full scale.
NOT_HELD, FULL_SCALE = 65535, 32767


class ExportFolder:
    """The answers of an export folder.

    Parameters
    ----------
    directory : path
        A folder of `lutgen export`.

    Attributes
    ----------
    report : dict
        The content of NAME_report.json.
    integer : bool
        Whether it answers ``smap_read_i``.
    blob : Blob
        The map.
    host : Host
        What is asked.

    Raises
    ------
    InputError
        If the folder is none of an export, its C file was changed, or its report holds no tables.
    """

    def __init__(self, directory: str | os.PathLike[str]) -> None:
        folder = self._directory = Path(directory)
        self.report = load_report(folder)
        self.integer = self.report["arithmetic"] == "integer"
        tables = self.report.get("tables")
        if tables is None:
            raise InputError(
                f"{folder}: its report holds no tables to ask (got one of lutgen "
                f"{self.report.get('lutgen_version')}); export again."
            )
        path = folder / f"{self.report['name']}.c"
        try:
            digest = hashlib.sha256(path.read_bytes()).hexdigest()
            same, content = digest == tables["source_sha256"], restored(tables)
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
        self.blob = content
        self.host = Host(content)

    def read(
        self, params: Sequence[float], gravity: Sequence[float]
    ) -> tuple[str, dict[str, float]]:
        """Ask the C for one point.

        Parameters
        ----------
        params : (k,) sequence of float
            rad or length, also beyond the axes.
        gravity : (3,) sequence of float
            Pointing down, any length > 0.

        Returns
        -------
        tuple of str and dict
            The status without its SMAP_, and the channels in rad and length: NaN where the map
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
        sdg, tip, height = (int(value) for value in readings[0])
        steps = self.report["steps"]
        lengths = {
            name: math.nan if code == NOT_HELD else code * steps.get(name, math.nan)
            for name, code in (("sdg", sdg), ("height", height))
        }
        sine = max(-1.0, min(1.0, tip / FULL_SCALE))
        return STATUS[int(codes[0])], {**lengths, "tip_angle": math.asin(sine)}

    def recipe(self) -> Recipe:
        """Return the recipe that the report holds; its code is left alone.

        Raises
        ------
        InputError
            If the report does not hold it, or another than that of the export.
        """
        held: Any = self.report.get("recipe")
        try:
            text, urdf = held["text"], held["urdf"]
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
