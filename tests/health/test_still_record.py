"""What puts an error model of a record in doubt, and what forbids it."""

import numpy as np
import pytest

from imuwb.health import Doubts, model_doubts, record_doubts, stillness_of
from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad
from imuwb.notes import Note, ids
from imuwb.stochastic import Autoregressive, AxisModel, ImuErrorModel, RandomWalk, Sum, WhiteNoise

N, RATE = 20_000, 100.0


def log_of(change=None, n=N):
    rng = np.random.default_rng(0)
    gyro, accel = rng.standard_normal((n, 3)) * 2e-3, rng.standard_normal((n, 3)) * 1e-2
    if change is not None:
        change(gyro, accel)
    time = np.rint(np.arange(n) * SECOND / RATE).astype(np.int64)
    return Log(Provenance("x", "csv", "", 0), imus=(ImuStream("imu", Triad(time, gyro), Triad(time, accel)),))


def doubts(change=None, n=N):
    log = log_of(change, n)
    return record_doubts(log, stillness_of(log))


def struck(size, axis=1, count=1):
    def change(gyro, accel):
        gyro[5000 : 5000 + 400 * count : 400, axis] = size

    return change


def heavy(share):
    def change(gyro, accel):
        gyro[np.random.default_rng(8).random(N) < share, 1] += 0.013

    return change


def turned(gyro, accel):
    gyro[8000:8700, 0] += np.sin(np.arange(700) / 20)


def bumped(gyro, accel):
    accel[8050:8055, 0] += 0.15


def driven(gyro, accel):
    t = np.arange(N) / RATE
    gyro[3000:, 2] += (np.sin(t / 7) * np.sin(t * 2))[3000:]


def test_a_still_record_is_beyond_doubt():
    assert doubts() == Doubts()


@pytest.mark.parametrize(
    ("change", "grave", "slight"),
    [
        (struck(1e6), ("disturbances", "impossible-sample"), ()),
        (struck(0.5), ("disturbances", "lone-samples"), ()),
        (struck(0.12), (), ("disturbances", "lone-samples")),
        (turned, ("disturbances",), ()),
        (heavy(0.09), ("heavy-tails",), ()),
        (heavy(0.01), (), ("heavy-tails",)),
        (bumped, (), ("disturbances",)),
        (driven, ("moving",), ()),
    ],
)
def test_what_spoils_the_coefficients_is_grave_and_the_rest_is_slight(change, grave, slight):
    found = doubts(change)
    assert (ids(found.grave), ids(found.slight)) == (grave, slight)


def test_a_record_too_short_to_judge_is_a_slight_doubt():
    assert ids(doubts(n=500).slight) == ("stillness-unknown",)


def test_where_it_happens_is_named():
    found = doubts(struck(1e6))
    assert "gyro_y" in found.grave[1]
    assert "50.00 s" in found.grave[1]


def test_an_axis_without_white_noise_is_grave():
    axes = {
        "gyro_x": AxisModel(Sum((WhiteNoise(1e-3), RandomWalk(1e-6)))),
        "gyro_y": AxisModel(Sum((RandomWalk(1e-6),))),
        "gyro_z": AxisModel(Sum((Autoregressive((-0.5,), 1e-3, 0.01),))),
        "accel_x": AxisModel(Sum((WhiteNoise(0.0),))),
        "accel_y": AxisModel(),
    }
    (note,) = model_doubts(ImuErrorModel("m", axes)).grave
    assert note.id == "no-white-noise"
    assert note.partition(":")[0] == "gyro_y, accel_x, accel_y"
    assert model_doubts(ImuErrorModel("m", {"gyro_x": axes["gyro_x"]})) == Doubts()


def test_doubts_add_up_once_each_and_take_the_name_of_a_log():
    a, b = Note("a", "one"), Note("b", "two")
    both = Doubts((a,), (b,)) + Doubts((a,), (b, a))
    assert both == Doubts((a,), (b,))
    assert both.all == (a, b)
    assert both.of("log.csv").all == ("log.csv: one", "log.csv: two")
    assert ids(both.of("log.csv").all) == ("a", "b")
