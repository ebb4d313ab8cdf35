"""Each threshold of the checks, from both sides: a little below it nothing is found, a little above it something is."""

import numpy as np
import pytest

from imuwb.health.channel import Channel
from imuwb.health.clocks import clock_faults
from imuwb.health.inertial import inertial_faults
from imuwb.health.lone import Lone, lone_samples
from imuwb.health.motion import Segment
from imuwb.health.plausibility import implausible
from imuwb.health.receivers import receiver_faults
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Provenance, Triad
from imuwb.sampling import sampling

NOISE = np.random.default_rng(0).standard_normal(6000)
NONE = Lone(np.empty(0, np.int64), np.empty(0))
G = 9.80665


def channel(values, rate=100.0):
    time = np.rint(np.arange(len(values)) * 1e9 / rate).astype(np.int64)
    return Channel("gyro_x", "/imu gyro_x", time / 1e9, values, sampling(time), np.unique(values))


def struck(size, n=6000, at=(3000,), rate=100.0):
    """Return how many lone samples are found in noise of sigma 1 where samples are off their neighbours by a size."""
    values = NOISE[:n].copy()
    for k in at:
        values[k] = max(values[k - 1], values[k + 1]) + size
    return lone_samples(channel(values, rate)).rows.size


def kinds(values, segments=(), *, lines=False, rate=100.0):
    """Return the kinds of faults of one axis."""
    axis = channel(np.asarray(values, float), rate)
    triad = Triad(
        np.rint(axis.time * 1e9).astype(np.int64),
        np.stack([axis.values, NOISE[0] + 0 * axis.values, axis.values], axis=1),
    )
    found = inertial_faults(ImuStream("/imu", triad, None), {"gyro_x": axis}, {"gyro_x": NONE}, segments, lines=lines)
    return [fault.kind for fault in found if fault.stream == "/imu gyro_x"]


def test_a_lone_sample_is_off_by_forty_times_the_usual_change():
    assert (struck(37), struck(43)) == (0, 1)


def test_a_lone_sample_is_off_by_five_steps_of_the_sensor():
    values = np.zeros(2000)
    values[::100] = 0.02
    for steps, count in ((4, 0), (5, 1)):
        values[1050] = 0.02 * steps
        assert lone_samples(channel(values)).rows.size == count


@pytest.mark.parametrize(("shaken", "count"), [(4, 1), (8, 0)])
def test_twelve_samples_on_each_side_show_what_is_usual(shaken, count):
    values = 0.1 * NOISE.copy()
    values[3000 - shaken : 3000] = 10.0 * np.arange(shaken)
    values[3000] = values[2999] + 100.0
    assert np.count_nonzero(lone_samples(channel(values)).rows == 3000) == count


def test_more_lone_samples_than_two_in_a_thousand_are_motion():
    assert (struck(80, at=range(100, 5700, 510)), struck(80, at=range(100, 5900, 440))) == (11, 0)


def test_two_lone_samples_are_never_motion():
    assert (struck(80, 500, (100, 300)), struck(80, 500, (100, 200, 300))) == (2, 0)


def test_slow_or_few_samples_are_never_lone():
    assert (struck(80, rate=22.0), struck(80, rate=18.0)) == (1, 0)
    assert (struck(80, 110, (50,)), struck(80, 90, (50,))) == (1, 0)


@pytest.mark.parametrize(("seconds", "stuck"), [(1.8, False), (2.2, True)])
def test_two_seconds_of_equal_samples_are_stuck(seconds, stuck):
    values = NOISE.copy()
    values[1000 : 1001 + round(100 * seconds)] = 0.5
    assert ("stuck" in kinds(values)) == stuck


@pytest.mark.parametrize(("seconds", "stuck"), [(3.4, False), (4.2, True)])
def test_a_channel_is_stuck_for_twenty_times_its_usual_run(seconds, stuck):
    values = np.repeat(np.arange(300) % 7, 20)  # runs of 0.19 s
    values[2000 : 2001 + round(100 * seconds)] = 3
    assert ("stuck" in kinds(values)) == stuck


@pytest.mark.parametrize(("flat", "found"), [(2, False), (3, True)])
def test_three_equal_samples_at_the_end_are_saturated(flat, found):
    values = NOISE.copy()
    values[1000 : 1000 + flat] = 9.0
    assert ("saturated" in kinds(values)) == found


def stairs(leap, count=1):
    """Return a motion of more than a thousand whole steps whose tops are flat, with leaps of some steps to them."""
    rise = np.arange(0, 1400, 0.5).round()
    top = rise[-1] + leap
    return np.concatenate([piece for _ in range(count) for piece in (rise, np.full(4, top), rise[::-1])])


@pytest.mark.parametrize(("leap", "count", "found"), [(4, 1, False), (5, 1, True), (3, 2, False), (3, 3, True)])
def test_a_leap_of_more_than_four_steps_or_three_tops_are_saturated(leap, count, found):
    assert ("saturated" in kinds(stairs(leap, count))) == found


@pytest.mark.parametrize(("sigmas", "found"), [(3.7, False), (4.3, True)])
def test_a_coarse_channel_is_saturated_four_sigmas_out(sigmas, found):
    values = np.clip(np.round(NOISE / 0.25) * 0.25, -3.0, 3.0)
    values[1000:1004] = values.std() * sigmas
    assert ("saturated" in kinds(values)) == found


@pytest.mark.parametrize(("levels", "found"), [(1050, True), (1300, False)])
def test_fifty_samples_for_each_value_are_coarse(levels, found):
    values = np.resize(np.arange(levels), 60_000) * 0.01
    assert ("step" in kinds(np.random.default_rng(1).permutation(values))) == found


@pytest.mark.parametrize(("levels", "found"), [(900, True), (1100, False)])
def test_a_channel_of_a_thousand_values_is_coarse(levels, found):
    values = np.resize(np.arange(levels), 12_000) * 0.01
    assert ("step" in kinds(np.random.default_rng(1).permutation(values))) == found


def of_gaps(gaps):
    return np.random.default_rng(2).permutation(np.resize(np.cumsum([0.0, *gaps]), 2000))


@pytest.mark.parametrize(("off", "found"), [(0.08, True), (0.13, False)])
def test_steps_are_whole_to_a_tenth(off, found):
    assert ("step" in kinds(of_gaps([1.0, *(np.full(30, 2.0 + off))]))) == found


@pytest.mark.parametrize(("odd", "found"), [(7, True), (13, False)])
def test_nine_of_ten_steps_are_whole(odd, found):
    assert ("step" in kinds(of_gaps([*np.ones(100 - odd), *np.full(odd, 1.5)]))) == found


@pytest.mark.parametrize(("moving", "found"), [(0.17, True), (0.23, False)])
def test_lines_are_looked_for_where_less_than_a_fifth_moves(moving, found):
    values = NOISE + 2 * np.sin(2 * np.pi * 13 * np.arange(6000) / 100)
    segments = (Segment(0.0, 60 * moving, moving=True), Segment(60 * moving, 60.0, moving=False))
    assert ("line" in kinds(values, segments, lines=True)) == found


def test_three_lines_of_an_axis_are_reported():
    t = np.arange(6000) / 100
    values = NOISE + sum(np.sin(2 * np.pi * f * t) for f in (3.1, 7.3, 13.7, 19.9, 29.3))
    assert kinds(values, (Segment(0.0, 60.0, moving=False),), lines=True).count("line") == 3


def implausible_kinds(rate, force, still=60.0):
    time = np.arange(6000) * (SECOND // 100)
    imu = ImuStream(
        "/imu", Triad(time, np.tile([0.0, rate, 0.0], (6000, 1))), Triad(time, np.tile([0.0, 0.0, -force], (6000, 1)))
    )
    log = Log(Provenance("made.csv", "csv", "", 0), (imu,))
    return [(fault.kind, fault.severity) for fault in implausible(log, imu, (Segment(0.0, still, moving=False),))]


@pytest.mark.parametrize(
    ("off", "found"),
    [(0.018, []), (-0.018, []), (0.022, [("gravity", "warning")]), (-0.022, [("gravity", "warning")]),
     (0.095, [("gravity", "warning")]), (0.105, [("gravity", "fault")]), (-0.105, [("gravity", "fault")])],
)  # fmt: skip
def test_gravity_may_be_off_by_two_hundredths_and_a_bias_explains_a_tenth(off, found):
    assert implausible_kinds(0.0, G * (1 + off)) == found


@pytest.mark.parametrize(
    ("rate", "found"), [(0.045, []), (-0.045, []), (0.055, [("rate", "warning")]), (-0.055, [("rate", "warning")])]
)
def test_a_still_gyro_may_be_off_by_three_degrees_a_second(rate, found):
    assert implausible_kinds(rate, G) == found


@pytest.mark.parametrize(("still", "count"), [(4.5, 0), (5.5, 2)])
def test_five_seconds_of_rest_show_gravity_and_bias(still, count):
    assert len(implausible_kinds(0.1, 9.0, still)) == count


def receiver_kinds(**changes):
    n, step = 600, 1 / 6_378_137.0
    speed = changes.get("speed", 10.0)
    position = np.zeros((n, 3))
    position[:, 1] = step * speed * np.arange(n) / 5
    velocity = np.tile([0.0, speed, 0.0], (n, 1))
    velocity[100, 1] += changes.get("spike", 0.0)
    position[300:, 1] += step * changes.get("jump", 0.0)
    for k in range(changes.get("held", 0)):
        position[10 * k + 5] = position[10 * k + 4]
    ones, sigma = np.ones((n, 3)), changes.get("sigma", 0.1)
    gnss = GnssStream("/fix", np.arange(n) * (SECOND // 5), position, velocity, sigma * ones, ones)
    return [fault.kind for fault in receiver_faults(Log(Provenance("made.csv", "csv", "", 0), gnss=(gnss,)), gnss)]


@pytest.mark.parametrize(("spike", "found"), [(28, []), (32, ["velocity spikes"])])
def test_a_lone_speed_is_a_spike_from_30_m_s_on(spike, found):
    assert receiver_kinds(spike=spike) == found


@pytest.mark.parametrize("speed", [0.5, 10.0])
def test_a_position_jumps_faster_than_20_m_s_and_three_times_the_speed(speed):
    limit = (20 + 3 * speed - speed) / 5  # m in a fifth of a second, besides the motion
    assert receiver_kinds(speed=speed, jump=0.95 * limit) == []
    assert receiver_kinds(speed=speed, jump=1.05 * limit) == ["position jumps"]


@pytest.mark.parametrize(("sigmas", "found"), [(5.7, []), (6.3, ["position jumps"])])
def test_a_position_jumps_by_more_than_six_sigmas(sigmas, found):
    assert receiver_kinds(jump=2 * sigmas, sigma=2.0) == found


@pytest.mark.parametrize(("held", "found"), [(11, []), (13, ["held rows"])])
def test_two_of_a_hundred_rows_may_be_held(held, found):
    assert receiver_kinds(speed=0.5, held=held) == found


@pytest.mark.parametrize(("speed", "found"), [(0.1, []), (0.2, ["held rows"])])
def test_a_receiver_at_rest_may_repeat_its_position(speed, found):
    assert receiver_kinds(speed=speed, held=50) == found  # 0.02 and 0.04 m from fix to fix


def clock_kinds(steps):
    return [
        (fault.kind, fault.severity)
        for fault in clock_faults("imu", np.concatenate([[0.0], np.cumsum(steps)]), inertial=True)
    ]


@pytest.mark.parametrize(("scatter", "found"), [(0.18, []), (0.22, [("jitter", "warning")])])
def test_stamps_may_scatter_by_a_fifth_of_the_interval(scatter, found):
    assert clock_kinds(0.01 * (1 + scatter * np.resize([1, 1, -1, -1], 6000))) == found


@pytest.mark.parametrize(("factor", "found"), [(1.45, []), (1.55, [("rate drop", "warning")])])
def test_the_rate_drops_where_steps_are_half_as_long_again(factor, found):
    steps = np.full(6000, 0.01)
    steps[3000:3500] *= factor
    assert clock_kinds(steps)[-1:] == found


@pytest.mark.parametrize(("length", "found"), [(20, 0), (30, 1)])
def test_the_rate_is_that_of_fifty_steps(length, found):
    steps = np.full(6000, 0.01)
    steps[3000 : 3000 + length] *= 1.7
    assert sum(kind == "rate drop" for kind, _ in clock_kinds(steps)) == found


@pytest.mark.parametrize(("windows", "found"), [(3.8, 0), (4.2, 1)])
def test_four_windows_show_a_usual_rate(windows, found):
    steps = np.full(round(50 * windows), 0.01)
    steps[50:100] *= 1.7
    assert sum(kind == "rate drop" for kind, _ in clock_kinds(steps)) == found


@pytest.mark.parametrize(("share", "found"), [(0.45, ("gaps", "fault")), (0.55, ("batches", "note"))])
def test_a_record_of_which_half_is_missing_was_made_in_batches(share, found):
    steps = np.full(6000, 0.01)
    steps[499::500] = 5.0 * share / (1 - share)
    assert clock_kinds(steps)[0] == found


@pytest.mark.parametrize(("days", "kind"), [(0.9, "batches"), (1.1, "clock jump")])
def test_a_clock_that_steps_by_a_day_was_set(days, kind):
    steps = np.full(6000, 0.01)
    steps[3000] = 86_400 * days
    assert clock_kinds(steps)[0][0] == kind


@pytest.mark.parametrize(("recorded", "kind"), [(2.1, "batches"), (1.9, "clock jump")])
def test_a_clock_that_steps_by_ten_times_the_record_was_set(recorded, kind):
    steps = np.full(20_000, 86_400 * recorded / 20_000)
    steps[10_000] = 86_400 * 20
    assert clock_kinds(steps)[0][0] == kind


@pytest.mark.parametrize(("count", "found"), [(95, 2), (105, 1)])
def test_a_hundred_gaps_of_a_stream_whose_rate_drops_are_its_lower_rate(count, found):
    steps = np.full(6000, 0.01)
    steps[3000 : 3000 + count] = 0.02
    assert len(clock_kinds(steps)) == found
