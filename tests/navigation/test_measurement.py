"""From an IMU's stream to even steps: gaps, jitter, clocks and mounting."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.log import ImuStream, Log, Provenance, Scalars, Triad
from imuwb.navigation.filter import solve
from imuwb.navigation.filter_model import Installation
from imuwb.navigation.measurement import LONGEST_GAP, measurement_of
from imuwb.notes import ids

N, DT = 6000, 0.01
FLAT = Installation()


def signals(t):
    """Return what gyros and accelerometers average over the step that ends at t, and their integrals."""
    p = np.array([0.7, 0.9, 1.3])

    def integral(t, phase):
        return -np.cos(np.outer(t, p) + phase) / p

    both = [(integral(t, a) - integral(t - DT, a)) / DT for a in (0.0, 1.0)]
    return *both, integral


def log_of(time, *, keep=None, accel_time=None, celsius=None):
    """Return a log of these stamps; the values are those of the even clock."""
    t = DT * np.arange(1, N + 1)
    gyro, accel, integral = signals(t)
    stamps = np.rint(np.asarray(time) * 1e9).astype(np.int64) + 1_700_000_000_000_000_000
    keep = np.arange(N) if keep is None else keep
    triads = [Triad(stamps[keep], gyro[keep]), Triad(stamps[keep], accel[keep])]
    if accel_time is not None:
        width = np.diff(accel_time, prepend=2 * accel_time[0] - accel_time[1])
        values = (integral(accel_time, 1.0) - integral(accel_time - width, 1.0)) / width[:, None]
        triads[1] = Triad(np.rint(accel_time * 1e9).astype(np.int64) + 1_700_000_000_000_000_000, values)
    temperature = None if celsius is None else Scalars("t", stamps[::100], celsius(t[::100]))
    imu = ImuStream("/imu", *triads, temperature)
    return Log(Provenance("made.csv", "csv", "sha256:0", 0), imus=(imu,), zero=1_700_000_000_000_000_000)


def found_of(log, installation=FLAT, **options):
    return measurement_of(log, log.imu(), installation, **options)


EVEN = DT * np.arange(1, N + 1)


def test_even_samples_become_increments():
    log = log_of(EVEN)
    found = found_of(log)
    gyro, accel, _ = signals(EVEN)
    assert found.interval == pytest.approx(DT, rel=1e-9)
    assert found.time == pytest.approx(EVEN, abs=1e-8)
    assert found.samples.angle == pytest.approx(gyro * DT, abs=1e-9)
    assert found.samples.velocity == pytest.approx(accel * DT, abs=1e-9)
    assert found.notes == ()
    assert found.celsius == (None,)
    assert not found.bridged.size


@pytest.mark.parametrize("share", [0.05, 0.2])
def test_jitter_is_set_right(share):
    rng = np.random.default_rng(2)
    found = found_of(log_of(EVEN + rng.uniform(-share, share, N) * DT))
    assert found.time.size == N
    assert np.abs(found.time - EVEN).max() < share * DT / 10
    assert found.samples.angle == pytest.approx(signals(EVEN)[0] * DT, rel=1e-4)
    assert found.notes == ()


@pytest.mark.parametrize("share", [0.3, 0.45])
def test_strong_jitter_is_set_right_too(share):
    rng = np.random.default_rng(2)
    found = found_of(log_of(EVEN + rng.uniform(-share, share, N) * DT))
    assert found.time.size == N
    assert np.abs(found.time - EVEN).max() < share * DT / 10


@pytest.mark.parametrize(("first", "width"), [(1000, 1), (2000, 4), (3000, 300)])
def test_a_gap_is_bridged_by_straight_lines_and_noted(first, width):
    keep = np.delete(np.arange(N), slice(first, first + width))
    found = found_of(log_of(EVEN, keep=keep))
    assert found.time == pytest.approx(EVEN, abs=1e-7)
    gyro = signals(EVEN)[0]
    inside = np.arange(first, first + width)
    expected = [np.interp(inside, [first - 1, first + width], gyro[[first - 1, first + width], i]) for i in range(3)]
    assert found.samples.angle[inside] == pytest.approx(np.stack(expected, axis=1) * DT, abs=1e-9)
    assert found.samples.angle[keep] == pytest.approx(gyro[keep] * DT, abs=1e-9)
    assert ids(found.notes) == ("imu-gaps",)
    assert found.notes[0].startswith(f"{width} samples")
    if width * DT > 0.05:
        assert found.bridged == pytest.approx(np.array([[EVEN[first - 1], EVEN[first + width - 1]]]), abs=1e-7)
    else:
        assert not found.bridged.size


def test_behind_a_long_gap_a_new_log_begins():
    late = EVEN + (np.arange(N) >= 2000) * (LONGEST_GAP + 1)
    found = found_of(log_of(late))
    assert found.time.size == 4000
    assert found.time[0] == pytest.approx(late[2000])
    assert ids(found.notes) == ("imu-part",)
    assert "31.0 s to 71.0 s" in found.notes[0]


def test_an_accelerometer_on_another_clock_is_put_on_the_gyros():
    other = 0.003 + 0.0043 * np.arange(14_000)
    found = found_of(log_of(EVEN, accel_time=other))
    inside = slice(5, -5)
    assert found.samples.velocity[inside] == pytest.approx(signals(EVEN)[1][inside] * DT, abs=3e-4 * DT)
    assert ids(found.notes) == ("accelerometer-clock",)
    # Nothing is lost or doubled: the integral is that of the motion.
    integral = signals(EVEN)[2]
    expected = integral(EVEN[[5, -5]], 1.0)
    assert found.samples.velocity[6:-4].sum(axis=0) == pytest.approx(expected[1] - expected[0], abs=1e-5)


def test_a_skewed_accelerometer_is_shifted_back():
    log = log_of(EVEN, accel_time=EVEN.copy())
    late = replace(
        log.imus[0],
        specific_force=Triad(log.imus[0].specific_force.time + 23_000_000, log.imus[0].specific_force.value),
    )
    found = measurement_of(log, late, Installation(skew=0.023))
    assert found.samples.velocity[5:-5] == pytest.approx(signals(EVEN)[1][5:-5] * DT, abs=1e-6 * DT + 3e-4 * DT)


def test_a_clocks_rate_stretches_steps_and_increments():
    rate = 1.000275
    found = found_of(log_of(EVEN), Installation(clock_rate=rate))
    plain = found_of(log_of(EVEN))
    assert found.interval == pytest.approx(DT * rate)
    assert found.time - found.time[0] == pytest.approx((EVEN - EVEN[0]) * rate, abs=1e-7)
    assert found.samples.interval == pytest.approx(plain.samples.interval * rate)
    assert found.samples.angle == pytest.approx(plain.samples.angle * rate)


def test_a_bridged_gap_lies_where_its_samples_do():
    keep = np.delete(np.arange(N), slice(5000, 5100))
    found = found_of(log_of(EVEN, keep=keep), Installation(clock_rate=1.01))
    assert found.bridged[0] == pytest.approx(found.time[[4999, 5099]], abs=1e-6)


def test_an_accelerometers_own_gap_is_noted():
    other = np.delete(EVEN, slice(3000, 3200))
    found = found_of(log_of(EVEN, accel_time=other))
    assert found.bridged == pytest.approx(np.array([[EVEN[2999], EVEN[3200]]]), abs=1e-7)
    assert ids(found.notes) == ("accelerometer-gaps", "accelerometer-clock")


@pytest.mark.parametrize(("missing", "noted"), [(4, False), (5, True)])
def test_a_noted_gap_of_an_accelerometer_is_longer_than_50_ms(missing, noted):
    other = np.delete(EVEN + 1e-3, slice(3000, 3000 + missing))
    assert bool(found_of(log_of(EVEN, accel_time=other)).bridged.size) == noted


@pytest.mark.parametrize(("share", "noted"), [(1.7, False), (1.9, True)])
def test_a_gap_of_an_accelerometer_is_longer_than_1_8_intervals(share, noted):
    """At 10 Hz, where every step is longer than 50 ms."""
    other = 0.1 * np.arange(1, 600.0)
    other[300:] += (share - 1) * 0.1
    assert bool(found_of(log_of(EVEN, accel_time=other[other < 60])).bridged.size) == noted


@pytest.mark.parametrize(("seconds", "parts"), [(9.9, 1), (10.1, 2)])
def test_a_gap_up_to_ten_seconds_is_bridged(seconds, parts):
    late = EVEN + (np.arange(N) >= 2000) * seconds
    found = found_of(log_of(late))
    assert (found.time.size == 4000) == (parts == 2)
    assert ("imu-part" in ids(found.notes)) == (parts == 2)


def test_the_noise_in_a_gap_is_that_of_unknown_motion():
    """Motion with the variance seen elsewhere and a correlation time of half a second has the density 2 sigma² T."""
    keep = np.delete(np.arange(N), slice(3000, 3100))
    found = found_of(log_of(EVEN, keep=keep))
    outside = np.delete(np.arange(N), slice(3000, 3110))  # ten samples after a gap count as part of it
    gyro, accel, _ = signals(EVEN)
    density = 2 * 0.5 * np.concatenate([gyro[outside].var(axis=0), accel[outside].var(axis=0)])
    assert found.gap_noise == pytest.approx(density, rel=1e-6)
    assert np.flatnonzero(found.samples.regime).tolist() == list(range(3000, 3110))
    assert found.celsius == (None, None)
    assert found_of(log_of(EVEN)).gap_noise is None


def test_the_filter_has_that_noise_in_the_gap_alone():
    from imuwb.navigation.filter_model import FilterModel, Settings
    from imuwb.simulation import mixed_route

    from . import drives

    model = FilterModel("m", drives.plain(), settings=Settings(every=10))
    whole = drives.prepared(model, mixed_route(120, 3))
    imu = whole.log.imus[0]
    keep = np.abs(np.arange(len(imu.angular_rate)) - 10_000) > 100
    triads = [Triad(t.time[keep], t.value[keep]) for t in (imu.angular_rate, imu.specific_force)]
    made = drives.prepared(model, log=replace(whole.log, imus=(ImuStream(imu.name, *triads),)))
    tables = solve(model, made.measurement, made.corrections, made.alignment).tables
    assert tables.white[1] - tables.white[0] == pytest.approx(made.measurement.gap_noise)


@pytest.mark.parametrize("mounting", [(0.0, 0.0, 90.0), (180.0, 0.0, 0.0), (10.0, -20.0, 130.0)])
def test_axes_are_turned_into_the_vehicles(mounting):
    from scipy.spatial.transform import Rotation

    found, plain = found_of(log_of(EVEN), Installation(mounting=mounting)), found_of(log_of(EVEN))
    turn = Rotation.from_euler("ZYX", mounting[::-1], degrees=True).inv()  # it turns vectors from vehicle to IMU
    assert found.samples.angle == pytest.approx(turn.apply(plain.samples.angle), abs=1e-15)
    assert found.samples.velocity == pytest.approx(turn.apply(plain.samples.velocity), abs=1e-15)


def test_temperatures_make_regimes():
    log = log_of(EVEN, celsius=lambda t: 20.5 + t / 10)
    found = found_of(log, thermal=True)
    assert found.celsius == (21.0, 23.0, 25.0, 27.0)  # regimes of 2 °C
    of_each = np.array(found.celsius)[found.samples.regime]
    assert np.abs(of_each - (20.5 + EVEN / 10)).max() <= 1.2
    cold = found_of(log_of(EVEN), thermal=True)
    assert cold.celsius == (None,)
    assert ids(cold.notes) == ("no-temperature",)


@pytest.mark.parametrize("lacking", ["angular_rate", "specific_force"])
def test_what_lacks_a_triad_cannot_navigate(lacking):
    log = log_of(EVEN)
    with pytest.raises(MissingDataError, match="made.csv: /imu has no (gyro|accelerometer)"):
        measurement_of(log, replace(log.imus[0], **{lacking: None}), FLAT)
    short = log_of(EVEN, keep=np.arange(99))
    with pytest.raises(MissingDataError, match="fewer than 100 samples"):
        found_of(short)
    assert found_of(log_of(EVEN, keep=np.arange(100))).time.size == 100
