"""What tests of the studies share."""

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def load():
    """Load a study by its path, as ``python tests/studies/NAME.py`` would find its neighbours."""
    sys.path.insert(0, str(HERE))

    def loaded(name):
        spec = spec_from_file_location(f"study_{name}", HERE / f"{name}.py")
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    yield loaded
    sys.path.remove(str(HERE))
