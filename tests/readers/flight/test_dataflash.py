"""ArduPilot's binary logs: every IMU, receiver, high-rate batch and the solution, in UTC, whatever is damaged."""

import itertools
import math
import time
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import read, reader_of
from imuwb.readers.bytes import source
from tests.readers.flight import dataflash_writer as log

MICRO, SECOND = 1000, 10**9
UTC_OF_FIRST_FIX = (datetime(1980, 1, 6, tzinfo=UTC) + timedelta(weeks=log.WEEK, seconds=100_000 - 18)).timestamp()


@pytest.fixture(scope="module")
def written(fresh):
    """Return a function that reads a log of some rows, or of bytes."""

    def read_back(rows):
        path = fresh("log.bin")
        path.write_bytes(rows if isinstance(rows, bytes) else log.binary(rows))
        return read(path)

    return read_back


@pytest.fixture(scope="module")
def batches(shared):
    path = shared / "dataflash" / "mavparser_00000081.BIN"
    return read(path), log.heard(path)


def imus(found):
    return {imu.name: imu for imu in found.imus}


def assert_same(one, other, rtol=0.0):
    """Compare all streams of two logs."""
    assert [imu.name for imu in one.imus] == [imu.name for imu in other.imus]
    triads = [(a.axes(), b.axes()) for a, b in zip(one.imus, other.imus, strict=True)]
    for a, b in triads:
        assert a.keys() == b.keys()
        for name in a:
            np.testing.assert_array_equal(a[name][0], b[name][0])
            np.testing.assert_allclose(a[name][1], b[name][1], rtol=rtol)
    for a, b in zip(one.imus, other.imus, strict=True):
        np.testing.assert_allclose(a.temperature.value, b.temperature.value, rtol=rtol)
    for kind, columns in (
        ("gnss", ("time", "position", "velocity", "position_sigma", "velocity_sigma", "fix_type")),
        ("references", ("time", "position", "velocity", "attitude")),
    ):
        assert [x.name for x in getattr(one, kind)] == [x.name for x in getattr(other, kind)]
        for a, b in zip(getattr(one, kind), getattr(other, kind), strict=True):
            for column in columns:
                if getattr(a, column) is None or column == "time":
                    np.testing.assert_array_equal(getattr(a, column), getattr(b, column))
                else:
                    np.testing.assert_allclose(getattr(a, column), getattr(b, column), rtol=rtol)


# Real logs


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


# Logs of our own


def test_every_stream_of_a_flight_is_read(written):
    found = written(log.flight())
    assert [imu.name for imu in found.imus] == ["IMU.0", "IMU.1"]
    assert [len(imu.angular_rate) for imu in found.imus] == [50, 50]
    assert [(gnss.name, len(gnss)) for gnss in found.gnss] == [("GPS.0", 10)]
    assert [(reference.name, len(reference)) for reference in found.references] == [("POS", 25)]
    assert ids(found.notes) == ("utc_by_receiver",)
    assert found.gnss[0].time[0] == round(UTC_OF_FIRST_FIX) * SECOND
    assert found.imus[0].angular_rate.time[0] == found.gnss[0].time[0]
    assert found.imus[0].temperature.value[10] == pytest.approx(31)


def test_instances_are_kept_apart(written):
    rows = [log.imu(i, k, log.START + 1000 * i + k, (k, 0, 0)) for i in range(20) for k in (0, 1, 5)]
    found = written([*log.declared(), *rows])
    assert {name: imu.angular_rate.value[:, 0].tolist() for name, imu in imus(found).items()} == {
        f"IMU.{k}": [k] * 20 for k in (0, 1, 5)
    }


def test_receivers_and_their_accuracies_are_kept_apart(written):
    rows = [log.fix(i, k, Alt=100.0 * k, TimeUS=log.START + 200_000 * i) for i in range(5) for k in (0, 1)]
    rows += [(log.GPA, (log.START + 200_000 * i, k, 1, 1.0 + k, 2.0 + k, 3.0 + k)) for i in range(5) for k in (0, 1)]
    found = written([*log.declared(), *rows])
    assert [(gnss.name, gnss.position[0, 2]) for gnss in found.gnss] == [("GPS.0", 0), ("GPS.1", 100)]
    assert [gnss.position_sigma[:, [0, 2]].tolist() for gnss in found.gnss] == [[[1.0, 2.0]] * 5, [[2.0, 3.0]] * 5]
    assert found.gnss[1].velocity_sigma.tolist() == [[4.0] * 3] * 5


def test_a_fix_without_an_accuracy_near_has_none(written):
    rows = [log.fix(i) for i in range(10)]
    rows += [(log.GPA, (log.START + 100_000, 0, 1, 1.5, 2.5, 0.0))]
    (gnss,) = written([*log.declared(), *rows]).gnss
    np.testing.assert_array_equal(gnss.position_sigma[:, 0], [1.5] * 3 + [np.nan] * 7)  # nearer than half a second
    np.testing.assert_array_equal(gnss.position_sigma[:, 2], [2.5] * 3 + [np.nan] * 7)
    assert gnss.velocity_sigma is None  # an accuracy of 0 is none


def test_speed_and_course_are_a_velocity(written):
    (gnss,) = written([*log.declared(), log.fix(0, Spd=2.0, GCrs=30.0, VZ=-0.5), log.fix(1, Spd=1.0, GCrs=270.0)]).gnss
    np.testing.assert_allclose(gnss.velocity, [[math.sqrt(3), 1, -0.5], [0, -1, -0.5]], atol=1e-7)


def test_rows_without_a_fix_are_counted(written):
    rows = [log.fix(i, Lat=0.0, Lng=0.0, Status=1, GWk=0) for i in range(4)] + [log.fix(i) for i in range(4, 10)]
    found = written([*log.declared(), *rows])
    assert len(found.gnss[0]) == 6
    ((repair),) = found.gnss[0].origin.repairs
    assert (repair.what.id, repair.count) == ("no_position", 4)
    assert found.gnss[0].time[0] == round(UTC_OF_FIRST_FIX * 1e3 + 800) * 10**6


def test_a_receiver_that_never_had_a_fix_is_noted(written):
    found = written([*log.declared(), *(log.fix(i, Lat=0.0, Lng=0.0, Status=1) for i in range(4)), log.imu(0)])
    assert found.gnss == ()
    assert "no_position" in ids(found.notes)
    assert "no_date" in ids(found.notes)


def test_the_reference_has_the_velocity_of_the_first_core_and_the_attitude(written):
    (reference,) = written(log.flight()).references
    inside = slice(1, -1)
    # POS comes 10 µs behind XKF1, whose velocity grows by 2 m/s in 80 ms.
    north = 1 + np.arange(0, 50, 2) + 2 * 10 / 80_000
    np.testing.assert_allclose(reference.velocity[inside, 0], north[inside], rtol=1e-9)
    np.testing.assert_allclose(reference.velocity[:, 1:], [[2, -3]] * 25)
    np.testing.assert_allclose(np.degrees(reference.attitude[:, :2]), [[1.5, -2.5]] * 25)
    np.testing.assert_allclose(np.degrees(reference.position[:, 0]), log.LATITUDE + np.arange(0, 50, 2) * 1e-6)


def test_heading_goes_through_north_without_a_turn(written):
    (reference,) = written(log.flight()).references
    told = np.radians(350.0 + np.arange(0, 50, 2) + 2 * 5 / 80_000)
    apart = (reference.attitude[:, 2] - told + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(apart[:-1]).max() < 1e-9


@pytest.mark.parametrize(
    ("label", "multiplier", "factor"), [("deg/s", 1.0, math.pi / 180), ("rad/s", 1e-3, 1e-3), ("rad/s", 1.0, 1.0)]
)
def test_units_stated_otherwise_are_converted(written, label, multiplier, factor):
    rows = [
        (log.FMTU, (0, log.IMU.number, "s#EEEooo-", "F-FFF000-")),
        (log.UNIT, (0, ord("E"), label)), (log.UNIT, (0, ord("o"), "m/s/s")), (log.UNIT, (0, ord("s"), "s")),
        (log.MULT, (0, ord("F"), multiplier)), (log.MULT, (0, ord("0"), 1.0)), (log.MULT, (0, ord("-"), 0.0)),
    ]  # fmt: skip
    rate = (10.0, 20.0, -30.0)
    found = written([*log.declared(), *rows, *(log.imu(i, rate=rate) for i in range(5))])
    np.testing.assert_allclose(found.imu().angular_rate.value, [[x * factor for x in rate]] * 5, rtol=1e-6)
    np.testing.assert_allclose(found.imu().specific_force.value[:, 2], -9.8, rtol=1e-6)


def test_units_of_fields_that_scale_themselves_count_once(written):
    rows = [
        (log.FMTU, (0, log.GPS.number, "s#-s-S-DUmnhn-", "F--C-0BGGB000-")), (log.UNIT, (0, ord("D"), "deglatitude")),
        (log.MULT, (0, ord("G"), 1e-7)), (log.MULT, (0, ord("B"), 1e-2)), (log.MULT, (0, ord("F"), 1e-6)),
    ]  # fmt: skip
    (gnss,) = written([*log.declared(), *rows, log.fix(0), log.fix(1)]).gnss
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


def test_older_imus_in_milliseconds_are_read(written):
    rows = [(kind, (5000 + 20 * i, k, 0, 0, 0, 0, -9.75)) for i in range(10) for k, kind in enumerate(OLD)]
    found = written([*log.declared(*OLD), *rows])
    assert [imu.name for imu in found.imus] == ["IMU", "IMU2", "IMU3"]
    for k, imu in enumerate(found.imus):
        assert imu.angular_rate.time.tolist() == [(5000 + 20 * i) * 10**6 for i in range(10)]
        assert imu.angular_rate.value[:, 0].tolist() == [k] * 10
        assert imu.specific_force.value[0].tolist() == [0, 0, -9.75]
        assert imu.temperature is None


def test_receivers_without_an_instance_have_their_records_name(written):
    letters, labels = log.GPS.letters.replace("QB", "Q", 1), log.GPS.labels.replace("I,", "", 1)
    kinds = [log.Format(132, "GPS", letters, labels), log.Format(145, "GPS2", letters, labels)]
    rows = [(kind, values[:1] + values[2:]) for i in range(4) for kind in kinds for _, values in (log.fix(i),)]
    found = written([*log.declared(*kinds), *rows])
    assert [(gnss.name, len(gnss)) for gnss in found.gnss] == [("GPS", 4), ("GPS2", 4)]


def test_an_older_receivers_boot_clock_is_t_and_its_week_tells_the_date(written):
    rows = [(OLD[0], (5000 + 20 * i, 0, 0, 0, 0, 0, -9.75)) for i in range(50)]
    rows += [(OLD_GPS, (3, 100_000_000 + 200 * i, 1800, 9, 1.0, 47.3, 8.5, 0.0, 400.0, 5.0, 0.0, 0.0, 5000 + 200 * i))
             for i in range(5)]  # fmt: skip
    found = written([*log.declared(*OLD, OLD_GPS), *rows])
    zero = datetime(1980, 1, 6, tzinfo=UTC) + timedelta(weeks=1800, seconds=100_000 - 16)  # July 2014: 16 s
    assert found.gnss[0].origin.epoch == "unix"
    assert found.gnss[0].time[0] == round(zero.timestamp()) * SECOND
    assert found.imu().angular_rate.time[0] == found.gnss[0].time[0]


# Damage


def test_values_that_no_sensor_puts_out_are_left_out_and_counted(written):
    rows = [log.imu(i) for i in range(20)]
    rows[7], rows[9] = log.imu(7, rate=(1e35, 0, 0)), log.imu(9, rate=(0, 201.0, 0))
    found = written([*log.declared(), *rows])
    assert len(found.imu().angular_rate) == 18
    assert np.abs(found.imu().angular_rate.value).max() < 1
    assert [r.count for r in found.imu().origin.repairs] == [2]


def test_impossible_temperatures_speeds_and_heights_do_not_come_out(written):
    rows = [log.imu(i) for i in range(20)]
    rows[7] = (log.IMU, (*rows[7][1][:-1], 1e35))
    rows += [log.fix(i, **({"Spd": 1e35} if i == 2 else {})) for i in range(5)]
    rows += [(log.POS, (log.START + i, 47.3, 8.5, 1e35 if i == 2 else 400.0, 0.0, 0.0)) for i in range(5)]
    found = written([*log.declared(), *rows])
    assert np.abs(found.imu().temperature.value).max() < 1000
    assert np.nanmax(np.abs(found.gnss[0].velocity)) < 1e5
    assert np.abs(found.references[0].position).max() < 1e6


def test_an_attitude_that_is_no_number_costs_its_own_rows_only(written):
    kind = log.Format(136, "ATT", "Qfff", "TimeUS,Roll,Pitch,Yaw")
    rows = [(kind, (log.START + 1000 * i, 0.0, 0.0, math.nan if i == 5 else 10.0)) for i in range(50)]
    rows += [(log.POS, (log.START + 1000 * i, 47.3, 8.5, 400.0, 0.0, 0.0)) for i in range(50)]
    found = written([*log.declared(kind, log.POS), *rows])
    assert len(found.references[0]) >= 47


@pytest.mark.parametrize("size", [1, 500, 5000])
def test_a_damaged_block_in_a_flight_is_counted_and_nothing_of_it_comes_out(written, size):
    whole, rows = written(log.flight()), log.flight()
    half = len(rows) // 2
    before, behind = log.binary(rows[:half]), log.binary(rows[half:])
    found = written(before + np.random.default_rng(7).bytes(size) + behind)
    for imu, sound in zip(found.imus, whole.imus, strict=True):
        assert len(sound.angular_rate) - len(imu.angular_rate) <= 1
        assert set(imu.angular_rate.time.tolist()) <= set(sound.angular_rate.time.tolist())
        assert set(imu.angular_rate.value[:, 0]) <= set(sound.angular_rate.value[:, 0])
    assert len(whole.gnss[0]) - len(found.gnss[0]) <= 1
    (note,) = (note for note in found.notes if note.id == "no_record")
    assert size <= int(note.split()[0]) <= size + rows[half - 1][0].size


def test_cut_anywhere_the_whole_prefix_is_used(written):
    rows = log.flight(20)
    data, ends = log.binary(rows), list(itertools.accumulate(kind.size for kind, _ in rows))
    for cut in np.random.default_rng(5).integers(len(log.binary(log.declared())), len(data), 40):
        wanted = [row for row, end in zip(rows, ends, strict=True) if end <= cut and row[0] is log.IMU]
        found = written(data[:cut])
        assert sum(len(imu.angular_rate) for imu in found.imus) == len(wanted)
        rest = cut - max(end for end in ends if end <= cut)
        assert [note.split()[0] for note in found.notes if note.id == "no_record"] == [str(rest)] * bool(rest)


@pytest.mark.parametrize("block", [64, 1000, 4096])
@pytest.mark.parametrize("kind", ["bytes", "damaged"])
def test_small_blocks_give_the_same_log(written, monkeypatch, block, kind):
    data = log.binary(log.flight())
    if kind == "damaged":
        data = data[:3000] + b"\xa3\x95\x83" * 50 + data[3000:]
    whole = written(data)
    monkeypatch.setattr(source, "BLOCK", block)
    monkeypatch.setattr(source, "PIECE", 64)
    parts = written(data)
    assert_same(parts, whole)
    assert parts.notes == whole.notes


def test_a_format_on_the_edge_of_a_block_is_found(written, monkeypatch):
    monkeypatch.setattr(source, "BLOCK", 1000)
    monkeypatch.setattr(source, "PIECE", 1000)
    rows = [log.imu(i) for i in range(50)]
    head = log.binary(log.declared(log.GPS))
    filler = log.binary([log.fix(i) for i in range(20)])
    filler = filler[: (1000 - len(head) - 40) // log.GPS.size * log.GPS.size]
    data = head + filler
    assert len(data) < 1000 < len(data) + 89
    found = written(data + log.binary([*log.declared(log.IMU)[1:], *rows]))
    assert len(found.imu().angular_rate) == 50


@pytest.mark.parametrize("lacks", ["seqno", "x", "smp_cnt", "Id", "Label", "Mult", "FmtType", "UnitIds"])
def test_a_format_that_lacks_a_field_does_not_stop_the_reading(written, lacks):
    kinds = [
        log.Format(f.number, f.name, f.letters, ",".join("other" if x == lacks else x for x in f.labels.split(",")))
        for f in log.ALL
    ]
    batch = [
        (log.ISBH, (0, 1, 1, 0, 100, 32, log.START, 1000.0)), (log.ISBD, (0, 1, 0, [1] * 32, [2] * 32, [3] * 32)),
        (log.FMTU, (0, log.IMU.number, "s#EEEooo-", "F-FFF000-")), (log.UNIT, (0, ord("E"), "rad/s")),
        (log.MULT, (0, ord("F"), 1.0)),
    ]  # fmt: skip
    found = written([*log.declared(*kinds), *batch, *(log.imu(i) for i in range(5))])
    assert len(imus(found)["IMU.0"].angular_rate) == 5


@pytest.mark.parametrize("kind", [log.IMU, log.GPS, log.POS, log.XKF1], ids=lambda kind: kind.name)
def test_an_array_in_place_of_a_number_does_not_stop_the_reading(written, kind):
    # One bit makes n, four bytes, of f, a number of as many.
    rows = [
        (k, (*v[:3], v[3].replace("f", "n"), v[4]) if k is log.FMT and v[0] == kind.number else v)
        for k, v in log.flight()
    ]
    assert written(rows).notes


def test_an_imu_without_an_axis_is_noted(written):
    kind = log.Format(131, "IMU", "Qfffff", "TimeUS,GyrX,GyrY,AccX,AccY,AccZ")
    found = written([*log.declared(kind, log.GPS), (kind, (1, 0, 0, 0, 0, 0)), log.fix(0), log.fix(1)])
    assert found.imus == ()
    assert "missing_axis" in ids(found.notes)


def test_a_batch_that_is_whole_is_read_in_the_order_of_its_numbers(written):
    data = [(log.ISBD, (0, 7, k, [32 * k + j for j in range(32)], [0] * 32, [-5] * 32)) for k in (1, 0)]
    head = (log.ISBH, (0, 7, 1, 2, 100, 64, 3_000_000, 1000.0))
    (imu,) = written([*log.declared(), head, *data, (log.MSG, (0, "x"))]).imus
    assert imu.name == "ISB.2"
    assert imu.specific_force is None
    assert imu.angular_rate.value[:, 0].tolist() == [i / 100 for i in range(64)]
    assert imu.angular_rate.time.tolist() == [3 * SECOND + i * 10**6 for i in range(64)]


def test_less_than_a_record_is_refused(fresh):
    path = fresh("log.bin")
    path.write_bytes(log.binary(log.declared())[:40])
    with pytest.raises(UnreadableLogError):
        read(path)


def test_the_leading_bytes_decide(fresh):
    path = fresh("log.csv")
    path.write_bytes(b"\0junk" + log.binary(log.flight(2)))
    assert reader_of(path).format == "dataflash"


def test_flipped_bits_never_raise_anything_else(fresh):
    data, rng, read_well = log.binary(log.flight(8)), np.random.default_rng(11), 0
    path = fresh("log.bin")
    for _ in range(60):
        damaged = np.frombuffer(data, np.uint8).copy()
        damaged[rng.integers(0, damaged.size, 20)] ^= (1 << rng.integers(0, 8, 20)).astype(np.uint8)
        path.write_bytes(damaged.tobytes())
        began = time.perf_counter()
        try:
            found = read(path)
        except (UnreadableLogError, UsageError):
            continue
        finally:
            assert time.perf_counter() - began < 5
        read_well += bool(found.imus)
    assert read_well > 30
