import contextlib
import io
import subprocess
import sys
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.cli import main
from imuwb.simulation import preset, static
from imuwb.writers import write

HEADER = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"


@pytest.fixture
def imuwb(tmp_path, monkeypatch):
    """Run the command line in an empty folder, in this process; no terminal, no colours."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments, **environment):
        out, err, code = io.StringIO(), io.StringIO(), 0
        monkeypatch.setattr(sys, "argv", ["imuwb", *map(str, arguments)])
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        with warnings.catch_warnings(), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                main()
            except SystemExit as leaving:
                code = leaving.code or 0
        assert "internal error" not in err.getvalue(), err.getvalue()
        return SimpleNamespace(code=code, out=out.getvalue(), err=err.getvalue())

    return run


@pytest.fixture
def process(tmp_path):
    """Run the command line as a person's shell does."""

    def run(*arguments):
        command = [sys.executable, "-m", "imuwb", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", cwd=tmp_path, check=False)
        return SimpleNamespace(code=done.returncode, out=done.stdout, err=done.stderr)

    return run


@pytest.fixture(scope="session")
def static_log():
    return static(preset("3dm-gx3-25"), 60, 50, 1)


@pytest.fixture
def static_mcap(tmp_path, static_log):
    path = tmp_path / "static.mcap"
    write(static_log, path)
    return path


@pytest.fixture
def rows():
    """Return n lines of a plausible still IMU."""

    def make(n=400):
        rng = np.random.default_rng(0)
        values = rng.standard_normal((n, 6)) * 0.01 + [0, 0, 0, 0, 0, -9.8]
        return [f"{0.01 * i:.2f}," + ",".join(f"{v:.6f}" for v in row) for i, row in enumerate(values)]

    return make


@pytest.fixture
def csv_log(tmp_path):
    def make(lines, name="log.csv", header=HEADER):
        path = tmp_path / name
        path.write_text("\n".join([header, *lines, ""]), "utf-8")
        return path

    return make
