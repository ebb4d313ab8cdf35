import numpy as np
import pytest

from imuwb.geodesy.local_track import LocalTrack
from imuwb.log import (
    SECOND,
    GnssStream,
    ImuStream,
    Log,
    Orientation,
    Origin,
    Provenance,
    Reference,
    Repair,
    Scalars,
    Triad,
)
from imuwb.readers import describe
from imuwb.sampling import sampling
from imuwb.summary import summarize

FILE = Provenance("log.csv", "csv", "sha256:0", 9)
MENDED = (Repair("mended", 2),)


def triad(*seconds):
    time = np.rint(np.array(seconds) * SECOND).astype(np.int64)
    return Triad(time, np.zeros((time.size, 3)))


def every(step, count, start=0.0):
    return triad(*(start + step * np.arange(count)))


def log_of(imu=(), **streams):
    return Log(FILE, tuple(imu), **streams)


# Steps


@pytest.mark.parametrize("count", [0, 1])
def test_fewer_than_two_samples_have_no_interval(count):
    assert np.isnan(sampling(every(1.0, count).time).interval)


def test_the_interval_is_that_of_even_steps():
    assert sampling(every(0.005, 2).time).interval == 0.005
    assert sampling(every(0.005, 100).time).interval == pytest.approx(0.005, rel=1e-12)


def test_stamps_rounded_to_milliseconds_keep_their_mean_interval():
    time = np.rint(np.arange(3001) / 0.3).astype(np.int64) * 10**6  # 300 Hz: steps of 3 and 4 ms
    assert set(np.diff(time)) == {3_000_000, 4_000_000}
    assert sampling(time).interval == pytest.approx(1 / 300, rel=1e-9)


def test_gaps_do_not_count_for_the_interval():
    assert sampling(triad(0.0, 0.1, 0.2, 5.0, 5.1, 5.2, 9.0).time).interval == pytest.approx(0.1)


@pytest.mark.parametrize("seconds", [(), (0.0,), (0.0, 5.0), (0.0, 0.1, 0.2), (0.0, 0.1, 0.25)])
def test_no_gaps(seconds):
    assert sampling(triad(*seconds).time).gaps == ()


def test_gaps_count_from_the_first_row_on():
    assert sampling(triad(100.0, 100.5, 101.0, 102.0, 102.5, 110.0, 110.5).time).gaps == ((1.0, 1.0), (2.5, 7.5))


def test_one_sample_missing_is_a_gap():
    time = np.delete(np.arange(100) * 10**7, 50)
    assert sampling(time).gaps == ((0.49, 0.02),)


# Streams


def test_an_imu_on_one_clock_is_one_stream():
    sensed = every(0.01, 101, 1.0)
    origin = Origin("deg/s, g", "FLU", "unix", MENDED)
    (stream,) = summarize(log_of([ImuStream("left", sensed, triad(*sensed.time / SECOND), origin=origin)])).streams
    assert (stream.name, stream.kind, stream.count) == ("left", "imu", 101)
    assert stream.rate_hz == pytest.approx(100.0)
    assert (stream.start_ns, stream.end_ns) == (SECOND, 2 * SECOND)
    assert (stream.units, stream.frame, stream.epoch) == ("deg/s, g", "FLU", "unix")
    assert (stream.gaps, stream.repairs) == ((), MENDED)


@pytest.mark.parametrize("missing", ["angular_rate", "specific_force"])
def test_one_triad_is_one_stream_under_the_imus_name(missing):
    triads = {"angular_rate": every(0.1, 5), "specific_force": every(0.1, 5), missing: None}
    assert [s.name for s in summarize(log_of([ImuStream("left", **triads)])).streams] == ["left"]


def test_triads_on_two_clocks_are_two_streams():
    streams = summarize(log_of([ImuStream("left", every(0.01, 11), every(0.02, 6, 0.003))])).streams
    assert [(s.name, s.kind, s.count) for s in streams] == [
        ("left (gyro)", "imu", 11),
        ("left (accelerometer)", "imu", 6),
    ]
    assert [s.rate_hz for s in streams] == pytest.approx([100.0, 50.0])
    assert streams[1].start_ns == 3_000_000


def test_a_temperature_is_a_stream_of_its_own_without_the_imus_repairs():
    time = np.arange(4) * SECOND
    sensed = every(0.1, 31)
    imu = ImuStream("left", sensed, sensed, Scalars("warm", time, np.zeros(4)), Origin("rad/s", "FLU", "boot", MENDED))
    first, warm = summarize(log_of([imu])).streams
    assert (warm.name, warm.kind, warm.count, warm.rate_hz) == ("warm", "temperature", 4, 1.0)
    assert (warm.units, warm.frame, warm.epoch, warm.repairs) == ("°C", "", "boot", ())
    assert first.repairs == MENDED


def test_fixes_references_and_speeds_are_streams():
    time = np.array([0, 1, 2, 5]) * SECOND
    origin = Origin("deg, m", "ENU", "unix", MENDED)
    streams = summarize(
        log_of(
            gnss=(GnssStream("fix", time, np.zeros((4, 3)), origin=origin),),
            references=(Reference("truth", time, np.zeros((4, 3))),),
            speeds=(Scalars("wheel", time, np.zeros(4)),),
        ),
    ).streams
    assert [(s.name, s.kind) for s in streams] == [("fix", "gnss"), ("truth", "reference"), ("wheel", "speed")]
    assert all((s.count, s.rate_hz, s.gaps) == (4, 1.0, ((2.0, 3.0),)) for s in streams)
    assert (streams[0].units, streams[0].frame, streams[0].repairs) == ("deg, m", "ENU", MENDED)
    assert (streams[2].units, streams[2].frame, streams[2].epoch) == ("m/s", "", "unix")


def test_a_single_row_has_no_rate():
    (stream,) = summarize(log_of([ImuStream("left", every(1.0, 1), None)])).streams
    assert (stream.count, stream.rate_hz, stream.start_ns, stream.end_ns) == (1, None, 0, 0)


def test_a_log_of_nothing_has_no_streams():
    summary = summarize(log_of(notes=("odd",)))
    assert (summary.streams, summary.notes) == ((), ("odd",))


def test_describe_returns_the_streams_of_a_file(text_log):
    header = "time_s,gx_dps,gy_dps,gz_dps,ax [g],ay [g],az [g],temperature_c,lat,lon"
    rows = "".join(f"{t},1,2,3,0,0,-1,{'20' if t < 2 else ''},45,9\n" for t in (0.0, 0.5, 1.0, 1.5, 3.5, 4.0))
    path = text_log(f"{header}\n{rows}")
    summary = describe(path)
    assert (summary.path, summary.format) == (str(path), "csv")
    assert summary.hash.startswith("sha256:")
    assert [(s.name, s.kind, s.count, s.rate_hz) for s in summary.streams] == [
        ("imu", "imu", 6, 2.0),
        ("imu", "temperature", 4, 2.0),
        ("gnss", "gnss", 6, 2.0),
    ]
    assert summary.streams[0].units == "deg/s, g"
    assert [s.gaps for s in summary.streams] == [((1.5, 2.0),), (), ((1.5, 2.0),)]


def test_a_summary_prints_the_lines_of_its_log():
    log = log_of([ImuStream("left", every(0.01, 11), every(0.02, 6, 0.003))], notes=("odd",))
    assert str(summarize(log)) == repr(summarize(log)) == str(log)


def test_orientations_and_poses_are_streams():
    time = every(0.1, 5).time
    orientation = Orientation("/imu", time, np.tile([1.0, 0, 0, 0], (5, 1)), origin=Origin(frame="ENU", epoch="unix"))
    pose = LocalTrack("/odom", time, np.zeros((5, 3)))
    found = summarize(log_of(orientations=(orientation,), poses=(pose,))).streams
    assert [(s.name, s.kind, s.count) for s in found] == [("/imu", "orientation", 5), ("/odom", "pose", 5)]
    assert (found[0].frame, found[0].epoch) == ("ENU", "unix")
