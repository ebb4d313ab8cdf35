import numpy as np
import pytest

from imuwb.cli import main
from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad


@pytest.fixture(scope="session")
def make_log():
    """Return a function that makes a log of given values, (n, 3) or one column for all axes; a boolean mask leaves gaps."""

    def triad(values, rate, keep):
        array = np.asarray(values, dtype=float)
        array = array if array.ndim > 1 else np.stack([array] * 3, axis=1)
        time = np.rint(np.arange(len(array)) * (SECOND / rate)).astype(np.int64)
        return Triad(time, array) if keep is None else Triad(time[keep], array[keep])

    def make(gyro=None, accel=None, rate=100.0, accel_rate=None, keep=None):
        imu = ImuStream(
            "/imu",
            None if gyro is None else triad(gyro, rate, keep),
            None if accel is None else triad(accel, accel_rate or rate, keep if accel_rate is None else None),
        )
        return Log(Provenance("made.csv", "csv", "sha256:0", 0), imus=(imu,))

    return make


@pytest.fixture(scope="session")
def gap():
    """Return a mask of n samples that lacks some."""

    def make(n, begin, end):
        keep = np.ones(n, bool)
        keep[begin:end] = False
        return keep

    return make


@pytest.fixture
def shown():
    """Return a review that remembers what it was shown."""

    class Shown:
        def __init__(self) -> None:
            self.tabs, self.figures, self.tables, self.notes = [], [], [], []

        def tab(self, name):
            self.tabs.append(name)

        def figure(self, figure):
            self.figures.append(figure)

        def table(self, table):
            self.tables.append(table)

        def note(self, text):
            self.notes.append(text)

        def series(self, series):
            pass

    return Shown()


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Run ``imuwb`` in an empty folder; return its exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")

    def run(*arguments):
        monkeypatch.setattr("sys.argv", ["imuwb", *map(str, arguments)])
        code = 0
        try:
            main()
        except SystemExit as leaving:
            code = leaving.code or 0
        return code, *capsys.readouterr()

    return run
