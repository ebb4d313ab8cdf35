"""The columns that time the rows of a text log: which are found, which are used, and what is said of the others."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from tests.readers.text.csv_writer import HEADER, ROW

START = 1_700_000_000 * 10**9 + 250_000_000
STEP = 5_000_000
ROWS = 700  # the seconds step three times at 200 Hz
TIMES = START + STEP * np.arange(ROWS)
UTC_START = datetime(1970, 1, 1, tzinfo=UTC)


def table(header, cells, rows=ROWS, mark=","):
    """Return a log whose first columns are the cells of each row's time (ns)."""
    lines = [mark.join([*header, *HEADER.split(",")])]
    lines += [mark.join([*cells(int(t)), *ROW.split(",")]) for t in TIMES[:rows]]
    return "\n".join(lines) + "\n"


def date_of(time, form):
    """Return a time in a form of strftime, to the second."""
    return (UTC_START + timedelta(seconds=time // 10**9)).strftime(form)


def milliseconds(time):
    return f"{time // 10**6 % 1000:03d}"


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        (("stamp_sec", "stamp_nanosec"), 1),
        (("header.stamp.sec", "header.stamp.nanosec"), 1),
        (("header.stamp.secs", "header.stamp.nsecs"), 1),
        (("field.header.stamp.secs", "field.header.stamp.nsecs"), 1),
        (("/imu/header/stamp/sec", "/imu/header/stamp/nanosec"), 1),
        (("secs", "nsecs"), 1),
        (("sec", "usec"), 1000),
        (("tv_sec", "tv_usec"), 1000),
        (("time_s", "time_ms"), 10**6),
        (("timestamp_s", "timestamp_ns"), 1),
        (("Seconds", "Nanoseconds"), 1),
        (("time [s]", "millis"), 10**6),
        (("Timestamp (s)", "Timestamp (ns)"), 1),
        (("s", "ns"), 1),
        (("stamp_int", "stamp_nsec"), 1),
        (("stamp [s]", "stamp [us]"), 1000),
        (("timestampSec", "timestampNanoSec"), 1),
        (("headerStampSecs", "headerStampNanosecs"), 1),
    ],
)
def test_a_stamp_split_into_two_columns_is_one(text_log, header, unit):
    texts = (
        table(header, lambda t: (str(t // 10**9), str(t % 10**9 // unit))),
        table(header[::-1], lambda t: (str(t % 10**9 // unit), str(t // 10**9))),
    )
    for text in texts:
        (imu,) = read(text_log(text)).imus
        assert imu.angular_rate.time.tolist() == TIMES.tolist()
        assert (imu.origin.epoch, imu.origin.repairs) == ("unix", ())


@pytest.mark.parametrize(
    ("name", "unit"), [("millis", 10**6), ("micros", 1000), ("ms", 10**6), ("Milliseconds", 10**6)]
)
def test_a_column_whose_name_is_a_unit_of_time_alone_is_a_time(text_log, name, unit):
    (imu,) = read(text_log(table([name], lambda t: (str((t - START) // unit),)))).imus
    assert imu.angular_rate.time.tolist() == (TIMES - START).tolist()


def test_a_fraction_of_a_second_that_falls_back_is_no_time(text_log):
    with pytest.raises(UsageError, match="--rate"):
        read(text_log(table(["ms"], lambda t: (str(t // 10**6 % 1000),))))


@pytest.mark.parametrize(
    "header", [("week", "sec", "frac"), ("frac", "tow", "GPS Week"), ("Week", "TOW (s)", "fraction of second [s]")][:2]
)
def test_a_week_whole_seconds_and_their_fraction_are_one_stamp(text_log, header):
    def cells(time):
        week, rest = divmod(time // 10**9 - 315_964_800 + 18, 604_800)
        named = {"week": str(week), "sec": str(rest), "tow": str(rest), "frac": f"0.{time % 10**9:09d}"}
        return tuple(named[name.lower().split()[-1]] for name in header)

    (imu,) = read(text_log(table(header, cells))).imus
    assert imu.angular_rate.time.tolist() == TIMES.tolist()


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        (("date", "time"), lambda t: (date_of(t, "%Y-%m-%d"), f"{date_of(t, '%H:%M:%S')}.{milliseconds(t)}")),
        (("Time", "Date"), lambda t: (f"{date_of(t, '%H:%M:%S')}.{milliseconds(t)}", date_of(t, "%d.%m.%Y"))),
        (("date", "time"), lambda t: (date_of(t, "%Y%m%d"), f"{date_of(t, '%H:%M:%S')},{milliseconds(t)}")),
        (("date", "time"), lambda t: (date_of(t, "%m/%d/%Y"), f"{date_of(t, '%H:%M:%S')}:{milliseconds(t)}")),
        (("when",), lambda t: (f"{date_of(t, '%Y-%m-%d %H:%M:%S')}:{milliseconds(t)}",)),
        (("YYYY-MO-DD HH-MI-SS_SSS",), lambda t: (f"{date_of(t, '%Y-%m-%d %H-%M-%S')}_{milliseconds(t)}",)),
        (("time",), lambda t: (f"{date_of(t, '%Y/%m/%d %H:%M:%S')}.{milliseconds(t)}",)),
        (("time",), lambda t: (f"{date_of(t, '%d-%b-%Y %H:%M:%S')}.{milliseconds(t)}",)),
        (("time",), lambda t: (f"{date_of(t, '%m/%d/%Y %I:%M:%S')}.{milliseconds(t)} PM",)),
        (("time",), lambda t: (f"{date_of(t, '%Y%m%dT%H%M%S')}.{milliseconds(t)}Z",)),
        (("time",), lambda t: (f"{date_of(t + 7200 * 10**9, '%Y-%m-%dT%H:%M:%S')}.{milliseconds(t)}+0200",)),
        (("time",), lambda t: (f"{date_of(t, '%Y-%m-%dT%H:%M:%S')}.{milliseconds(t)} UTC",)),
        (("year", "month", "day", "hour", "minute", "second"), lambda t: (
            *(str(int(date_of(t, f"%{x}"))) for x in "YmdHM"), f"{int(date_of(t, '%S'))}.{milliseconds(t)}")),
        (("Year", "Month", "Day", "Hour", "Minute", "Second", "Nanosecond"), lambda t: (
            *(date_of(t, f"%{x}") for x in "YmdHMS"), str(t % 10**9))),
    ],
)  # fmt: skip
def test_dates_and_times_of_day_in_many_forms(text_log, header, cells):
    (imu,) = read(text_log(table(header, cells, mark=";"))).imus
    assert imu.angular_rate.time.tolist() == TIMES.tolist()
    assert (imu.origin.epoch, imu.origin.repairs) == ("unix", ())


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        (("time",), lambda late: (f"{date_of(late, '%H:%M:%S')}.{milliseconds(late)}",)),
        (("hour", "min", "sec", "ms"), lambda late: (*(str(int(date_of(late, f"%{x}"))) for x in "HMS"), str(late // 10**6 % 1000))),
        (("Hour", "Minute", "Second"), lambda late: (*(date_of(late, f"%{x}") for x in "HM"), f"{date_of(late, '%S')}.{milliseconds(late)}")),
    ],
)  # fmt: skip
def test_times_of_day_go_on_after_midnight(text_log, header, cells):
    day = 86_400 * 10**9
    log = read(text_log(table(header, lambda t: cells((day - 10**9 + t - START) % day))))
    assert log.imus[0].angular_rate.time.tolist() == (TIMES - START + day - 10**9).tolist()
    assert log.imus[0].origin.epoch == "log"
    assert "time_of_day" in ids(log.notes)


def test_a_day_that_may_be_a_month_is_refused(text_log):
    text = table(("time",), lambda t: (f"03/04/2024 {date_of(t, '%H:%M:%S')}.{milliseconds(t)}",))
    with pytest.raises(UsageError, match=r"'time'.*'03/04/2024"):
        read(text_log(text))


RECEIVED = 40_000_000  # a message is recorded later by so much


def exported(names):
    """Return an export of a bag: the time of recording, then the message's own stamp."""
    own = (lambda t: (str(t),)) if len(names) == 2 else (lambda t: (str(t // 10**9), str(t % 10**9)))
    return table(names, lambda t: (str(t + RECEIVED), *own(t)))


@pytest.mark.parametrize("names", [("Time", "header.stamp"), ("%time", "field.header.stamp"), ("rosbagTimestamp", "secs", "nsecs"),
    ("Time", "header.stamp.secs", "header.stamp.nsecs"), ("log_time", "header.stamp.sec", "header.stamp.nanosec")])  # fmt: skip
def test_a_message_s_own_stamp_goes_before_that_of_its_recording(text_log, names):
    path = text_log(exported(names))
    log = read(path)
    assert log.imus[0].angular_rate.time.tolist() == TIMES.tolist()
    (note,) = (note for note in log.notes if note.id == "time_column")
    assert names[0].lstrip("%") in note
    received = read(path, ReadOptions(time_source="log"))
    assert received.imus[0].angular_rate.time.tolist() == (TIMES + RECEIVED).tolist()


@pytest.mark.parametrize("name", ["Time", "time", " Time "])
def test_a_column_is_chosen_by_its_name(text_log, name):
    path = text_log(exported(("Time", "header.stamp.secs", "header.stamp.nsecs")))
    assert read(path, ReadOptions(time_source=name)).imus[0].angular_rate.time[0] == START + RECEIVED
    assert read(path, ReadOptions(time_source="header.stamp")).imus[0].angular_rate.time[0] == START
    assert read(path, ReadOptions(time_source="header.stamp.nsecs")).imus[0].angular_rate.time[0] == START


def test_a_column_that_is_not_there_is_named_with_those_that_are(text_log):
    with pytest.raises(UsageError, match=r"'clock'.*Time.*header\.stamp|'clock'.*header\.stamp.*Time"):
        read(text_log(exported(("Time", "header.stamp"))), ReadOptions(time_source="clock"))


def test_a_source_that_no_column_has_is_noted(text_log):
    log = read(text_log(table(("time_ns",), lambda t: (str(t),))), ReadOptions(time_source="publish"))
    assert "time_source_unused" in ids(log.notes)


def test_a_log_of_messages_has_no_columns_to_name(mcap, ros):
    path = mcap.write(mcap.Topic([(START, ros.imu(START, (1, 2, 3), (0, 0, 9.8)))]))
    with pytest.raises(UsageError, match="time_source is 'Time'.*header or log or publish"):
        read(path, ReadOptions(time_source="Time"))


def test_a_stamp_that_stands_still_gives_way_to_one_that_runs(text_log):
    log = read(text_log(table(("Time", "header.stamp"), lambda t: (str(t), "0"))))
    assert log.imus[0].angular_rate.time.tolist() == TIMES.tolist()


def test_whole_seconds_beside_an_unknown_fraction_are_refused(text_log):
    text = table(("time_s", "remainder"), lambda t: (str(t // 10**9), str(t % 10**9)))
    with pytest.raises(UsageError, match=r"'time_s'.*'remainder'"):
        read(text_log(text))
    names = ("time_sec", "time_nanosec", *HEADER.split(","))
    assert read(text_log(text), ReadOptions(columns=names)).imus[0].angular_rate.time.tolist() == TIMES.tolist()


def test_a_second_stamp_in_a_finer_unit_is_no_fraction(text_log):
    text = table(("time [s]", "time [us]"), lambda t: (str((t - START) // 10**9), str((t - START) // 1000)))
    assert read(text_log(text)).imus[0].angular_rate.time.tolist() == (TIMES - START).tolist()


def test_a_fraction_beyond_a_second_costs_its_row(text_log):
    lines = table(("sec", "nanosec"), lambda t: (str(t // 10**9), str(t % 10**9)), rows=300).splitlines()
    lines[280] = f"1700000001,1000000000,{ROW}"
    (imu,) = read(text_log("\n".join([*lines, ""]))).imus
    assert len(imu.angular_rate) == 299
    assert [repair.count for repair in imu.origin.repairs] == [1]


@pytest.mark.parametrize("header", [("date", "time"), ("Date(YYYYMMDD)", "Time(HHMMSS.sss)"), ("utc_date", "utc_time")])
@pytest.mark.parametrize(
    "clock",
    [
        lambda t: f"{date_of(t, '%H%M%S')}.{milliseconds(t)}",
        lambda t: f"{int(date_of(t, '%H%M%S'))}.{milliseconds(t)}",  # a number has no zeros before it
    ],
)
def test_a_date_and_a_time_of_day_as_numbers(tmp_path, monkeypatch, header, clock):
    midnight = (START // (86_400 * 10**9) + 1) * 86_400 * 10**9
    monkeypatch.setattr("tests.readers.text.test_stamps.TIMES", midnight - 1_000_000_000 + STEP * np.arange(ROWS))
    path = tmp_path / "log.csv"
    path.write_text(table(header, lambda t: (date_of(t, "%Y%m%d"), clock(t))))
    (imu,) = read(path).imus
    assert imu.origin.epoch == "unix"
    assert imu.angular_rate.time.tolist() == [midnight - 1_000_000_000 + STEP * i for i in range(ROWS)]


def test_seconds_of_the_day_beside_a_date_are_no_times_of_day(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(table(("date", "time"), lambda t: (date_of(t, "%Y%m%d"), f"{t / 1e9 % 86_400:.3f}"), rows=50))
    with pytest.raises(UsageError, match="unit of time column 'time' is unknown"):
        read(path)
