"""Compiled code is kept on disk, and used only while all modules in its folder are unchanged."""

import os
import subprocess
import sys

import numpy as np
import pytest

from imuwb.compiled import compiled

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
