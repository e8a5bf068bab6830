"""The names that scripts may rely on."""

import importlib
import pkgutil
import sys

import pytest

import lutgen
from lutgen.errors import optional

NAMES = (
    "ExportError InputError LutgenError MapFileError RecipeError SweepError __version__ "
    "evaluate load_map load_recipe optimum parse_recipe postures stability sweep"
)


def test_the_public_names_are_these_and_no_others():
    assert " ".join(dir(lutgen)) == " ".join(sorted(lutgen.__all__)) == NAMES
    with pytest.raises(AttributeError, match="no attribute 'no_such_name'"):
        _ = lutgen.no_such_name


def test_public_functions_stay_callable_after_every_submodule_is_imported():
    # A submodule of the same name would take a function's place in the package.
    for module in pkgutil.walk_packages(lutgen.__path__, "lutgen."):
        importlib.import_module(module.name)
    for name in lutgen.__all__:
        assert callable(getattr(lutgen, name)) or name == "__version__", name


def test_errors_are_lutgen_errors_and_the_builtins_that_callers_expect():
    for name, builtin in {
        "ExportError": RuntimeError,
        "RecipeError": ValueError,
        "InputError": ValueError,
        "MapFileError": OSError,
        "SweepError": RuntimeError,
    }.items():
        error = getattr(lutgen, name)
        assert issubclass(error, lutgen.LutgenError)
        assert issubclass(error, builtin)


@pytest.mark.parametrize("name", ["trimesh", "mujoco", "xacrodoc", "xarray"])
def test_a_package_that_is_not_there_is_named_with_how_to_get_it(name, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)
    said = rf"a\.x: needs more packages \(got .*{name}.*\); `pip install b`, or do without\."
    with pytest.raises(lutgen.InputError, match=said):
        optional("a.x", name, "b", "do without")
