"""The one direction of imports, and the size of modules."""

import ast
from pathlib import Path

import pytest

import lutgen

PACKAGE = Path(lutgen.__file__).resolve().parent
ROOT = PACKAGE.parent
# Each may import only from those before it: data goes from the recipe to the robot, its facets
# and its channels, from there into a map, and from the map to people.
ORDER = (
    *("errors", "_version", "files", "jit", "vector", "placement", "grid", "sphere"),
    *("recipe_schema", "urdf_xml", "urdf", "urdf_motion", "urdf_xacro"),
    *("recipe_robot", "recipe_load", "urdf_contacts", "urdf_links", "recipe_urdf"),
    *("recipe_plugin", "recipe"),
    *("urdf_choice", "urdf_text", "urdf_recipe", "robot"),
    *("primitive", "polygon", "support", "rounds", "facet_list", "region", "boundary", "channels"),
    *("loaded_axes", "loaded", "load"),
    *("evaluation", "pairs", "statics", "attitude", "rolling", "wheels"),
    *("raster", "tilt", "scan", "scanner", "standing"),
    *("interpolate", "checksum", "blocks", "seal", "store", "verify", "statistics"),
    *("skeleton", "partfile", "computer", "engine_dask", "sweeper"),
    *("objective", "minimise", "acceptable", "search", "terrain", "terrain_csv", "drive"),
    *("limits", "limit_table", "footing", "force_angle", "sliding", "holding", "metrics"),
    *("plot", "paper", "cli"),
)
# The same for the export: from the robot to what codecs store, how it is read again, certified,
# chosen, written as C, and compiled.
EXPORT = ROOT / "firmware_export"
EXPORT_ORDER = (
    *("quantity", "identifier", "c_array", "c_text", "model", "exported", "certificate"),
    *("strict", "vector32", "three_points", "axis", "tip_boundary", "sample"),
    *("contacts_modes", "contacts_fit", "contacts_guard"),
    *("contacts_planes", "contacts_facets", "contacts_read", "contacts"),
    *("poly_series", "poly_bound", "poly_fit", "poly_read", "poly"),
    *("grid_spec", "grid_tables", "grid_lattice", "grid_fit", "grid_outline", "grid_verdict"),
    *("grid_guard", "grid_tip", "grid_knots", "grid_rough", "grid_read", "grid_read_i", "grid"),
    *("twin", "answers", "codecs", "certify_jumps", "certify_search", "certify"),
    *("size", "c_config", "facts", "c_header", "c_source", "example", "project_files"),
    *("report_page", "report_figure", "report", "size_measure", "package"),
    *("candidate", "goal", "choose_dear", "choose", "exporter", "host"),
)
MODULES = sorted(p for p in PACKAGE.rglob("*.py") if p != PACKAGE / "__init__.py")


def layer(path: Path) -> str:
    """Return the name of a module's layer: its own, or that of its folder."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported(path: Path, package: str = "lutgen") -> set[str]:
    """Return the layers of a package that a file imports anywhere, also inside functions."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports hide the layer"
            module = node.module or ""
            names = [module, *(f"{module}.{alias.name}" for alias in node.names)]
        for name in names:
            parts = name.split(".")
            if parts[0] == package and len(parts) > 1:
                found.add(parts[1])
    return found & {layer(p) for p in MODULES} if package == "lutgen" else found


def test_every_module_has_its_place_in_the_order() -> None:
    assert {layer(path) for path in MODULES} == set(ORDER)
    assert len(set(ORDER)) == len(ORDER)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module_imports_only_from_layers_below_it(path: Path) -> None:
    own = ORDER.index(layer(path))
    above = {name for name in imported(path) if ORDER.index(name) > own}
    assert above == set()
    # A module in a folder may import its neighbours; a plain one cannot import itself.
    assert path.parent != PACKAGE or layer(path) not in imported(path)


def test_the_reader_of_imports_finds_what_there_is() -> None:
    assert {"blocks", "computer", "engine_dask", "partfile"} <= imported(PACKAGE / "sweeper.py")
    # Inside a function:
    assert "sweeper" in imported(PACKAGE / "cli" / "sweep.py")


def test_no_library_module_imports_the_command_line() -> None:
    for path in MODULES:
        if layer(path) != "cli":
            assert "cli" not in imported(path), path


def test_only_figures_import_matplotlib_and_only_the_command_line_imports_click() -> None:
    for path in MODULES:
        roots = {
            (node.module if isinstance(node, ast.ImportFrom) else node.names[0].name).split(".")[0]  # type: ignore[union-attr]
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Import | ast.ImportFrom)
        }
        assert "matplotlib" not in roots or layer(path) == "plot", path
        assert "click" not in roots or layer(path) == "cli", path


def test_the_firmware_export_imports_neither_figures_nor_the_command_line() -> None:
    for path in (ROOT / "firmware_export").rglob("*.py"):
        assert not {"plot", "cli"} & imported(path), path


def test_the_export_imports_one_way_too() -> None:
    modules = {path.stem: path for path in EXPORT.glob("*.py") if path.stem != "__init__"}
    assert set(modules) == set(EXPORT_ORDER)
    for name, path in modules.items():
        above = EXPORT_ORDER[EXPORT_ORDER.index(name) :]
        assert not imported(path, "firmware_export") & set(above), name


def test_no_library_module_imports_the_export() -> None:
    for path in MODULES:
        if layer(path) != "cli":
            assert not imported(path, "firmware_export"), path


def test_no_module_is_longer_than_400_lines() -> None:
    for path in [*MODULES, *(ROOT / "firmware_export").rglob("*.py")]:
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 400, path
