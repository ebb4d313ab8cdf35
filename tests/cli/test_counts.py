"""A log in counts of an unknown scale: no value of it is shown, judged or written with a unit."""

import numpy as np
import pytest

import imuwb
from imuwb.errors import UsageError
from imuwb.health.check import check
from imuwb.readers import ReadOptions
from imuwb.review.recording.overview import overview
from imuwb.writers import write

BOTH = "gyro=count,accel=count"


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    rng = np.random.default_rng(0)
    values = np.rint(rng.normal([33000, 32500, 32400, 33100, 33300, 36400], 20, (2000, 6)))
    file = tmp_path_factory.mktemp("counts") / "raw.csv"
    names = "time_s,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
    rows = np.column_stack([np.arange(2000) / 100, values])
    np.savetxt(file, rows, delimiter=",", fmt="%.6g", header=names, comments="")
    return file


class Charts:
    def __init__(self) -> None:
        self.shown = []
        self.series = self.shown.append

    def tab(self, name):
        pass

    def table(self, table):
        pass

    def note(self, note):
        pass


@pytest.mark.parametrize(("units", "counts"), [(BOTH, ("gyro", "accel")), ("gyro=count,accel=59400LSB/g", ("gyro",))])
def test_charts_and_health_name_no_unit(path, units, counts):
    log = imuwb.read(path, ReadOptions(units=units))
    assert log.imu().origin.counts == counts
    charts = Charts()
    overview([log], charts)
    shown = {s.names[0].split()[0]: s.unit for s in charts.shown}
    assert shown == {"gyro": "count", "accel": "count" if "accel" in counts else "m/s²"}
    found = check(log)
    assert [f.kind for f in found.faults] == ["counts"]
    assert check(log, samples=False).faults == ()


def test_what_needs_a_unit_refuses_counts(path, tmp_path):
    for analysis in ("noise", "psd"):
        with pytest.raises(UsageError, match="gyro and accel are in counts.*131LSB"):
            imuwb.run(analysis, path, units=BOTH)
    with pytest.raises(UsageError, match="in counts, and a new log needs"):
        write(imuwb.read(path, ReadOptions(units=BOTH)), tmp_path / "new.csv")
    assert not list(tmp_path.iterdir())


def test_a_calibration_of_counts_leads_to_units(path, tmp_path):
    axes = {
        f"{sensor}_{k}": imuwb.stochastic.AxisModel(bias=bias, scale_factor=gain)
        for sensor, bias, gain in (("gyro", 32600.0, 4700.0), ("accel", 33000.0, 400.0))
        for k in "xyz"
    }
    model = imuwb.ImuErrorModel("mine", axes, provenance={"calibration_unit": "count"})
    (tmp_path / "m.toml").write_text(model.to_toml(), "utf-8")
    found = imuwb.run("allan", path, units=BOTH, through=[f"correction:model={tmp_path / 'm.toml'}"])
    assert found.result.axes["gyro_x"].coefficients["N"].value == pytest.approx(20 / 4701 / 10, rel=0.1)


def test_counts_of_one_sensor_only_are_no_calibration(path):
    with pytest.raises(UsageError, match="some sensors"):
        imuwb.run("calibration multi-position", path, units="gyro=count,accel=59400LSB/g")
    with pytest.raises(UsageError, match="'count' is not a unit of time"):
        ReadOptions(units="time=count")
