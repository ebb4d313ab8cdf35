"""What the command line sets in its own process."""

import importlib
import os
import sys

import pytest

from imuwb import own_process
from imuwb.own_process import THREADS, environment, without

PACKAGE = "imuwb_package_of_a_test"


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Return the name of a package that is installed and not imported."""
    (tmp_path / f"{PACKAGE}.py").write_text("", "utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.invalidate_caches()
    yield PACKAGE
    sys.modules.pop(PACKAGE, None)


def test_a_package_is_absent_within_the_context_alone(package, monkeypatch):
    monkeypatch.setattr(own_process, "_own", True)
    with without(package), pytest.raises(ModuleNotFoundError, match=package):
        importlib.import_module(package)
    assert importlib.import_module(package).__name__ == package


def test_a_package_that_is_imported_stays(package, monkeypatch):
    importlib.import_module(package)
    monkeypatch.setattr(own_process, "_own", True)
    with without(package):
        assert importlib.import_module(package).__name__ == package


def test_a_program_that_uses_imuwb_keeps_its_packages(package, monkeypatch):
    monkeypatch.setattr(own_process, "_own", False)
    with without(package):
        assert importlib.import_module(package).__name__ == package


@pytest.mark.parametrize("given", [None, "3"])
def test_other_programs_get_the_threads_that_were_given(given, monkeypatch):
    monkeypatch.setenv(THREADS, "1")
    monkeypatch.setattr(own_process, "_given", given)
    expected = {name: value for name, value in os.environ.items() if name != THREADS}
    assert environment() == (expected if given is None else expected | {THREADS: given})
