"""Drives, results and the command of the outage replay."""

import pytest

from imuwb.simulation import drive, mixed_route
from imuwb.writers import write
from imuwb_plugins import outage

from .made import sensor, stated


@pytest.fixture(scope="session")
def toml(tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "m.toml"
    path.write_text(sensor().to_toml(), "utf-8")
    return path


@pytest.fixture(scope="session")
def log():
    return drive(sensor(), mixed_route(240, 3), 1, rate=50.0)


@pytest.fixture(scope="session")
def mcap(log, tmp_path_factory):
    path = tmp_path_factory.mktemp("drive") / "drive.mcap"
    write(log, path)
    return path


@pytest.fixture(scope="session")
def few(log, toml):
    """Return seven outages of the paper's filters without AR, and those of a sweep."""
    at = ",".join(f"{t}:10" for t in range(130, 200, 10))
    return outage.run([log], stated(error_model=toml, models="none,15AV,18AV,18AVWD,full", at=at))


@pytest.fixture(scope="session")
def swept(log, toml):
    return outage.run([log], stated(error_model=toml, models="none,full", durations="5,10", settling=40.0))
