"""Compiled code is kept on disk, and used only while all modules in its folder are unchanged."""

import inspect
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import imuwb
from imuwb import kept_code, signatures
from imuwb.compiled import compiled, kernels
from imuwb.readers.bytes import loops

INNER = "from imuwb.compiled import compiled\n\n\n@compiled()\ndef inner(x):\n    return x + {}\n"
OUTER = "from imuwb.compiled import compiled\nfrom inner import inner\n\n\n@compiled()\ndef outer(x):\n    return inner(x)\n"
ASK = "import outer, inner; print(outer.outer(1), sum(outer.outer.stats.cache_hits.values()))"


def run_in(folder):
    """Return what a new process computes with the modules of a folder, and how often it used kept code."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "kept"), "PYTHONPATH": str(folder)}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    done = subprocess.run([sys.executable, "-c", ASK], capture_output=True, text=True, check=True, env=environment)
    return [int(word) for word in done.stdout.split()]


@pytest.mark.slow
def test_code_is_kept_until_what_it_calls_has_changed(tmp_path):
    (tmp_path / "inner.py").write_text(INNER.format(1))
    (tmp_path / "outer.py").write_text(OUTER)
    assert run_in(tmp_path) == [2, 0]
    assert run_in(tmp_path) == [2, 1]
    (tmp_path / "inner.py").write_text(INNER.format(5))
    assert run_in(tmp_path) == [6, 0]


@compiled()
def summed(values):
    total = 0.0
    for i in range(values.size):
        total += values[i]
    return total


@compiled(reorder=True)
def summed_in_any_order(values):
    total = 0.0
    for i in range(values.size):
        total += values[i]
    return total


def test_sums_are_reordered_only_where_that_is_allowed():
    values = np.random.default_rng(0).standard_normal(100_001)
    in_order = 0.0
    for value in values.tolist():
        in_order += value
    assert summed(values) == in_order
    assert summed_in_any_order(values) != in_order
    assert summed_in_any_order(values) == pytest.approx(in_order, rel=1e-9)


@compiled(reorder=True)
def inverse(x):
    return -1.0 if x != x else 1.0 / x  # noqa: PLR0124 - true of nan alone


def test_nan_and_infinity_are_numbers_in_any_order_of_sums():
    assert inverse(0.0) == np.inf
    assert inverse(np.nan) == -1.0


def test_other_threads_run_beside_compiled_code():
    assert summed.targetoptions["nogil"]


def test_a_function_that_makes_no_arrays_may_change_given_arrays():
    def doubled(values):
        for i in range(values.size):
            values[i] *= 2

    values = np.arange(5.0)
    compiled(arrays=False)(doubled)(values)
    assert values.tolist() == [0, 2, 4, 6, 8]


def third(x):
    return x / 3


def compiled_again():
    """Return the function with nothing of it in memory, its value, and how often kept code was used."""
    function = compiled()(third)
    return function(6.0), sum(function.stats.cache_hits.values())


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(kept_code.config, "CACHE_DIR", str(tmp_path))
    return tmp_path


def no_write(*_):
    raise OSError(30, "Read-only file system")


@pytest.mark.slow
def test_damaged_code_is_made_again(folder):
    assert [compiled_again() for _ in range(2)] == [(2.0, 0), (2.0, 1)]
    for kind in ("*.nbi", "*.nbc"):
        for damage in (lambda b: b[:-5], lambda b: b[:0], lambda b: b[:200] + bytes([b[200] ^ 1]) + b[201:]):
            (file,) = folder.rglob(kind)
            file.write_bytes(damage(file.read_bytes()))
            assert [compiled_again() for _ in range(2)] == [(2.0, 0), (2.0, 1)], kind


def test_code_is_read_where_nothing_can_be_written_and_without_it_there_is_a_warning(folder, monkeypatch):
    compiled_again()
    monkeypatch.setattr(kept_code.CheckedFile, "_write", no_write)
    monkeypatch.setattr(kept_code, "lost", [])
    assert compiled_again() == (2.0, 1)
    for file in folder.rglob("*.nb?"):
        file.unlink()
    with pytest.warns(UserWarning, match="Read-only file system.*half a minute; set NUMBA_CACHE_DIR to a folder"):
        assert compiled_again() == (2.0, 0)
    assert compiled_again() == (2.0, 0)  # once is enough


@pytest.mark.slow
def test_every_compiled_function_has_signatures_or_is_called_by_compiled_code_alone():
    listed = signatures.listed()
    home = Path(imuwb.__file__).parent
    for file in home.rglob("*.py"):
        if "\n@compiled" in file.read_text("utf-8"):
            import_module(".".join(("imuwb", *file.relative_to(home).with_suffix("").parts)))
    for function in loops.late.values():
        loops.compiled_loop(function)
    ours = {name for name in kernels if name.startswith("imuwb")}
    assert listed.keys() <= ours
    assert ours - listed.keys() <= {"imuwb.readers.flight.ulog_records:_chained"}
    for name, found in listed.items():
        for signature in found:
            assert len(signature) == len(inspect.signature(kernels[name].py_func).parameters), name
            assert [signatures.text_of(signatures.type_of(text)) for text in signature] == signature
