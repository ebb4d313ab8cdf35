from types import SimpleNamespace

import numpy as np
import pytest
from scipy import linalg

DT = 0.01


def generalised(covariance, constituents, time, values, frequency, difference=None):
    """Return the residual's quadratic form, and each line's reduction of it and a - ib, with C written out."""
    rows = linalg.solve_triangular(np.linalg.cholesky(covariance), np.eye(len(covariance)), lower=True)
    rows = rows if difference is None else rows @ difference
    known = np.linalg.qr(rows @ constituents)[0] if constituents.shape[1] else np.zeros((len(rows), 0))

    def rest(columns):
        for _ in range(2):
            columns = columns - known @ (known.T @ columns)
        return columns

    z = rest(rows @ values)
    reduction, amplitude = np.empty(frequency.size), np.empty(frequency.size, complex)
    for i, f in enumerate(frequency):
        phase = 2 * np.pi * f * time
        line = rest(rows @ np.column_stack([np.cos(phase), np.sin(phase)]))
        a, b = np.linalg.lstsq(line, z, rcond=None)[0]
        reduction[i], amplitude[i] = np.sum((line @ (a, b)) ** 2), a - 1j * b
    return float(z @ z), reduction, amplitude


@pytest.fixture(scope="session")
def direct():
    return generalised


@pytest.fixture(scope="session")
def stamps():
    """Return stamps of 200 or fewer samples, s: even, with gaps, uneven."""
    rng = np.random.default_rng(1)
    even = np.arange(200) * DT
    gaps = np.sort(rng.permutation(200)[:150]) * DT
    uneven = even + rng.uniform(-0.4, 0.4, 200) * DT
    return {"even": even, "gaps": gaps - gaps[0], "uneven": uneven - uneven[0]}


@pytest.fixture(scope="session")
def record():
    """Return a function that makes 80 s at 100 Hz: time, and lines (Hz, amplitude) in white noise of 1."""

    def make(*lines, seed=1, phase=0.5, n=8000):
        time = np.arange(n) * DT
        values = np.random.default_rng(seed).standard_normal(n)
        return SimpleNamespace(
            time=time, values=values + sum(a * np.cos(2 * np.pi * f * time + phase) for f, a in lines)
        )

    return make
