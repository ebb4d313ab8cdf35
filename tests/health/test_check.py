"""The whole of a log: worst first, a verdict for each stream, its rate over time, two clocks in one file."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.health import check
from imuwb.health.check import TOO_SHORT, VERDICTS
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Reference, Repair, Scalars, Triad
from imuwb.readers import read

N = 6000
GOOD, USABLE, BAD = VERDICTS


def imu_of(name="/imu", keep=None, apart=False, **given):
    rng = np.random.default_rng(len(name))
    time = np.arange(N) * (SECOND // 100)
    keep = np.ones(N, bool) if keep is None else keep
    gyro, accel = 0.01 * rng.standard_normal((N, 3)), 0.02 * rng.standard_normal((N, 3)) - [0, 0, 9.8]
    other = slice(None, None, 2) if apart else keep
    return ImuStream(name, Triad(time[keep], gyro[keep]), Triad(time[other], accel[other]), **given)


def gnss_of(start=0, name="/fix", n=60):
    time = start * SECOND + np.arange(n) * SECOND
    position = np.stack([0.8 + 1e-6 * np.arange(n), np.full(n, 0.2), np.zeros(n)], axis=1)
    velocity = np.tile([6.36, 0, 0], (n, 1))
    return GnssStream(name, time, position, velocity, np.ones((n, 3)), np.ones((n, 3)), np.full(n, 3))


def log_of(*imus, **given):
    return Log(Provenance("made.csv", "csv", "", 0), imus, **given)


def verdicts(log):
    return {s.name: s.verdict for s in check(log).streams}


def holes(*spans):
    keep = np.ones(N, bool)
    for begin, end in spans:
        keep[begin:end] = False
    return keep


def test_a_clean_log_has_no_fault_and_good_verdicts():
    time = np.arange(60) * SECOND
    position = gnss_of().position
    log = log_of(imu_of(), gnss=(gnss_of(),), speeds=(Scalars("/wheel", time, np.ones(60)),),
                 references=(Reference("/truth", time, position),))  # fmt: skip
    assert check(log).faults == ()
    assert verdicts(log) == dict.fromkeys(("/imu", "/fix", "/wheel", "/truth"), GOOD)


def test_the_worst_comes_first():
    log = log_of(imu_of(keep=holes((1000, 1010))), gnss=(replace(gnss_of(), velocity_sigma=None),))
    bad = replace(imu_of("/bad"), origin=Origin(repairs=(Repair("rows left out", 1000),)))
    found = check(replace(log, imus=(*log.imus, bad))).faults
    assert [f.severity for f in found] == ["fault", "warning", "note"]
    assert [f.stream for f in found] == ["/bad", "/imu", "/fix"]


def test_the_worst_fault_makes_the_verdict():
    log = log_of(
        imu_of("/good"), imu_of("/usable", holes((1000, 1010))), imu_of("/bad", holes((1000, 1200))),
        gnss=(replace(gnss_of(), velocity_sigma=None),),
    )  # fmt: skip
    assert verdicts(log) == {"/good": GOOD, "/usable": USABLE, "/bad": BAD, "/fix": GOOD}


def test_a_fault_of_an_axis_counts_for_its_imu_alone():
    imu = imu_of("/imu")
    zeroed = replace(imu, angular_rate=Triad(imu.angular_rate.time, imu.angular_rate.value * [0, 1, 1]))
    assert verdicts(log_of(zeroed, imu_of("/imu2"))) == {"/imu": BAD, "/imu2": GOOD}


def test_sensors_on_clocks_of_their_own_are_two_streams():
    streams = check(log_of(imu_of(apart=True))).streams
    assert [s.name for s in streams] == ["/imu gyros", "/imu accelerometers"]
    assert [s.rate.mean() for s in streams] == pytest.approx([100, 50], rel=0.01)
    assert [s.usual_rate for s in streams] == [np.median(s.rate) for s in streams]


def test_a_fault_of_an_axis_counts_for_the_stream_of_its_clock():
    imu = imu_of(apart=True)
    zeroed = replace(imu, angular_rate=Triad(imu.angular_rate.time, imu.angular_rate.value * [0, 1, 1]))
    assert verdicts(log_of(zeroed)) == {"/imu gyros": BAD, "/imu accelerometers": GOOD}


def test_repairs_of_sensors_apart_are_told_once():
    imu = replace(imu_of(apart=True), origin=Origin(repairs=(Repair("rows left out", 3),)))
    assert [(f.what, f.count) for f in check(log_of(imu)).faults] == [("rows left out", 3)]


def test_two_clocks_in_one_file_are_a_fault_of_the_receiver():
    log = log_of(imu_of(), gnss=(gnss_of(), gnss_of(1_700_000_000, "/other")))
    (fault,) = check(log).faults
    assert (fault.stream, fault.severity) == ("/other", "fault")
    assert fault.kind == "two clocks"
    assert verdicts(log) == {"/imu": GOOD, "/fix": GOOD, "/other": BAD}


def test_a_receiver_alone_has_no_second_clock():
    assert check(log_of(gnss=(gnss_of(1_700_000_000),))).faults == ()


def test_the_rate_over_time_shows_a_gap():
    stream = check(log_of(imu_of(keep=holes((2000, 3000))))).streams[0]
    inside = (stream.time > 20.5) & (stream.time < 29.5)
    assert inside.sum() > 10
    assert (stream.rate[inside] == 0).all()
    assert np.median(stream.rate) == pytest.approx(100, rel=0.1)


def test_times_count_from_the_log_s_start():
    log = log_of(imu_of(keep=holes((2000, 2100))))
    shifted = replace(log, zero=-100 * SECOND)
    assert check(shifted).faults[0].start == pytest.approx(check(log).faults[0].start + 100)
    assert check(shifted).segments[0].start == 100


def recording(shared, *parts):
    path = shared.joinpath(*parts)
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    return read(path)


def test_a_real_flight_is_full_of_gaps(shared):
    found = check(recording(shared, "tlog", "pymavlink_flight.tlog"), lines=False)
    names = {"RAW_IMU", "SCALED_IMU2", "GPS_RAW_INT"}
    gaps = {f.stream: f for f in found.faults if f.kind == "gaps"}
    assert names <= set(gaps)
    assert gaps["RAW_IMU"].count == pytest.approx(190, abs=10)
    assert [f.length for f in gaps.values()] == pytest.approx([59.2] * len(gaps), abs=0.2)
    notes = {f.kind for f in found.faults if f.stream == "GPS_RAW_INT" and f.severity == "note"}
    assert notes == {"no position sigma", "no velocity sigma"}
    assert any(f.kind == "step" and " 1 mg" in f.what and f.stream == "RAW_IMU accel_x" for f in found.faults)
    assert {s.name: s.verdict for s in found.streams if s.name in names} == {
        "RAW_IMU": BAD, "SCALED_IMU2": BAD, "GPS_RAW_INT": USABLE
    }  # fmt: skip
    ranks = [("note", "warning", "fault").index(f.severity) for f in found.faults]
    assert ranks == sorted(ranks, reverse=True)


def test_a_real_drive_is_sound_but_for_gaps_of_its_odometer(shared):
    found = check(recording(shared, "mcap", "husky_test1_ros2cdr_zstd.mcap"))
    assert [(f.stream, f.count) for f in found.faults if f.severity != "note"] == [
        ("/husky_velocity_controller/odom", 2)
    ]
    assert {s.name: s.verdict for s in found.streams} == {
        "/imu/data": GOOD, "/fix": GOOD, "/husky_velocity_controller/odom": USABLE,
    }  # fmt: skip
    assert found.moving == sum(s.end - s.start for s in found.segments if s.moving) == pytest.approx(383, abs=10)
    assert found.even == pytest.approx(155, abs=10)  # the robot rolls so smoothly that the samples show 227 s only


def test_a_jump_of_the_clock_by_decades_is_a_fault_and_takes_no_memory_by_the_second():
    imu = imu_of()
    time = imu.angular_rate.time + np.where(np.arange(N) < 50, 0, 1_716_000_000 * SECOND)
    parts = (Triad(time, part.value) for part in (imu.angular_rate, imu.specific_force))
    found = check(log_of(ImuStream("/imu", *parts)))
    assert [f.kind for f in found.faults] == ["clock jump"]
    assert sum(s.end - s.start for s in found.segments) == pytest.approx(61, abs=1.1)


def test_of_several_imus_motion_is_told_of_the_first_of_which_it_can_be():
    short = Triad(imu_of().angular_rate.time[:500], imu_of().angular_rate.value[:500])
    found = check(log_of(ImuStream("/short", short, None), imu_of("/long")))
    assert found.segments_of == "/long"
    assert found.segments[0].end == pytest.approx(59.99)


def test_health_prints_a_line_for_each_stream_and_fault():
    health = check(log_of(imu_of(keep=holes((2000, 2100)))))
    stream, fault = str(health).splitlines()
    assert stream == f"/imu: {BAD}"
    assert "19.99 s" in fault
    assert [s.faults for s in health.streams] == [1]


def rows_of(count, rate=100, gnss=0):
    imu = imu_of(keep=np.arange(N) < count)
    return log_of(imu, gnss=(gnss_of(n=gnss),) if gnss else ())


@pytest.mark.parametrize(("rows", "verdict"), [(99, TOO_SHORT), (100, GOOD)])
def test_an_imu_of_few_rows_is_too_short_to_judge(rows, verdict):
    assert verdicts(rows_of(rows)) == {"/imu": verdict}


@pytest.mark.parametrize(("rows", "verdict"), [(6, TOO_SHORT), (10, GOOD)])
def test_a_receiver_of_few_rows_is_too_short_to_judge(rows, verdict):
    assert verdicts(rows_of(N, gnss=rows))["/fix"] == verdict


def test_a_fault_of_few_rows_is_a_fault_all_the_same():
    imu = imu_of(keep=np.arange(N) < 50)
    zeroed = replace(imu, angular_rate=Triad(imu.angular_rate.time, imu.angular_rate.value * [0, 1, 1]))
    assert verdicts(log_of(zeroed)) == {"/imu": BAD}


@pytest.mark.parametrize("hole", [(1, 80), (10, 90), (N - 90, N - 1)])
def test_a_gap_that_cuts_a_few_rows_off_leaves_the_imu_usable(hole):
    log = log_of(imu_of(keep=holes(hole)))
    (fault,) = check(log).faults
    assert (fault.kind, fault.severity) == ("gaps", "warning")
    assert verdicts(log) == {"/imu": USABLE}
    assert verdicts(log_of(imu_of(keep=holes(hole, (3000, 3100))))) == {"/imu": BAD}


@pytest.mark.parametrize(("shift", "kind"), [(20, None), (40, "little overlap"), (61, "two clocks")])
def test_a_receiver_of_another_time_is_named(shift, kind):
    assert [f.kind for f in check(log_of(imu_of(), gnss=(gnss_of(shift),))).faults] == ([kind] if kind else [])


@pytest.mark.parametrize(("count", "first"), [(59, "repair"), (60, "lost rows")])
def test_a_hundredth_of_the_rows_lost_comes_before_other_faults(count, first):
    imu = replace(imu_of(keep=holes((3000, 3100))), origin=Origin(repairs=(Repair("rows left out", count),)))
    kinds = [f.kind for f in check(log_of(imu)).faults]
    assert kinds == (["lost rows", "gaps"] if first == "lost rows" else ["gaps", "repair"])


def test_lost_rows_of_a_speed_and_of_a_thermometer_are_their_own_faults():
    time = np.arange(60) * SECOND
    lost = (Repair("rows left out", 30),)
    warm = Scalars("/imu", time, 20 + 0.01 * np.arange(60), lost)
    log = log_of(imu_of(temperature=warm), speeds=(Scalars("/wheel", time, np.ones(60), lost),))
    assert {(f.stream, f.kind) for f in check(log).faults} == {
        (name, "lost rows") for name in ("/imu thermometer", "/wheel")
    }
    assert verdicts(log) == {"/imu": GOOD, "/imu thermometer": BAD, "/wheel": BAD}
