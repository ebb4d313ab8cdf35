"""DataFlash logs that describe a record in several ways: each row is read by its own layout, in SI."""

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.readers import read
from tests.readers.flight import dataflash_writer as log

SWAPPED = log.Format(200, "IMU", "QBffffff", "TimeUS,I,AccX,AccY,AccZ,GyrX,GyrY,GyrZ")
OLD = log.Format(201, "IMU", "Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ")
MIXED_GPS = log.Format(202, "GPS", "BIHBcLLeeEefI", "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T")
LACKING = log.Format(203, "IMU", "QBff", "TimeUS,I,GyrX,AccZ")


@pytest.fixture(params=["binary", "text"])
def log_of(request, fresh):
    """Return a function that reads rows from a binary log, or from a text log."""

    def read_back(*rows):
        path = fresh("log.bin")
        path.write_bytes(log.binary(rows) if request.param == "binary" else log.text(rows))
        return read(path)

    return read_back


def swapped(i, instance=0):
    time = log.START + 40_000 * i
    return SWAPPED, (time, instance, *map(log.single, (0.1, 0.2, -9.8, i / 1000, 0.01, -0.02)))


@pytest.mark.parametrize("order", ["one then the other", "the other first", "in turn"])
def test_each_row_is_read_by_its_own_layout(log_of, order):
    second = {
        "one then the other": lambda i: i >= 20,
        "the other first": lambda i: i < 20,
        "in turn": lambda i: i % 2 == 0,
    }
    rows = [swapped(i) if second[order](i) else log.imu(i) for i in range(40)]
    found = log_of(*log.declared(log.IMU, SWAPPED), *rows)
    (imu,) = found.imus
    assert imu.angular_rate.time.tolist() == [(log.START + 40_000 * i) * 1000 for i in range(40)]
    np.testing.assert_allclose(imu.angular_rate.value[:, 0], np.arange(40) / 1000, rtol=1e-6)
    np.testing.assert_allclose(imu.specific_force.value[:, 2], -9.8, rtol=1e-6)
    assert len(imu.temperature) == 20
    assert imu.origin.repairs == ()
    assert "several_layouts" in ids(found.notes)


def test_layouts_with_and_without_an_instance_are_two_imus(log_of):
    rows = [(OLD, (5000 + 20 * i, i, 0, 0, 0, 0, -9.75)) for i in range(30)]
    found = log_of(*log.declared(log.IMU, OLD), *(log.imu(i) for i in range(30)), *rows)
    assert {imu.name: len(imu.angular_rate) for imu in found.imus} == {"IMU.0": 30, "IMU": 30}
    (old,) = (imu for imu in found.imus if imu.name == "IMU")
    assert old.angular_rate.time.tolist() == [(5000 + 20 * i) * 10**6 for i in range(30)]


def test_rows_whose_layout_lacks_an_axis_are_counted(log_of):
    rows = [(LACKING, (log.START + 40_000 * i, 0, 1.0, 2.0)) for i in range(30, 40)]
    found = log_of(*log.declared(log.IMU, LACKING), *(log.imu(i) for i in range(30)), *rows)
    assert len(found.imu().angular_rate) == 30
    assert [(r.what.id, r.count) for r in found.imu().origin.repairs] == [("impossible_value", 10)]


def test_old_and_new_fixes_are_on_one_clock(log_of):
    old = [
        (MIXED_GPS, (3, log.MILLISECONDS + 200 * i, log.WEEK, 9, 1.0, 47.3, 8.5, 0.0, 400.0, 5.0, 0.0, 0.0, 5000 + 200 * i))
        for i in range(10)
    ]  # fmt: skip
    found = log_of(*log.declared(log.GPS, MIXED_GPS), *old, *(log.fix(i) for i in range(10, 20)))
    assert {gnss.name: len(gnss) for gnss in found.gnss} == {"GPS": 10, "GPS.0": 10}
    first, second = sorted(found.gnss, key=lambda gnss: gnss.time[0])
    assert second.time[0] - first.time[-1] == 200_000_000
    assert first.origin.epoch == "unix"


def test_each_layout_has_its_own_units(dataflash_of):
    """The unit of a rate is deg/s in one layout, and rad/s in the other."""
    rows = [
        (log.FMTU, (0, log.IMU.number, "s#EEEooo-", "F-000000-")), (log.FMTU, (0, SWAPPED.number, "s#oooDDD", "F-000000")),
        (log.UNIT, (0, ord("E"), "rad/s")), (log.UNIT, (0, ord("D"), "deg/s")), (log.UNIT, (0, ord("o"), "m/s/s")),
        (log.UNIT, (0, ord("s"), "s")), (log.MULT, (0, ord("F"), 1.0)), (log.MULT, (0, ord("0"), 1.0)),
    ]  # fmt: skip
    samples = [swapped(i) if i % 2 else log.imu(i) for i in range(40)]
    found = dataflash_of([*log.declared(*log.ALL, SWAPPED), *rows, *samples])
    rate = found.imu().angular_rate.value[:, 0] / (np.arange(40) / 1000).clip(1e-9)
    np.testing.assert_allclose(rate[1::2], np.pi / 180, rtol=1e-6)
    np.testing.assert_allclose(rate[2::2], 1, rtol=1e-6)


def test_two_logs_of_different_firmware_in_one_file(dataflash_of):
    """Numbers have other records, and other units, in the second log; its clock restarts."""
    turned = log.Format(log.IMU.number, "IMU", SWAPPED.letters, SWAPPED.labels)
    units = [
        (log.FMTU, (0, log.IMU.number, "s#EEEooo-", "F-000000-")), (log.UNIT, (0, ord("E"), "rad/s")),
        (log.UNIT, (0, ord("D"), "deg/s")), (log.UNIT, (0, ord("o"), "m/s/s")), (log.MULT, (0, ord("0"), 1.0)),
    ]  # fmt: skip
    again = [(log.FMTU, (0, turned.number, "s#oooDDD", "F-000000"))]
    second = [(turned, values) for _, values in (swapped(i) for i in range(100))]
    found = dataflash_of([
        *log.declared(), *units, *(log.imu(i) for i in range(100)), *log.declared(turned), *again, *second,
    ])  # fmt: skip
    rate = found.imu().angular_rate.value[:, 0]
    np.testing.assert_allclose(rate[:100], np.arange(100) / 1000, rtol=1e-6)
    np.testing.assert_allclose(rate[100:], np.radians(np.arange(100) / 1000), rtol=1e-6)
    assert [r.what.id for r in found.imu().origin.repairs] == ["set_back"]


RAW = (
    log.Format(210, "ACC", "QBQfff", "TimeUS,I,SampleUS,AccX,AccY,AccZ"),
    log.Format(211, "GYR", "QBQfff", "TimeUS,I,SampleUS,GyrX,GyrY,GyrZ"),
)
NUMBERED = (
    log.Format(212, "ACC2", "QQfff", "TimeUS,SampleUS,AccX,AccY,AccZ"),
    log.Format(213, "GYR2", "QQfff", "TimeUS,SampleUS,GyrX,GyrY,GyrZ"),
)


@pytest.mark.parametrize(("kinds", "instance", "name"), [(RAW, (1,), "ACC.1+GYR.1"), (NUMBERED, (), "ACC2+GYR2")])
@pytest.mark.parametrize("stamped", [True, False])
def test_single_sensors_at_their_full_rate_are_an_imu(log_of, kinds, instance, name, stamped):
    rows = []
    for i in range(50):
        time = log.START + 1000 * i
        rows += [(kinds[0], (time + 300, *instance, time * stamped, 0.0, 0.5, -9.75))]
        rows += [(kinds[1], (time + 310, *instance, (time + 7) * stamped, i, 0.0, 0.25))]
    (imu,) = log_of(*log.declared(*kinds), *rows).imus
    assert imu.name == name
    late = (0, 7) if stamped else (300, 310)
    for triad, offset in zip((imu.specific_force, imu.angular_rate), late, strict=True):
        assert triad.time.tolist() == [(log.START + 1000 * i + offset) * 1000 for i in range(50)]
    assert imu.angular_rate.value[:, 0].tolist() == list(range(50))
    assert imu.specific_force.value[0].tolist() == [0, 0.5, -9.75]
