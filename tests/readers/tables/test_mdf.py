"""MDF files through asammdf, and the sentence where it is not installed."""

import sys
from datetime import UTC, datetime

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import read
from imuwb.readers.tables import mdf

N, M = 300, 40
RNG = np.random.default_rng(8)
RATE, FORCE = RNG.normal(0, 0.1, (N, 3)), RNG.normal(0, 0.1, (N, 3)) - (0, 0, 9.8)
START = datetime(2024, 5, 1, 12, tzinfo=UTC)
STAMPS = np.arange(N) * 0.01


@pytest.fixture
def write(tmp_path):
    asammdf = pytest.importorskip("asammdf", reason="the extra imuwb[mdf] is not installed")

    def written(version="4.10", groups=None):
        log = asammdf.MDF(version=version)
        log.start_time = START

        def signal(samples, stamps, name, unit):
            return asammdf.Signal(samples, stamps, name=name, unit=unit)

        imu = [signal(np.degrees(RATE[:, i]), STAMPS, f"gyro_{a}", "deg/s") for i, a in enumerate("xyz")]
        imu += [signal(FORCE[:, i], STAMPS, f"acc_{a}", "m/s^2") for i, a in enumerate("xyz")]
        imu.append(signal(np.arange(N), STAMPS, "EngineSpeed", "rpm"))
        late = np.arange(M) * 0.1 + 0.05
        fixes = [("Latitude", 47.5, "deg"), ("Longitude", 8.5, "deg"), ("Altitude", 488.0, "m")]
        log.append(imu, acq_name="Chassis")
        log.append([signal(np.full(M, value), late, name, unit) for name, value, unit in fixes], acq_name="Receiver")
        path = tmp_path / "log.mf4"
        log.save(path, overwrite=True)
        log.close()
        return tmp_path / next(p.name for p in tmp_path.iterdir() if p.stem == "log")

    return written


@pytest.mark.slow  # asammdf is imported in a process of its own
def test_channels_of_groups(write):
    log = read(write())
    start = int(START.timestamp()) * 10**9
    (imu,) = log.imus
    assert (log.provenance.format, imu.name) == ("mdf", "Chassis")
    np.testing.assert_allclose(imu.angular_rate.value, RATE, rtol=1e-14)
    np.testing.assert_allclose(imu.specific_force.value, FORCE, rtol=1e-15)
    assert (imu.angular_rate.time == start + np.arange(N) * 10_000_000).all()
    assert imu.origin.epoch == "unix"
    np.testing.assert_allclose(log.gnss[0].position, [[np.radians(47.5), np.radians(8.5), 488]] * M, rtol=1e-15)
    assert (log.gnss[0].time == start + np.rint((np.arange(M) * 0.1 + 0.05) * 1e9).astype(np.int64)).all()
    assert any(note.id == "unused" and "EngineSpeed" in note for note in log.notes)


@pytest.mark.slow
def test_a_cut_file_is_refused(write):
    path = write()
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(UnreadableLogError, match=path.name):
        read(path)


def test_what_to_install(tmp_path, monkeypatch):
    path = tmp_path / "log.mf4"
    path.write_bytes(b"MDF     4.10    ".ljust(400, b"\0"))
    assert mdf.probe(path.read_bytes())
    monkeypatch.setitem(sys.modules, "asammdf", None)
    with pytest.raises(UnreadableLogError, match=r"imuwb\[mdf\]"):
        read(path)
