"""Files of several tables: rows with tags, and rows of several sensors told apart by a column."""

import re
from functools import reduce
from operator import xor

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.readers import ReadOptions, read
from tests.readers.repairs import repairs

ROWS = 200
RNG = np.random.default_rng(11)
RATES = np.round(RNG.normal(0, 0.01, (ROWS, 3)), 6)
FORCES = np.round(RNG.normal((0, 0, 9.8), 0.02, (ROWS, 3)), 6)
TIMES = np.arange(ROWS) * 10_000_000
LATE = 3_000_000  # the gyro samples later by so much


def seconds(time):
    return f"{time / 1e9:.3f}"


def numbers(values, mark=","):
    return mark.join(f"{value:.6f}" for value in values)


def unused(log):
    return " ".join(note for note in log.notes if note.id == "unused")


def assert_both(imu, *, gyro=TIMES + LATE, accel=TIMES):
    assert imu.angular_rate.time.tolist() == list(gyro)
    assert imu.specific_force.time.tolist() == list(accel)
    np.testing.assert_allclose(np.abs(imu.angular_rate.value), np.abs(RATES), rtol=1e-14)
    np.testing.assert_allclose(np.abs(imu.specific_force.value), np.abs(FORCES), rtol=1e-14)
    assert repairs(imu) == {}


def interleaved(accel, gyro, mark=","):
    """Return rows of an accelerometer and a gyro in turn."""
    return "".join(
        f"{accel}{mark}{seconds(t)}{mark}{numbers(f, mark)}\n{gyro}{mark}{seconds(t + LATE)}{mark}{numbers(w, mark)}\n"
        for t, f, w in zip(TIMES, FORCES, RATES, strict=True)
    )


UNITS = {"gyro": "rad/s", "accel": "m/s²"}


@pytest.mark.parametrize(
    ("header", "accel", "gyro", "mark"),
    [
        ("% ACCE;time (s);x;y;z\n% GYRO;time (s);x;y;z\n", "ACCE", "GYRO", ";"),
        ("# accel,time_s,accel_x,accel_y,accel_z\n# gyro,time_s,gyro_x,gyro_y,gyro_z\n", "accel", "gyro", ","),
        ("$COL,ACC,time,ax,ay,az\n$UNIT,ACC,s,m/s^2,m/s^2,m/s^2\n$COL,GYR,time,wx,wy,wz\n$UNIT,GYR,s,rad/s,rad/s,rad/s\n$DATA\n",
         "$ACC", "$GYR", ","),
        ("sensor,time_s,x,y,z\n", "accelerometer", "gyroscope", ","),
        ("type;time_s;x;y;z\n", "acc", "gyr", ";"),
        ("sensor time_s x y z\n", "accel", "gyro", " "),
    ],
)  # fmt: skip
def test_rows_with_tags_are_parted_by_sensor(text_log, header, accel, gyro, mark):
    log = read(text_log(header + interleaved(accel, gyro, mark)), ReadOptions(units=UNITS))
    assert_both(*log.imus)


def test_a_tag_may_be_any_column(text_log):
    rows = "".join(
        f"{seconds(t)},accel,{numbers(f)}\n{seconds(t + LATE)},gyro,{numbers(w)}\n"
        for t, f, w in zip(TIMES, FORCES, RATES, strict=True)
    )
    log = read(text_log("time_s,sensor,x,y,z\n" + rows), ReadOptions(units=UNITS))
    assert_both(*log.imus)


def test_the_user_may_name_the_tag(text_log):
    path = text_log(interleaved("acc", "gyr"))
    with pytest.raises(UsageError, match="5 columns.*tag"):
        read(path)
    log = read(path, ReadOptions(columns=("tag", "time_s", "x", "y", "z"), units=UNITS))
    assert_both(*log.imus)


def test_rows_of_other_tags_are_named_with_their_number(text_log):
    header = "% ACCE;time (s);x;y;z\n% GYRO;time (s);x;y;z\n% WIFI;time (s);name;level\n"
    rows = interleaved("ACCE", "GYRO", ";") + "WIFI;1.0;home;-60\n" * 7 + "MAGN;1.0;10;20;30\n" * 9
    log = read(text_log(header + rows), ReadOptions(units=UNITS))
    assert_both(*log.imus)
    assert "MAGN" in unused(log)
    assert "WIFI" in unused(log)


@pytest.mark.parametrize("name", ["I", "device_id"])
@pytest.mark.parametrize("values", [("0", "1", "2"), ("left", "right", "rear"), ("2686988", "3014668", "65538")])
def test_rows_of_several_imus_at_equal_stamps_are_streams_of_their_own(text_log, name, values):
    header = f"time_s,{name},gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n"
    rows = "".join(
        f"{seconds(t)},{value},{numbers(w + k)},{numbers(f)}\n"
        for t, f, w in zip(TIMES, FORCES, RATES, strict=True)
        for k, value in enumerate(values)
    )
    log = read(text_log(header + rows))
    assert len(log.imus) == len(values)
    for k, imu in enumerate(log.imus):
        assert imu.angular_rate.time.tolist() == TIMES.tolist()
        np.testing.assert_allclose(imu.angular_rate.value, RATES + k, atol=1e-9)
        assert repairs(imu) == {}
    assert len({imu.name for imu in log.imus}) == len(values)


def sentence(body):
    return f"${body}*{reduce(xor, body.encode()):02X}"


def sentences(stamped=False):
    return [
        ((f"{seconds(t)}," if stamped else "") + sentence(f"IMU,{numbers(f)},{numbers(w)},{25 + i % 3}.5"))
        for i, (t, f, w) in enumerate(zip(TIMES, FORCES, RATES, strict=True))
    ]


NAMES = ("-", "accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z", "temperature")


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_sentences_with_checksums_are_rows(text_log, end):
    lines = sentences()
    lines[50] = lines[50].replace("0.", "1.", 1)  # damage
    lines[70] = lines[70][:-1]
    text = "# IMU,ax,ay,az,wx,wy,wz,temperature\n" + end.join([*lines, ""])
    (imu,) = read(text_log(text), ReadOptions(rate=100, units=UNITS)).imus
    kept = [i for i in range(ROWS) if i not in (50, 70)]
    np.testing.assert_array_equal(imu.specific_force.value, FORCES[kept])
    assert imu.temperature.value[1] == 26.5
    assert repairs(imu) == {"checksum": 2}


def test_a_stamp_of_the_host_may_stand_before_a_sentence(text_log):
    text = "# IMU,ax,ay,az,wx,wy,wz,temperature\n" + "\n".join([*sentences(stamped=True), ""])
    (imu,) = read(text_log(text), ReadOptions(units={**UNITS, "time": "s"})).imus
    assert imu.specific_force.time.tolist() == TIMES.tolist()


TWO = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"


def rows_of_two(names, later=0, place=0):
    """Return rows of two sensors in turn, the second later by so many ns and turning by 1 rad/s more; the name's place is 0, or -1: the last."""
    for t, f, w in zip(TIMES, FORCES, RATES, strict=True):
        for k, name in enumerate(names):
            cells = [seconds(t + k * later), numbers(w + k), numbers(f)]
            yield ",".join([name, *cells] if place == 0 else [*cells, name]) + "\n"


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize(("place", "later"), [(0, 0), (0, 4_000_000), (-1, 0), (-1, 4_000_000)])
@pytest.mark.parametrize(
    ("column", "names"),
    [
        ("id", ("1", "2")), ("channel", ("3", "7")), ("addr", ("0x68", "0x69")), ("mac", ("AC:DE:48:00:11:22", "AC:DE:48:00:11:33")),
        ("header.frame_id", ("imu_left", "imu_right")), ("imu_no", ("0", "1")), ("serial", ("00B4A1F2", "00B4A1F3")),
        ("whose", ("foot", "shank")), ("sensor_name", ("imu 1", "imu 2")),
    ],
)  # fmt: skip
def test_a_column_that_names_sensors_parts_them(text_log, column, names, place, later, end):
    header = f"{column},{TWO}\n" if place == 0 else f"{TWO},{column}\n"
    log = read(text_log((header + "".join(rows_of_two(names, later, place))).replace("\n", end)))
    assert len(log.imus) == 2
    for k, imu in enumerate(log.imus):
        assert imu.angular_rate.time.tolist() == (TIMES + k * later).tolist()
        np.testing.assert_allclose(imu.angular_rate.value, RATES + k, atol=1e-9)
        assert repairs(imu) == {}


@pytest.mark.parametrize("state", [
    lambda i: "walks" if i // 50 % 2 else "stands", lambda i: "true" if i % 2 else "false", lambda i: ("calm", "rough")[i * i // 7 % 2],
])  # fmt: skip
def test_a_state_that_flickers_parts_no_imu(text_log, state):
    header = f"how,{TWO}\n"
    rows = "".join(f"{state(i)},{seconds(t)},{numbers(w)},{numbers(f)}\n"
                   for i, (t, w, f) in enumerate(zip(TIMES, RATES, FORCES, strict=True)))  # fmt: skip
    (imu,) = read(text_log(header + rows)).imus
    assert imu.angular_rate.time.tolist() == TIMES.tolist()


@pytest.mark.parametrize("name", ["frame", "segment", "id"])
def test_a_counter_that_stays_for_some_rows_parts_no_imu(text_log, name):
    rows = "".join(
        f"{i // 8},{seconds(t)},{numbers(w)},{numbers(f)}\n"
        for i, (t, w, f) in enumerate(zip(TIMES, RATES, FORCES, strict=True))
    )
    (imu,) = read(text_log(f"{name},{TWO}\n{rows}")).imus
    assert imu.angular_rate.time.tolist() == TIMES.tolist()


def test_a_gyro_that_rises_between_repeated_stamps_is_no_fraction_of_a_second(text_log):
    log = read(text_log(TWO + "\n" + "".join(row.split(",", 1)[1] for row in rows_of_two("ab"))))
    assert [len(imu.angular_rate) for imu in log.imus] == [ROWS, ROWS]


def test_a_column_of_states_parts_no_imu(text_log):
    header = "state,time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n"
    rows = "".join(
        f"{'ok' if i % 5 else 'late'},{seconds(t)},{numbers(w)}\n"
        for i, (t, w) in enumerate(zip(TIMES, RATES, strict=True))
    )
    (imu,) = read(text_log(header + rows)).imus
    assert imu.angular_rate.time.tolist() == TIMES.tolist()


def test_a_tagged_file_without_names_asks_for_them(text_log):
    with pytest.raises((UsageError, UnreadableLogError), match="--columns|header"):
        read(text_log(interleaved("AAA", "BBB")))


@pytest.mark.parametrize(
    "name", ["Gyroscope.csv", "gyro.txt", "phone_gyro.csv", "Phone-Gyroscope-1.csv", "my gyroscope.csv"]
)
def test_the_name_of_a_file_names_its_sensor(text_log, name):
    rows = "".join(f"{seconds(t)},{numbers(w)}\n" for t, w in zip(TIMES, RATES, strict=True))
    (imu,) = read(text_log("time_s,x,y,z\n" + rows, name), ReadOptions(units=UNITS)).imus
    np.testing.assert_array_equal(imu.angular_rate.value, RATES)
    assert re.search("gyro", name, re.IGNORECASE)


def dumped(instances=2, end="\n"):
    """Return what mavlogdump prints of a DataFlash log: names and values, IMUs in turn at equal stamps."""
    lines = []
    for i, (t, f, w) in enumerate(zip(TIMES, FORCES, RATES, strict=True)):
        date = f"2024-05-01 12:00:{i // 100:02d}.{i % 100:02d}"
        for k in range(instances):
            named = zip(("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"), (*(w + k), *(f * [1, 1, -1])), strict=True)
            values = "".join(f", {name} : {value:.6f}" for name, value in named)
            lines.append(f"{date}: IMU {{TimeUS : {t // 1000}, I : {k}{values}, EG : 0, EA : 0, T : 35.5, GH : 1}}")
        if i % 10 == 0:
            lines.append(f"{date}: ATT {{TimeUS : {t // 1000}, DesRoll : 0.5, Roll : 1.25, Yaw : 12.0}}")
            lines.append(f"{date}: MSG {{TimeUS : {t // 1000}, Message : all is well}}")
    return end.join([*lines, ""])


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_lines_of_names_and_values_are_tables(text_log, end):
    log = read(text_log(dumped(end=end)))
    assert len(log.imus) == 2
    for k, imu in enumerate(log.imus):
        assert imu.angular_rate.time.tolist() == TIMES.tolist()
        np.testing.assert_allclose(imu.angular_rate.value, RATES + k, atol=1e-9)
        assert (imu.origin.epoch, repairs(imu)) == ("boot", {})
    assert "ATT" in unused(log)
    assert "MSG" in unused(log)


@pytest.mark.parametrize(("name", "ids"), [("id", ("1", "2")), ("device_id", ("AA:01", "BB:02", "CC:03"))])
@pytest.mark.parametrize("rows", [40, 1500])  # the second block begins within the head of the file, and after it
def test_sensors_in_blocks_with_one_time_are_parted_by_their_column(text_log, name, ids, rows):
    lines = [f"time_s,{name},gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2"]
    lines += [f"{i / 100:.2f},{own},{k / 10},0,0,0,0,9.{i % 10}" for k, own in enumerate(ids) for i in range(rows)]
    log = read(text_log("\n".join(lines) + "\n"))
    assert [imu.name.removeprefix("imu") for imu in log.imus] == list(ids)
    for k, imu in enumerate(log.imus):
        assert imu.angular_rate.time.tolist() == [10_000_000 * i for i in range(rows)]
        assert set(imu.angular_rate.value[:, 0].tolist()) == {k / 10}
        assert not imu.origin.repairs
    assert not unused(log)


def test_blocks_whose_time_goes_on_are_one_sensor(text_log):
    lines = ["time_s,id,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2"]
    lines += [f"{i / 100:.2f},{i // 200},0.{i % 7},0,0,0,0,9.8" for i in range(600)]
    (imu,) = read(text_log("\n".join(lines) + "\n")).imus
    assert len(imu.angular_rate) == 600
