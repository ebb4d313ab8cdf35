"""The time of text logs: units, dates, scales, order."""

from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.errors import UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from tests.readers.repairs import repairs
from tests.readers.text.csv_writer import DEG, HEADER, timed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "cells", "expected"),
    [
        ("time_s", ("0.123456789", "0.2"), [123_456_789, 200_000_000]),
        ("time_s", ("1714564800.123456789", "1714564801"), [1_714_564_800_123_456_789, 1_714_564_801_000_000_000]),
        ("time_s", ("0", "0.5"), [0, 500_000_000]),
        ("time_s", ("-0.5", "0.25"), [-500_000_000, 250_000_000]),
        ("time_s", ("0.0", "5e-05"), [0, 50_000]),
        ("time_s", ("1e-3", "2e-3"), [1_000_000, 2_000_000]),
        ("time_s", ("0.0", "0.010000000000001"), [0, 10_000_000]),
        ("time_ms", ("5", "15"), [5_000_000, 15_000_000]),
        ("time_ms", ("0.5", "15.25"), [500_000, 15_250_000]),
        ("time_ms", ("0", "2.5", "5"), [0, 2_500_000, 5_000_000]),
        ("t [us]", ("5", "10000"), [5_000, 10_000_000]),
        ("t (ns)", ("1714564800123456789", "1714564800123456790"), [1_714_564_800_123_456_789, 1_714_564_800_123_456_790]),
        ("time", ("2024-05-01T12:00:00", "2024-05-01T12:00:00.5"), [1_714_564_800_000_000_000, 1_714_564_800_500_000_000]),
        ("time", ("2024-05-01T12:00:00Z", "2024-05-01T12:00:00.5Z"), [1_714_564_800_000_000_000, 1_714_564_800_500_000_000]),
        ("time", ("2024-05-01T14:00:00+02:00", "2024-05-01T12:00:01Z"), [1_714_564_800_000_000_000, 1_714_564_801_000_000_000]),
        ("time", ("2024-05-01 12:00:00.123456789", "2024-05-01 12:00:01"), [1_714_564_800_123_456_789, 1_714_564_801_000_000_000]),
    ],
)  # fmt: skip
def test_times_are_exact(imu_of, name, cells, expected):
    assert imu_of(timed(name, *cells)).angular_rate.time.tolist() == expected


@pytest.mark.parametrize(
    ("name", "cells"),
    [
        ("time_s", ("0.0", "99999999999999")),
        ("time_s", ("0.0", "-99999999999999")),
        ("time_s", ("0.0", "1" * 40)),
        ("time_s", ("0.0", "inf")),
        ("time_s", ("0.0", "nan")),
        ("time_s", ("0e0", "9.3e9")),
        ("time_ms", ("0", "9223372036854775")),
        ("time_ms", ("0", "9223372036854775.5")),
        ("time_ms", ("0", "99999999999999999999")),
        ("time_ms", ("0", "inf")),
    ],
)
def test_times_that_no_clock_can_show_cost_their_row(imu_of, name, cells):
    imu = imu_of(timed(name, *cells, "1"))
    assert imu.angular_rate.time.tolist() == [0, 10**9 if name == "time_s" else 10**6]
    assert repairs(imu)["no_time"] == 1


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(0, 2 * 10**18), min_size=2, max_size=5, unique=True).map(sorted))
def test_seconds_with_nine_digits_are_exact(text_log, times):
    cells = (f"{Decimal(time) / 10**9:.9f}" for time in times)
    time = read(text_log(timed("time_s", *cells))).imus[0].angular_rate.time
    # Over so few rows nothing is ever out of order or repeated.
    assert time.tolist() == times


@pytest.mark.parametrize(
    ("cell", "ns", "unit"),
    [
        ("1714564800.5", 1_714_564_800_500_000_000, "s"),
        ("1714564800500", 1_714_564_800_500_000_000, "ms"),
        ("1714564800500000", 1_714_564_800_500_000_000, "us"),
        ("1714564800500000000", 1_714_564_800_500_000_000, "ns"),
    ],
)
def test_a_unix_time_has_the_unit_of_its_size(text_log, cell, ns, unit):
    log = read(text_log(timed("time", cell)))
    assert log.imus[0].angular_rate.time.tolist() == [ns]
    assert log.imus[0].origin.epoch == "unix"
    (note,) = (note for note in log.notes if note.id == "time_unit_guessed")
    assert f" {unit} " in note


def test_a_stated_rate_beats_the_time_column_and_is_recorded(text_log):
    (imu,) = read(text_log(timed("time_s", "5.0", "5.1")), ReadOptions(rate=4.0)).imus
    assert imu.angular_rate.time.tolist() == [5_000_000_000, 5_250_000_000]
    assert repairs(imu) == {"stated_rate": 2}


def test_rows_out_of_order_are_sorted_with_their_values_and_repeats_dropped(imu_of):
    rows = "".join(
        f"{time},{i},0,0,0,0,-1\n" for i, time in ((0, "0.0"), (1, "0.2"), (2, "0.1"), (2, "0.1"), (4, "0.3"))
    )
    imu = imu_of(f"time_s,{HEADER}\n{rows}")
    assert imu.angular_rate.time.tolist() == [0, 100_000_000, 200_000_000, 300_000_000]
    np.testing.assert_allclose(imu.angular_rate.value[:, 0] / DEG, [0, 2, 1, 4])
    assert {"out_of_order", "repeated_row"} == set(repairs(imu))


class TestTimeScale:
    UNIX = 1_714_564_818

    @pytest.mark.parametrize("name", ["gpst_s", "gps_time_s", "t_gps_s", "t_gpst_unix_s", "time_gps_s"])
    def test_a_name_of_gps_time_takes_off_leap_seconds(self, text_log, name):
        log = read(text_log(timed(name, f"{self.UNIX}.5", f"{self.UNIX + 1}.5")))
        assert log.imus[0].angular_rate.time[0] == (self.UNIX - 18) * 10**9 + 500_000_000
        assert ids(log.notes) == ("gps_time",)
        assert "18 leap seconds" in log.notes[0]

    @pytest.mark.parametrize("name", ["time_s", "unix_s", "tgpsx_time_s"])
    def test_another_name_is_taken_as_utc_with_a_note(self, text_log, name):
        log = read(text_log(timed(name, f"{self.UNIX}.5", f"{self.UNIX + 1}.5")))
        assert log.imus[0].angular_rate.time[0] == self.UNIX * 10**9 + 500_000_000
        assert ids(log.notes) == ("taken_as_utc",)

    def test_a_name_of_utc_needs_no_note(self, text_log):
        log = read(text_log(timed("gps_utc_time_s", f"{self.UNIX}.5", f"{self.UNIX + 1}.5")))
        assert (log.imus[0].angular_rate.time[0] // 10**9, log.notes) == (self.UNIX, ())

    def test_seconds_since_the_log_s_start_are_no_gps_time(self, text_log):
        log = read(text_log(timed("gps_time_s", "1.5", "2.5")))
        assert (log.imus[0].angular_rate.time[0], log.notes) == (1_500_000_000, ())

    @pytest.mark.parametrize("epoch", ["boot", "log", "unix"])
    def test_a_sidecar_states_where_times_count_from(self, text_log, epoch):
        log = read(
            text_log(timed("gps_time_s", f"{self.UNIX}.5", f"{self.UNIX + 1}.5"), sidecar=f'epoch = "{epoch}"\n')
        )
        imu = log.imus[0]
        assert (imu.origin.epoch, imu.angular_rate.time[0] // 10**9) == (epoch, self.UNIX)
        assert ids(log.notes) == ("sidecar",)
        assert "log.toml" in log.notes[0]

    def test_another_epoch_is_refused(self, text_log):
        with pytest.raises(UsageError, match=r"log\.toml: epoch is 'gps'"):
            read(text_log(timed("time_s", "0", "1"), sidecar='epoch = "gps"\n'))


def counted(name, step, rows=60):
    """Return a log whose times rise by a step, in a column of a name."""
    return timed(name, *(f"{i * step:.7g}" for i in range(rows)))


@pytest.mark.parametrize(
    ("name", "step", "likely"), [("Time (ms)", 0.01, "s"), ("time_us", 10, "ms"), ("timestamp [ns]", 5000, "us")]
)
def test_a_unit_in_which_no_imu_samples_so_fast_is_refused(text_log, name, step, likely):
    log = text_log(counted(name, step))
    with pytest.raises(UsageError, match=rf"--units time={likely}$"):
        read(log)
    (imu,) = read(log, ReadOptions(units={"time": likely})).imus
    assert len(imu.angular_rate) == 60


def test_a_unit_in_which_an_imu_is_very_slow_is_named(text_log):
    assert "slow_time" in ids(read(text_log(counted("time_s", 10))).notes)
    assert "slow_time" not in ids(read(text_log(counted("time_ms", 10))).notes)


@pytest.mark.parametrize(("name", "likely"), [("time_s", "ns"), ("time_s", "us"), ("time_s", "ms"), ("time_ms", "ns")])
def test_a_unit_in_which_the_log_is_later_than_any_is_refused(text_log, name, likely):
    lines = [f"{name},gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2"]
    scale = {"ms": 10**3, "us": 10**6, "ns": 10**9}[likely]
    lines += [f"{(1_714_564_800 * 100 + i) * scale // 100},0.1,0.2,0.{i % 7},0,0,9.8" for i in range(50)]
    with pytest.raises(UsageError, match=f"its unit is likely {likely}: --units time={likely}"):
        read(text_log("\n".join(lines) + "\n"))


def test_a_clock_that_stands_still_gives_no_rate(text_log):
    (imu,) = read(text_log(timed("time_s", *["5.0"] * 60).replace(",1,2", ",1,{}").format(*range(60)))).imus
    assert len(imu.angular_rate) == 1
    assert repairs(imu) == {"frozen_clock": 59}
