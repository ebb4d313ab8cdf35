"""ArduPilot's binary logs: IMUs, receivers, high-rate batches and the solution, in UTC."""

import math
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.readers import read
from tests.readers.flight import dataflash_writer as log
from tests.readers.flight.dataflash_writer import imus

MICRO, SECOND = 1000, 10**9
UTC_OF_FIRST_FIX = (datetime(1980, 1, 6, tzinfo=UTC) + timedelta(weeks=log.WEEK, seconds=100_000 - 18)).timestamp()


@pytest.fixture(scope="module")
def batches(shared):
    path = shared / "dataflash" / "mavparser_00000081.BIN"
    return read(path), log.heard(path)


@pytest.mark.slow
def test_three_imus_at_25_hz_and_a_receiver_at_5(batches):
    found, heard = batches
    for i in range(3):
        imu, rows = imus(found)[f"IMU.{i}"], [m for m in heard["IMU"] if i == m.I]
        assert len(rows) == 1255
        for triad, names in ((imu.angular_rate, "Gyr"), (imu.specific_force, "Acc")):
            np.testing.assert_array_equal(triad.value, [[getattr(m, names + axis) for axis in "XYZ"] for m in rows])
            assert (len(triad) - 1) / (np.ptp(triad.time) / SECOND) == pytest.approx(25, rel=0.01)
            np.testing.assert_array_equal(np.diff(triad.time), np.diff([m.TimeUS for m in rows]) * MICRO)
        np.testing.assert_array_equal(imu.temperature.value, [m.T for m in rows])
        assert 20 < imu.temperature.value.mean() < 70
    (gps,) = found.gnss
    assert gps.name == "GPS.0"
    assert (len(gps) - 1) / (np.ptp(gps.time) / SECOND) == pytest.approx(5, rel=0.01)


def test_fixes_and_their_accuracies_are_those_of_the_log(batches):
    found, heard = batches
    (gps,) = found.gnss
    rows = heard["GPS"]
    np.testing.assert_allclose(
        np.column_stack([np.degrees(gps.position[:, :2]), gps.position[:, 2]]),
        [[m.Lat, m.Lng, m.Alt] for m in rows], rtol=1e-12,
    )  # fmt: skip
    np.testing.assert_allclose(np.hypot(*gps.velocity[:, :2].T), [m.Spd for m in rows], atol=1e-6)
    np.testing.assert_array_equal(gps.velocity[:, 2], [m.VZ for m in rows])
    assert [m.TimeUS for m in heard["GPA"]] == [m.TimeUS for m in rows]
    accuracies = [[m.HAcc, m.HAcc, m.VAcc, m.SAcc, m.SAcc, m.SAcc] for m in heard["GPA"]]
    np.testing.assert_allclose(np.hstack([gps.position_sigma, gps.velocity_sigma]), accuracies, rtol=1e-12)


def test_fixes_are_at_the_utc_of_their_week_and_milliseconds(batches):
    found, heard = batches
    (gps,) = found.gnss
    zero = datetime(1980, 1, 6, tzinfo=UTC)
    utc = [(zero + timedelta(weeks=m.GWk, milliseconds=m.GMS - 18_000)).timestamp() for m in heard["GPS"]]
    assert np.abs(gps.time / SECOND - utc).max() < 0.1  # the receiver's delay varies
    assert abs(np.median(gps.time / SECOND - utc)) < 1e-3
    assert datetime.fromtimestamp(gps.time[0] / SECOND, UTC).isoformat()[:16] == "2025-01-13T13:22"


def test_high_rate_batches_are_raw_over_mul_on_the_sensors_clock(batches):
    found, heard = batches
    offset = found.gnss[0].time[0] - heard["GPS"][0].TimeUS * MICRO
    wanted, lost = {}, 0
    data_of = {}
    for one in heard["ISBD"]:
        data_of.setdefault(one.N, []).append(one)
    for head in heard["ISBH"]:
        data = sorted(data_of.get(head.N, []), key=lambda m: m.seqno)
        if len(data) * 32 != head.smp_cnt:
            lost += 1
            continue
        values = np.concatenate([np.array([m.x, m.y, m.z], float).T for m in data]) / head.mul
        times = head.SampleUS * MICRO + offset + np.arange(len(values)) * (SECOND / head.smp_rate)
        wanted.setdefault((head.instance, head.type), []).append((times, values))
    for (instance, kind), pieces in wanted.items():
        imu = imus(found)[f"ISB.{instance}"]
        triad = imu.specific_force if kind == 0 else imu.angular_rate
        np.testing.assert_array_equal(triad.value, np.concatenate([values for _, values in pieces]))
        np.testing.assert_allclose(triad.time - offset, np.concatenate([t for t, _ in pieces]) - offset, atol=300)
        if kind == 0:
            assert np.linalg.norm(triad.value.mean(axis=0)) == pytest.approx(8.8, abs=1)
    assert {f"ISB.{instance}" for instance, _ in wanted} == {name for name in imus(found) if name.startswith("ISB")}
    assert lost == 1
    assert any(note.id == "cut_batch" and note.startswith("1 ") for note in found.notes)


@pytest.mark.slow
def test_a_log_without_a_fix_counts_from_power_up(shared):
    found = read(shared / "dataflash" / "ardusub_small.BIN")
    first = log.heard(shared / "dataflash" / "ardusub_small.BIN")["IMU"][0]
    assert found.imu().angular_rate.time[0] == first.TimeUS * MICRO
    assert found.imu().origin.epoch == "boot"
    assert "no_date" in ids(found.notes)


def test_an_older_log_names_its_second_imu_imu2(shared):
    path = shared / "dataflash" / "pymavlink_test.BIN"
    found, heard = read(path), log.heard(path)
    assert [imu.name for imu in found.imus] == ["IMU", "IMU2"]
    for imu in found.imus:
        np.testing.assert_array_equal(imu.angular_rate.value[:, 1], [m.GyrY for m in heard[imu.name]])
    (reference,) = found.references
    angles = np.degrees(reference.attitude) % 360
    told = np.array([[m.Roll % 360, m.Pitch % 360, m.Yaw] for m in heard["ATT"]])
    at = (np.array([m.TimeUS for m in heard["ATT"]]) - heard["POS"][0].TimeUS) * MICRO + reference.time[0]
    behind = np.searchsorted(at, reference.time).clip(1, len(at) - 1)
    ahead = np.minimum(np.abs(angles - told[behind]), np.abs(angles - told[behind - 1]))
    assert np.minimum(ahead, 360 - ahead).max() < 1


def test_every_stream_of_a_flight_is_read(dataflash_of):
    found = dataflash_of(log.flight())
    assert [imu.name for imu in found.imus] == ["IMU.0", "IMU.1"]
    assert [len(imu.angular_rate) for imu in found.imus] == [50, 50]
    assert [(gnss.name, len(gnss)) for gnss in found.gnss] == [("GPS.0", 10)]
    assert [(reference.name, len(reference)) for reference in found.references] == [("POS", 25)]
    assert ids(found.notes) == ("utc_by_receiver",)
    assert found.gnss[0].time[0] == round(UTC_OF_FIRST_FIX) * SECOND
    assert found.imus[0].angular_rate.time[0] == found.gnss[0].time[0]
    assert found.imus[0].temperature.value[10] == pytest.approx(31)


def test_instances_are_kept_apart(dataflash_of):
    rows = [log.imu(i, k, log.START + 1000 * i + k, (k, 0, 0)) for i in range(20) for k in (0, 1, 5)]
    found = dataflash_of([*log.declared(), *rows])
    assert {name: imu.angular_rate.value[:, 0].tolist() for name, imu in imus(found).items()} == {
        f"IMU.{k}": [k] * 20 for k in (0, 1, 5)
    }


def test_receivers_and_their_accuracies_are_kept_apart(dataflash_of):
    rows = [log.fix(i, k, Alt=100.0 * k, TimeUS=log.START + 200_000 * i) for i in range(5) for k in (0, 1)]
    rows += [(log.GPA, (log.START + 200_000 * i, k, 1, 1.0 + k, 2.0 + k, 3.0 + k)) for i in range(5) for k in (0, 1)]
    found = dataflash_of([*log.declared(), *rows])
    assert [(gnss.name, gnss.position[0, 2]) for gnss in found.gnss] == [("GPS.0", 0), ("GPS.1", 100)]
    assert [gnss.position_sigma[:, [0, 2]].tolist() for gnss in found.gnss] == [[[1.0, 2.0]] * 5, [[2.0, 3.0]] * 5]
    assert found.gnss[1].velocity_sigma.tolist() == [[4.0] * 3] * 5


def test_a_fix_without_an_accuracy_near_has_none(dataflash_of):
    rows = [log.fix(i) for i in range(10)]
    rows += [(log.GPA, (log.START + 100_000, 0, 1, 1.5, 2.5, 0.0))]
    (gnss,) = dataflash_of([*log.declared(), *rows]).gnss
    np.testing.assert_array_equal(gnss.position_sigma[:, 0], [1.5] * 3 + [np.nan] * 7)  # nearer than half a second
    np.testing.assert_array_equal(gnss.position_sigma[:, 2], [2.5] * 3 + [np.nan] * 7)
    assert gnss.velocity_sigma is None  # an accuracy of 0 is none


@pytest.mark.parametrize("available", [0, 1])
def test_a_vertical_velocity_that_is_not_available_is_unknown(dataflash_of, available):
    kind = log.Format(133, "GPA", "QBCCCCfBIH", "TimeUS,I,VDop,HAcc,VAcc,SAcc,YAcc,VV,SMS,Delta")
    formats = [kind if f is log.GPA else f for f in log.ALL]
    accuracies = [(kind, (log.START + 200_000 * i, 0, 1, 1.5, 2.5, 0.5, 0.0, available, 0, 200)) for i in range(5)]
    (gnss,) = dataflash_of([*log.declared(*formats), *(log.fix(i) for i in range(5)), *accuracies]).gnss
    assert np.isfinite(gnss.velocity[:, :2]).all()
    np.testing.assert_array_equal(gnss.velocity[:, 2], [-0.5 if available else np.nan] * 5)


def test_speed_and_course_are_a_velocity(dataflash_of):
    (gnss,) = dataflash_of(
        [*log.declared(), log.fix(0, Spd=2.0, GCrs=30.0, VZ=-0.5), log.fix(1, Spd=1.0, GCrs=270.0)]
    ).gnss
    np.testing.assert_allclose(gnss.velocity, [[math.sqrt(3), 1, -0.5], [0, -1, -0.5]], atol=1e-7)


def test_rows_without_a_fix_are_counted(dataflash_of):
    rows = [log.fix(i, Lat=0.0, Lng=0.0, Status=1, GWk=0) for i in range(4)] + [log.fix(i) for i in range(4, 10)]
    found = dataflash_of([*log.declared(), *rows])
    assert len(found.gnss[0]) == 6
    ((repair),) = found.gnss[0].origin.repairs
    assert (repair.what.id, repair.count) == ("no_position", 4)
    assert found.gnss[0].time[0] == round(UTC_OF_FIRST_FIX * 1e3 + 800) * 10**6


def test_a_receiver_that_never_had_a_fix_is_noted(dataflash_of):
    found = dataflash_of([*log.declared(), *(log.fix(i, Lat=0.0, Lng=0.0, Status=1) for i in range(4)), log.imu(0)])
    assert found.gnss == ()
    assert "no_position" in ids(found.notes)
    assert "no_date" in ids(found.notes)


def test_the_reference_has_the_velocity_of_the_first_core_and_the_attitude(dataflash_of):
    (reference,) = dataflash_of(log.flight()).references
    inside = slice(1, -1)
    # POS comes 10 µs behind XKF1, whose velocity grows by 2 m/s in 80 ms.
    north = 1 + np.arange(0, 50, 2) + 2 * 10 / 80_000
    np.testing.assert_allclose(reference.velocity[inside, 0], north[inside], rtol=1e-9)
    np.testing.assert_allclose(reference.velocity[:, 1:], [[2, -3]] * 25)
    np.testing.assert_allclose(np.degrees(reference.attitude[:, :2]), [[1.5, -2.5]] * 25)
    np.testing.assert_allclose(np.degrees(reference.position[:, 0]), log.LATITUDE + np.arange(0, 50, 2) * 1e-6)


def test_heading_goes_through_north_without_a_turn(dataflash_of):
    (reference,) = dataflash_of(log.flight()).references
    told = np.radians(350.0 + np.arange(0, 50, 2) + 2 * 5 / 80_000)
    apart = (reference.attitude[:, 2] - told + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(apart[:-1]).max() < 1e-9


@pytest.mark.parametrize(
    ("label", "multiplier", "factor"), [("deg/s", 1.0, math.pi / 180), ("rad/s", 1e-3, 1e-3), ("rad/s", 1.0, 1.0)]
)
def test_units_stated_otherwise_are_converted(dataflash_of, label, multiplier, factor):
    rows = [
        (log.FMTU, (0, log.IMU.number, "s#EEEooo-", "F-FFF000-")),
        (log.UNIT, (0, ord("E"), label)), (log.UNIT, (0, ord("o"), "m/s/s")), (log.UNIT, (0, ord("s"), "s")),
        (log.MULT, (0, ord("F"), multiplier)), (log.MULT, (0, ord("0"), 1.0)), (log.MULT, (0, ord("-"), 0.0)),
    ]  # fmt: skip
    rate = (10.0, 20.0, -30.0)
    found = dataflash_of([*log.declared(), *rows, *(log.imu(i, rate=rate) for i in range(5))])
    np.testing.assert_allclose(found.imu().angular_rate.value, [[x * factor for x in rate]] * 5, rtol=1e-6)
    np.testing.assert_allclose(found.imu().specific_force.value[:, 2], -9.8, rtol=1e-6)


def test_units_of_fields_that_scale_themselves_count_once(dataflash_of):
    rows = [
        (log.FMTU, (0, log.GPS.number, "s#-s-S-DUmnhn-", "F--C-0BGGB000-")), (log.UNIT, (0, ord("D"), "deglatitude")),
        (log.MULT, (0, ord("G"), 1e-7)), (log.MULT, (0, ord("B"), 1e-2)), (log.MULT, (0, ord("F"), 1e-6)),
    ]  # fmt: skip
    (gnss,) = dataflash_of([*log.declared(), *rows, log.fix(0), log.fix(1)]).gnss
    np.testing.assert_allclose(np.degrees(gnss.position[0, :2]), [log.LATITUDE, log.LONGITUDE])
    assert gnss.position[0, 2] == pytest.approx(400)


OLD = [
    log.Format(131, "IMU", "Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ"),
    log.Format(143, "IMU2", "Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ"),
    log.Format(144, "IMU3", "Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ"),
]
OLD_GPS = log.Format(
    132, "GPS", "BIHBcLLeeEefI", "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T"
)  # fmt: skip


def test_older_imus_in_milliseconds_are_read(dataflash_of):
    rows = [(kind, (5000 + 20 * i, k, 0, 0, 0, 0, -9.75)) for i in range(10) for k, kind in enumerate(OLD)]
    found = dataflash_of([*log.declared(*OLD), *rows])
    assert [imu.name for imu in found.imus] == ["IMU", "IMU2", "IMU3"]
    for k, imu in enumerate(found.imus):
        assert imu.angular_rate.time.tolist() == [(5000 + 20 * i) * 10**6 for i in range(10)]
        assert imu.angular_rate.value[:, 0].tolist() == [k] * 10
        assert imu.specific_force.value[0].tolist() == [0, 0, -9.75]
        assert imu.temperature is None


def test_receivers_without_an_instance_have_their_records_name(dataflash_of):
    letters, labels = log.GPS.letters.replace("QB", "Q", 1), log.GPS.labels.replace("I,", "", 1)
    kinds = [log.Format(132, "GPS", letters, labels), log.Format(145, "GPS2", letters, labels)]
    rows = [(kind, values[:1] + values[2:]) for i in range(4) for kind in kinds for _, values in (log.fix(i),)]
    found = dataflash_of([*log.declared(*kinds), *rows])
    assert [(gnss.name, len(gnss)) for gnss in found.gnss] == [("GPS", 4), ("GPS2", 4)]


def test_an_older_receivers_boot_clock_is_t_and_its_week_tells_the_date(dataflash_of):
    rows = [(OLD[0], (5000 + 20 * i, 0, 0, 0, 0, 0, -9.75)) for i in range(50)]
    rows += [(OLD_GPS, (3, 100_000_000 + 200 * i, 1800, 9, 1.0, 47.3, 8.5, 0.0, 400.0, 5.0, 0.0, 0.0, 5000 + 200 * i))
             for i in range(5)]  # fmt: skip
    found = dataflash_of([*log.declared(*OLD, OLD_GPS), *rows])
    zero = datetime(1980, 1, 6, tzinfo=UTC) + timedelta(weeks=1800, seconds=100_000 - 16)  # July 2014: 16 s
    assert found.gnss[0].origin.epoch == "unix"
    assert found.gnss[0].time[0] == round(zero.timestamp()) * SECOND
    assert found.imu().angular_rate.time[0] == found.gnss[0].time[0]
