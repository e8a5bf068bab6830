"""An export folder that is asked: by the tables in its report, nothing is compiled."""

import hashlib
import os
from pathlib import Path
from typing import Any

from firmware_export.emit import load_report
from firmware_export.host import Host
from firmware_export.protocol import restored
from lutgen.errors import InputError, LutgenError
from lutgen.recipe import Recipe, parse_recipe

__all__ = ["ExportFolder"]


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
