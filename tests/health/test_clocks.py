"""Faults of a clock: jumps, gaps, batches, drops of the rate, jitter, and what the reader mended."""

import numpy as np
import pytest

from imuwb.health import check
from imuwb.health.clocks import clock_faults
from imuwb.health.fault import repair_faults
from imuwb.log import Repair
from imuwb.notes import Note
from imuwb.readers import read

N = 6000


def found(time, *, inertial=True):
    return list(clock_faults("imu", np.asarray(time, float), inertial=inertial))


def even(n=N, step=0.01):
    return np.arange(n) * step


def without(*spans):
    keep = np.ones(N, bool)
    for begin, end in spans:
        keep[begin:end] = False
    return even()[keep]


def test_an_even_clock_has_no_fault():
    assert found(even()) == []


@pytest.mark.parametrize("grain", [1e-3, 1e-6])
def test_stamps_that_are_rounded_are_no_fault(grain):
    assert found(np.round(even(step=1 / 130) / grain) * grain) == []


@pytest.mark.parametrize(("step", "faults"), [(10.0, ["slow clock"]), (1.0, [])])
def test_an_imu_that_is_too_slow_shows_a_wrong_unit_of_time(step, faults):
    assert [fault.kind for fault in found(even(step=step)) if fault.severity == "fault"] == faults
    assert not found(even(step=step), inertial=False)


@pytest.mark.parametrize("seed", range(20))
def test_little_jitter_is_no_fault(seed):
    assert found(even() + 3e-4 * np.random.default_rng(seed).standard_normal(N).clip(-4, 4)) == []


def test_gaps_are_counted_and_the_longest_has_its_place_and_length():
    (gap,) = found(without((2000, 2100), (4000, 4010)))
    assert (gap.stream, gap.severity, gap.count) == ("imu", "fault", 2)
    assert gap.kind == "gaps"
    assert "1.1 s missing (1.8 %)" in gap.what
    assert gap.start == pytest.approx(19.99)
    assert gap.length == pytest.approx(1.01)


def test_the_averaging_time_that_spans_gaps_is_named():
    (gap,) = found(without((2000, 2100), (4000, 4010)))
    assert " 10 s " in gap.consequence  # half of the 20 s that are whole
    (gap,) = found(without((1000, 1001)))
    assert " 25 s " in gap.consequence


def test_of_a_receiver_a_gap_is_only_that_there_are_no_rows():
    (gap,) = found(without((2000, 2100)), inertial=False)
    assert "1.01 s" in gap.consequence
    assert "averaging" not in gap.consequence


def test_a_gap_is_a_fault_from_a_hundredth_on():
    assert [f.severity for f in found(without((2000, 2050)))] == ["warning"]
    assert [f.severity for f in found(without((2000, 2070)))] == ["fault"]


def test_times_count_from_the_log_s_start():
    (gap,) = found(without((2000, 2100)) + 1000)
    assert gap.start == pytest.approx(1019.99)


def test_a_record_in_batches_is_a_note():
    (batch,) = found(even()[np.arange(N) % 600 < 200])
    assert batch.kind == "batches"
    assert "36 s missing (64 %)" in batch.what
    assert (batch.severity, batch.count) == ("note", 9)
    assert batch.length == pytest.approx(4.01)
    assert " 1 s " in batch.consequence


def drops(time):
    return [f for f in found(time) if f.kind == "rate drop"]


def slow(spans, factor):
    steps = np.full(N, 0.01)
    for begin, end in spans:
        steps[begin:end] *= factor
    return np.concatenate([[0], np.cumsum(steps)[:-1]])


def test_a_drop_of_the_rate_has_its_place_length_and_rate():
    (drop,) = drops(slow([(3000, 3500)], 2))
    assert "50 Hz" in drop.what
    assert (drop.severity, drop.count) == ("warning", 1)
    assert (drop.start, drop.length) == (pytest.approx(30, abs=0.01), pytest.approx(10, abs=0.02))
    assert "--start and --end" in drop.consequence


def test_drops_are_counted_and_the_longest_is_told():
    (drop,) = drops(slow([(1000, 1100), (3000, 3500), (5000, 5100)], 4))
    assert drop.count == 3
    assert drop.start == pytest.approx(33, abs=0.02)
    assert "25 Hz" in drop.what


def test_gaps_are_no_drop_of_the_rate():
    assert drops(without((2000, 2100), (4000, 4010))) == []


def test_a_slightly_slower_part_is_no_drop():
    assert drops(slow([(3000, 3500)], 1.3)) == []


def test_a_drop_of_the_rate_is_no_series_of_gaps():
    assert [f.kind for f in found(slow([(3000, 3500)], 2))] == ["rate drop"]


def test_jitter_is_told_in_parts_of_the_interval():
    scatter = np.random.default_rng(1).choice([-0.0022, 0.0022], N)
    (jitter,) = found(even() + scatter)
    assert jitter.severity == "warning"
    told = int(jitter.what.split(" by ")[1].split(" %")[0])
    assert told == pytest.approx(100 * np.diff(scatter).std() / 0.01, abs=1.5)
    assert "--time-source" in jitter.consequence


def test_what_the_reader_mended_is_counted():
    few, many = repair_faults("imu", (Repair("rows left out", 7), Repair("rows left out", 61)), N)
    assert (few.what, few.count, few.severity) == ("rows left out", 7, "warning")
    assert (many.count, many.severity) == (61, "fault")


@pytest.mark.parametrize(
    ("effect", "few", "many"),
    [
        ("lost", "warning", "fault"),
        ("time", "warning", "warning"),
        ("order", "note", "warning"),
        ("value", "warning", "fault"),
    ],
)
@pytest.mark.parametrize("share", [0.01, 0.0102])
def test_a_repair_is_as_bad_as_what_it_does(effect, few, many, share):
    (fault,) = repair_faults("imu", (Repair("mended", round(share * N), effect),), N)
    assert fault.severity == (many if share > 0.01 else few)


def test_a_clock_that_jumps_by_decades_is_named_and_the_rest_judged_without_it():
    (jump,) = found(np.concatenate([even(50), 1_716_000_000 + even()]))
    assert jump.kind == "clock jump"
    for figure in ("54.4 years", "50 rows", "6000"):
        assert figure in jump.what
    assert (jump.severity, jump.start) == ("fault", 0.49)
    assert "--start" in jump.consequence


def test_a_night_between_two_long_recordings_is_a_gap():
    two_days = even(200_000, 1.0)
    assert [f.kind for f in found(np.concatenate([two_days, two_days + 300_000]))] == ["gaps"]


def test_uneven_but_complete_logging_has_no_gaps():
    time = np.cumsum(np.where(np.arange(3000) % 2, 0.39, 0.61))
    assert {f.kind for f in found(time)} == {"jitter"}


def test_a_single_row_is_a_fault():
    (fault,) = found([0.0])
    assert (fault.kind, fault.severity) == ("single row", "fault")


@pytest.mark.parametrize(
    ("note", "effect", "severity"),
    [("arrival_stamps", "time", "warning"), ("coarse_stamps", "time", "note"), ("uneven_stamps", "time", "note"),
     ("stated_rate", "time", "note"), ("repeated_row", "lost", "note")],
)  # fmt: skip
def test_even_times_and_repeated_rows_harm_little(note, effect, severity):
    (fault,) = repair_faults("imu", (Repair(Note(note, "mended"), N // 2, effect),), N // 2)
    assert (fault.kind, fault.severity, fault.count) == (
        note.replace("_", " "),
        severity,
        1 if effect == "time" else N // 2,
    )


def test_a_last_line_that_is_cut_is_a_note():
    assert [f.severity for f in repair_faults("imu", (Repair("cut", 1),), 20_000)] == ["note"]


def test_the_share_of_lost_rows_is_that_of_all_rows():
    (fault,) = repair_faults("imu", (Repair("left out", 2970),), 30)
    assert (fault.kind, fault.severity) == ("lost rows", "fault")
    assert "99 % of its rows" in fault.what


@pytest.mark.parametrize("seed", range(3))
def test_a_serial_line_is_told_as_times_of_arrival(tmp_path, seed):
    rng = np.random.default_rng(seed)
    ends = np.cumsum(rng.integers(2, 8, 2000))
    arrival = np.empty(3000)
    for first, end in zip(
        np.append(0, ends), ends, strict=False
    ):  # a burst arrives after its last sample, 1.9 ms a row
        size = max(min(end, 3000) - first, 0)
        arrival[first : first + size] = 0.01 * (end - 1) + 0.0019 * np.arange(size)
    rows = "".join(
        f"{t:.4f},{x:.5f},0.01,0.02,0.1,0.2,-9.8\n" for t, x in zip(arrival, rng.standard_normal(3000), strict=True)
    )
    path = tmp_path / "serial.csv"
    path.write_text("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n" + rows)
    log = read(path)
    kinds = {f.kind: f for f in check(log, samples=False).faults}
    assert set(kinds) == {"arrival stamps"}
    assert "no sample is missing" in kinds["arrival stamps"].what


def test_batches_with_real_gaps_stay_batches(tmp_path):
    time = np.arange(20.0)[:, None] + np.arange(512) / 4000
    rows = "".join(f"{t:.6f},{x:.5f},0.01,0.02,0.1,0.2,-9.8\n" for t, x in zip(time.ravel(), np.random.default_rng(0).standard_normal(time.size), strict=True))  # fmt: skip
    path = tmp_path / "batches.csv"
    path.write_text("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n" + rows)
    found = check(read(path), samples=False).faults
    assert {f.kind for f in found} == {"batches"}  # a note on the gaps, and a warning that the stamps may be arrivals
    assert any("87 %" in f.what for f in found)
