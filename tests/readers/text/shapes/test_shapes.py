"""Each known shape of text logs, read without an option: rates, units, frame, times and values."""

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from imuwb.readers.text.shapes.shape import shapes
from tests.readers.text.shapes.receiver_writers import RECEIVERS
from tests.readers.text.shapes.sentence_writers import RECEIVERS_OF_SENTENCES, REFERENCES, SENTENCES
from tests.readers.text.shapes.truth import (
    ACCEL,
    FIX_TIME,
    GYRO,
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    RATE_HZ,
    TIME,
    VELOCITY,
    axes,
    decimals,
    gps,
    table,
)
from tests.readers.text.shapes.writers import WRITERS

MICROSECOND = 1000


def opened(text_log, file):
    return read(text_log(file.text, name=file.name), ReadOptions(rate=file.rate))


@pytest.mark.parametrize("writer", [*WRITERS, *SENTENCES], ids=lambda writer: writer.__name__)
def test_an_imu_of_a_known_shape(text_log, writer):
    file = writer()
    log = opened(text_log, file)
    assert tuple(imu.name for imu in log.imus) == file.streams
    expected = TIME if file.time is None else file.time
    for imu in log.imus:
        assert imu.origin.epoch == file.epoch
        assert imu.origin.frame.startswith(file.frame)
        assert imu.origin.repairs == ()
        triads = {"gyro": (imu.angular_rate, GYRO), "accel": (imu.specific_force, ACCEL)}
        for sensor, (triad, truth) in triads.items():
            assert (triad is not None) == (sensor in file.sensors.split())
            if triad is not None:
                assert np.abs(triad.time - expected).max() <= MICROSECOND
                assert (len(triad) - 1) / (triad.time[-1] - triad.time[0]) * 1e9 == pytest.approx(RATE_HZ, rel=1e-6)
                np.testing.assert_allclose(triad.value, truth, rtol=0, atol=1e-6 + file.resolution)


@pytest.mark.parametrize("writer", [*RECEIVERS, *RECEIVERS_OF_SENTENCES], ids=lambda writer: writer.__name__)
def test_a_receiver_of_a_known_shape(text_log, writer):
    file = writer()
    (fix,) = opened(text_log, file).gnss
    assert fix.origin.epoch == file.epoch
    assert np.abs(fix.time - (FIX_TIME if file.time is None else file.time)).max() <= MICROSECOND
    np.testing.assert_allclose(
        fix.position[:, :2], np.radians([*zip(LATITUDE, LONGITUDE, strict=True)]), rtol=0, atol=1e-9
    )
    np.testing.assert_allclose(fix.position[:, 2], HEIGHT, rtol=0, atol=1e-3)
    assert fix.origin.above_sea == ("above_sea" in file.sensors)
    assert (fix.position_sigma is not None) == ("sigma" in file.sensors)
    if "velocity" in file.sensors:
        axes_known = 2 if "level" in file.sensors else 3
        np.testing.assert_allclose(fix.velocity[:, :axes_known], VELOCITY[:, :axes_known], rtol=0, atol=1e-6)
    else:
        assert fix.velocity is None


@pytest.mark.parametrize("writer", REFERENCES, ids=lambda writer: writer.__name__)
def test_the_solution_of_an_ins(text_log, writer):
    log = opened(text_log, writer())
    (solution,) = log.references
    assert log.gnss == ()
    assert solution.origin.by_filter
    assert not solution.origin.above_sea
    assert np.abs(solution.time - FIX_TIME).max() <= MICROSECOND
    np.testing.assert_allclose(solution.position[:, 2], HEIGHT, rtol=0, atol=1e-3)
    np.testing.assert_allclose(solution.velocity, VELOCITY, rtol=0, atol=1e-6)
    np.testing.assert_allclose(np.degrees(solution.attitude), [[1, -2, 30]] * 30, rtol=0, atol=1e-6)


def test_the_reference_of_ppc(text_log):
    week, tow = gps(FIX_TIME)
    head = "GPS TOW (s), GPS Week, Latitude (deg), Longitude (deg), Ellipsoid Height (m), ECEF X (m), ECEF Y (m), ECEF Z (m), "
    head += "Roll (deg), Pitch (deg), Heading (deg), East Velocity (m/s), North Velocity (m/s), Up Velocity (m/s)"
    attitude = np.tile([1.0, -2.0, 30.0], (30, 1))
    columns = LATITUDE, LONGITUDE, HEIGHT, np.zeros((30, 3)), attitude, VELOCITY[:, [1, 0]], -VELOCITY[:, 2]
    log = read(text_log(table(head, decimals(tow), week, *columns), name="reference.csv"))
    (solution,) = log.references
    assert solution.time.tolist() == FIX_TIME.tolist()
    np.testing.assert_allclose(solution.velocity, VELOCITY, rtol=0, atol=1e-9)
    np.testing.assert_allclose(np.degrees(solution.attitude), attitude, rtol=0, atol=1e-9)
    assert not solution.origin.above_sea


@pytest.mark.parametrize(
    ("header", "name"),
    [
        ("time,seconds_elapsed,z,y,x", "Accelerometer.csv"),
        ('"Time (s)","Linear Acceleration x (m/s^2)","Linear Acceleration y (m/s^2)","Linear Acceleration z (m/s^2)"', "Linear.csv"),
    ],
)  # fmt: skip
def test_an_acceleration_without_gravity_is_no_specific_force(text_log, header, name):
    columns = [TIME, (TIME - TIME[0]) / 1e9] if "elapsed" in header else [decimals(TIME - TIME[0])]
    with pytest.raises(UnreadableLogError, match="gravity is removed"):
        read(text_log(table(header, *columns, ACCEL - [0, 0, -9.8]), name=name))


def test_a_unit_that_a_user_wrote_into_the_header_is_taken(text_log):
    head = '"Time (s)","Gyroscope x (deg/s)","Gyroscope y (deg/s)","Gyroscope z (deg/s)","Absolute (deg/s)"'
    degrees = np.degrees(axes(GYRO, "FLU"))
    log = read(text_log(table(head, decimals(TIME - TIME[0]), degrees, np.linalg.norm(degrees, axis=1))))
    np.testing.assert_allclose(log.imus[0].angular_rate.value, GYRO, rtol=0, atol=1e-9)


def test_a_stated_frame_goes_before_that_of_the_shape(text_log):
    head = "timestamp," + ",".join(f"{s}[{i}]" for s in ("gyro_rad", "accelerometer_m_s2") for i in range(3))
    text = table(head, (TIME - TIME[0]) // 1000, axes(GYRO, "FLU"), axes(ACCEL, "FLU"))
    imu = read(text_log(text), ReadOptions(frame="FLU")).imus[0]
    np.testing.assert_allclose(imu.specific_force.value, ACCEL, rtol=0, atol=1e-9)
    assert imu.origin.frame == "FLU (stated)"


def test_a_fixed_unit_that_gravity_contradicts_is_refused(text_log):
    names = ",".join(f"{s}_{a}" for s in ("omega", "alpha") for a in "xyz")
    with pytest.raises(UnreadableLogError, match=r"\|f\|.*accel=g"):
        read(text_log(table(f"timestamp,{names}", TIME, GYRO, ACCEL / 9.8)))


def test_seven_numbers_without_gravity_are_no_increments(text_log):
    with pytest.raises(UsageError, match="7 columns"):
        read(text_log(table("", decimals(TIME - TIME[0]), GYRO * 0.01, ACCEL * 0.001, mark=" ")))


def test_the_increment_after_a_gap_covers_one_step(text_log):
    _, tow = gps(TIME)
    there = np.r_[0:100, 105:300]
    text = table("", decimals(tow[there]), GYRO[there] * 0.01, ACCEL[there] * 0.01, mark=" ")
    imu = read(text_log(text)).imus[0]
    np.testing.assert_allclose(imu.angular_rate.value, GYRO[there], rtol=0, atol=1e-6)


def test_what_is_not_used_is_named(text_log):
    text = table(
        "timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z,humidity,phase",
        TIME,
        GYRO,
        ACCEL,
        np.ones((len(TIME), 2)),
    )
    notes = read(text_log(text)).notes
    assert [note for note in notes if note.id == "unused" and "humidity, phase" in note]
    assert "shape" in ids(notes)


def test_of_a_file_that_is_not_known_every_column_is_named(text_log):
    (note,) = (n for n in read(text_log("time_s,roll_deg,depth\n0.1,2,3\n0.2,3,4\n")).notes if n.id == "no_stream")
    assert all(text in note for text in ("roll_deg (roll)", "depth", "axes of a gyro"))


def test_every_shape_states_its_source():
    assert len(shapes()) > 40
    assert all(shape.source and (shape.row or shape.header or shape.text) for shape in shapes())


def test_a_file_of_other_columns_is_not_asked_for_the_unit_of_its_time(text_log):
    log = read(text_log("timestamp,load,ram_usage\n3270000,0.5,0.25\n3280000,0.5,0.25\n"))
    (note,) = log.notes
    assert note.id == "no_stream"
    assert all(name in note for name in ("timestamp (time)", "load", "ram_usage"))


def test_an_acceleration_near_zero_draws_no_advice_of_a_unit(text_log):
    text = table("time_s,ax,ay,az", decimals(TIME - TIME[0]), (ACCEL - [0.02, -0.03, -9.79]) / 10)
    with pytest.raises(UsageError, match="no specific force"):
        read(text_log(text))


@pytest.mark.parametrize(
    ("rate", "force", "step"),
    [(GYRO, ACCEL, 10**7), (np.degrees(GYRO) + 1, np.abs(ACCEL), 10**7), (GYRO, ACCEL / 9.8, 10**8), (GYRO + 1, np.abs(ACCEL), 10**8)],
    ids=["SI", "positive", "g at 10 Hz", "positive at 10 Hz"],
)  # fmt: skip
def test_rates_and_forces_without_a_header_are_neither_increments_nor_fixes(text_log, rate, force, step):
    with pytest.raises(UsageError, match="7 columns"):
        read(text_log(table("", decimals(step * np.arange(len(rate))), rate, force, mark=" ")))


def test_names_that_many_loggers_use_have_no_fixed_unit(text_log):
    names = [f"{s}{a}" for s in ("acc", "gyr") for a in "XYZ"]
    with pytest.raises(UsageError, match="--units gyro=UNIT|--units accel=UNIT"):
        read(text_log(table("timestamp," + ",".join(names), TIME, ACCEL, GYRO)))


@pytest.mark.parametrize("coarse", [1_000_000, 4_000_000])
def test_increments_with_coarse_stamps_cover_the_average_step(text_log, coarse):
    _, tow = gps(TIME[0] + 6_500_000 * np.arange(len(TIME)))
    text = table("", decimals(tow // coarse * coarse), GYRO * 0.0065, ACCEL * 0.0065, mark=" ")
    imu = read(text_log(text)).imus[0]
    np.testing.assert_allclose(imu.angular_rate.value, GYRO, rtol=5e-3, atol=1e-6)


@pytest.mark.parametrize(("empty", "receiver"), [("", True), ("nan", True), ("", False)])
def test_rows_of_several_sensors_in_one_table_are_each_their_own(text_log, empty, receiver):
    """Gyro, accelerometer and receiver have rows of their own; the cells of the others are empty."""
    rows = []
    for i, stamp in enumerate(TIME.tolist()):
        blank = [empty] * 3
        rows += [[decimals([stamp])[0], *map(repr, GYRO[i].tolist()), *blank, *blank]]
        rows += [[decimals([stamp + 4_000_000])[0], *blank, *map(repr, ACCEL[i].tolist()), *blank]]
        if i % 10 == 0 and receiver:
            place = LATITUDE[i // 10], LONGITUDE[i // 10], HEIGHT[i // 10]
            rows += [[decimals([stamp + 5_000_000])[0], *blank, *blank, *(repr(float(x)) for x in place)]]
    head = "time_s,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2,lat_deg,lon_deg,height_m"
    log = read(text_log("\n".join([head, *map(",".join, rows), ""])))
    (imu,) = log.imus
    assert imu.origin.repairs == ()
    assert imu.angular_rate.time.tolist() == TIME.tolist()
    assert imu.specific_force.time.tolist() == (TIME + 4_000_000).tolist()
    np.testing.assert_array_equal(imu.specific_force.value, ACCEL)
    assert [(len(fix), fix.origin.repairs) for fix in log.gnss] == ([(30, ())] if receiver else [])


def test_a_time_that_somebody_wrote_in_seconds_is_not_read_in_ns(text_log):
    names = ",".join(f"{s}_{a}" for s in ("omega", "alpha") for a in "xyz")
    imu = read(text_log(table(f"timestamp,{names}", decimals(TIME + 1), GYRO, ACCEL))).imus[0]
    assert imu.angular_rate.time.tolist() == (TIME + 1).tolist()


def test_a_table_without_a_header_may_have_damaged_rows(text_log):
    _, tow = gps(TIME)
    rows = table("", decimals(tow), GYRO * 0.01, ACCEL * 0.01, mark=" ").split("\n")
    rows[20] = rows[19]
    rows[40] = " ".join([rows[40].split()[0], *["nan"] * 6])
    imu = read(text_log("\n".join(rows))).imus[0]
    assert len(imu.angular_rate) == len(TIME) - 2


def test_a_gyro_and_an_accelerometer_with_different_names_are_one_imu(text_log):
    head = "time_s," + ",".join(f"{s}_{a}" for s in ("l3g_gyro_rad_s", "adxl_accel_m_s2") for a in "xyz")
    (imu,) = read(text_log(table(head, decimals(TIME), GYRO, ACCEL))).imus
    assert imu.name == "imu"
    np.testing.assert_array_equal(imu.specific_force.value, ACCEL)


@pytest.mark.parametrize(
    ("angle", "speed", "factor"),
    [
        ("dtheta_{}_rad", "dvel_{}_m_s", 1.0), ("delta_angle_{} [arcsec]", "delta_velocity_{} [m/s]", np.degrees(1) * 3600),
        ("Δθ{} (deg)", "Δv{} (m/s)", np.degrees(1)),
    ],
)  # fmt: skip
def test_increments_by_name_are_rates_over_their_steps(text_log, angle, speed, factor):
    names = [name.format(axis) for name in (angle, speed) for axis in "xyz"]
    text = table("time_s," + ",".join(names), decimals(TIME), GYRO * 0.01 * factor, ACCEL * 0.01)
    imu = read(text_log(text)).imus[0]
    np.testing.assert_allclose(imu.angular_rate.value, GYRO, rtol=0, atol=1e-9)
    np.testing.assert_allclose(imu.specific_force.value, ACCEL, rtol=0, atol=1e-6)
