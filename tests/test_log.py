import numpy as np
import pytest

from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Reference, Scalars, Triad

TIME = np.arange(3, dtype=np.int64)
BODY = np.arange(9.0).reshape(3, 3)


def kinds():
    return {
        "triad": Triad,
        "position": lambda time, value: GnssStream("fix", time, value),
        "velocity": lambda time, value: GnssStream("fix", time, BODY, velocity=value),
        "position_sigma": lambda time, value: GnssStream("fix", time, BODY, position_sigma=value),
        "velocity_sigma": lambda time, value: GnssStream("fix", time, BODY, velocity_sigma=value),
        "attitude": lambda time, value: Reference("truth", time, BODY, attitude=value),
        "reference": lambda time, value: Reference("truth", time, value),
        "scalars": lambda time, value: Scalars("warmth", time, value[:, 0]),
    }


@pytest.fixture(params=sorted(kinds()))
def make(request):
    return kinds()[request.param]


def test_sound_arrays_are_kept(make):
    assert len(make(TIME, BODY)) == 3
    np.testing.assert_array_equal(Triad(TIME, BODY).value, BODY)


@pytest.mark.parametrize("kind", ["velocity", "position_sigma", "velocity_sigma"])
def test_what_a_receiver_does_not_state_is_nan(kind):
    value = BODY.copy()
    value[1, 0] = np.nan
    assert np.isnan(getattr(kinds()[kind](TIME, value), kind)[1, 0])


@pytest.mark.parametrize(
    ("kind", "bad"),
    [
        (kind, bad)
        for kind in sorted(kinds())
        for bad in (np.nan, np.inf, -np.inf)
        if not (np.isnan(bad) and kind in ("velocity", "position_sigma", "velocity_sigma"))
    ],
)
def test_values_that_are_not_finite_are_refused_and_counted(kind, bad):
    value = BODY.copy()
    value[1, 0] = bad
    with pytest.raises(ValueError, match=r"1 values that are not finite"):
        kinds()[kind](TIME, value)


@pytest.mark.parametrize("time", [[0, 2, 1], [0, 1, 1]])
def test_time_that_does_not_increase_is_refused_with_the_row(make, time):
    with pytest.raises(ValueError, match=rf"time .*row 2 has {time[2]} ns after {time[1]} ns"):
        make(time, BODY)


def test_a_wrong_number_of_rows_is_refused_with_both_shapes(make):
    with pytest.raises(ValueError, match=r"has shape \(2,.*\); it must be \(3,"):
        make(TIME, BODY[:2])


def test_a_wrong_number_of_columns_is_refused():
    with pytest.raises(ValueError, match=r"triad value has shape \(3, 2\); it must be \(3, 3\)"):
        Triad(TIME, BODY[:, :2])


def test_fix_types_are_as_many_as_fixes():
    with pytest.raises(ValueError, match=r"fix fix_type has shape \(1,\)"):
        GnssStream("fix", TIME, BODY, fix_type=np.ones(1, np.int64))


def test_arrays_are_read_only():
    fix = GnssStream("fix", TIME, BODY, BODY, BODY, BODY, TIME)
    for array in (Triad(TIME, BODY).time, Triad(TIME, BODY).value, fix.velocity, fix.position_sigma, fix.fix_type):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_the_callers_array_stays_writeable():
    value = BODY.copy()
    Triad(TIME, value)
    value[0, 0] = 5.0
    assert value[0, 0] == 5.0


def test_values_are_frozen():
    with pytest.raises(AttributeError):
        Triad(TIME, BODY).time = TIME


def test_empty_streams_are_allowed():
    assert len(Triad(TIME[:0], BODY[:0])) == 0


def test_axes_are_the_columns_of_both_triads():
    imu = ImuStream("imu", Triad(TIME, BODY), Triad(TIME + 5, -BODY))
    axes = imu.axes()
    assert list(axes) == ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]
    np.testing.assert_array_equal(axes["accel_y"][1], -BODY[:, 1])
    np.testing.assert_array_equal(axes["accel_y"][0], TIME + 5)


def test_an_imu_without_gyro_has_three_axes():
    assert list(ImuStream("imu", None, Triad(TIME, BODY)).axes()) == ["accel_x", "accel_y", "accel_z"]


def test_a_log_prints_a_line_for_its_file_and_one_for_each_stream():
    time = np.delete(np.arange(101), [40, 41, 42]) * (SECOND // 100)
    sensors = Triad(time, np.zeros((98, 3)))
    slow = Triad(time[::2], np.zeros((49, 3)))
    warmth = Scalars("/warm", time[::10], np.zeros(10))
    fixes = GnssStream("/fix", time, np.zeros((98, 3)), origin=Origin("deg, m", "ENU", "unix"))
    log = Log(
        Provenance("run.mcap", "mcap", "sha256:0", 9),
        imus=(ImuStream("/imu", sensors, sensors, warmth, Origin("deg/s, g", "FLU")), ImuStream("/two", sensors, slow)),
        gnss=(fixes,),
        speeds=(Scalars("/wheel", time, np.zeros(98)),),
        references=(Reference("/truth", time, np.zeros((98, 3))),),
    )
    file, *lines = str(log).splitlines()
    assert file == "run.mcap (mcap)"
    clock = "98 rows, 100 Hz, 1 s, 1 gap (longest 0.04 s)"
    assert lines[0] == f"/imu: imu, {clock}, deg/s, g, FLU"
    assert [line.split(":")[0] for line in lines] == [
        "/imu", "/warm", "/two (gyro)", "/two (accelerometer)", "/fix", "/truth", "/wheel",
    ]  # fmt: skip
    assert lines[4] == f"/fix: gnss, {clock}, deg, m, ENU"
    for value in (log, *log.streams(), sensors):
        assert repr(value) == str(value)
        assert all(len(line) < 120 for line in str(value).splitlines())


def test_a_log_of_nothing_and_a_single_row_print_too():
    assert len(str(Log(Provenance("a", "csv", "", 0))).splitlines()) == 2
    assert "1 rows" in str(Triad(TIME[:1], BODY[:1]))
    assert "0 rows" in str(Triad(TIME[:0], BODY[:0]))
    assert str(ImuStream("imu", None, None)).startswith("imu:")
