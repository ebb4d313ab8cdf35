"""The fixture that loads a study for a test."""

import sys
from importlib import import_module
from pathlib import Path

import pytest

HERE = str(Path(__file__).parent)


@pytest.fixture(scope="module")
def load():
    """Return a function that imports a study by its name; a study imports the files beside it."""
    sys.path.insert(0, HERE)
    yield import_module
    sys.path.remove(HERE)
