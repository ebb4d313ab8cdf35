"""The fixture that loads a study for a test."""

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def load():
    """Return a function that imports a study by its name; a study imports the files beside it."""
    sys.path.insert(0, str(HERE))

    def study(name):
        spec = spec_from_file_location(f"study_{name}", HERE / f"{name}.py")
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    yield study
    sys.path.remove(str(HERE))
