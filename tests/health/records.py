"""Records of a made IMU, still or moving, for the tests of its health."""

import numpy as np

from imuwb.health import check
from imuwb.log import ImuStream, Log, Provenance, Triad

N, RATE = 6000, 100.0
T = np.arange(N) / RATE
G = 9.80665


def log_of(gyro, accel, keep=None, temperature=None):
    """Return a log of one IMU at 100 Hz."""
    time = np.rint(np.arange(len(gyro)) * 1e9 / RATE).astype(np.int64)
    keep = np.ones(time.size, bool) if keep is None else keep
    imu = ImuStream("/imu", Triad(time[keep], gyro[keep]), Triad(time[keep], accel[keep]), temperature)
    return Log(Provenance("made.csv", "csv", "", 0), (imu,))


def still(seed=0, n=N, flicker=0.0):
    """Return white noise, and flicker noise with it, of a gyro and of an accelerometer that feels gravity."""
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((n, 6))
    if flicker:
        spectrum = np.fft.rfft(rng.standard_normal((n, 6)), axis=0)
        noise += flicker * np.fft.irfft(spectrum / np.sqrt(np.maximum(np.arange(len(spectrum)), 1))[:, None], n, axis=0)
    return 0.01 * noise[:, :3], 0.02 * noise[:, 3:] + [0, 0, -G]


def motion(seed):
    """Return a smooth motion without a period: what lies between 0.5 and 2 Hz of white noise, of size 1."""
    noise = np.fft.rfft(np.random.default_rng(1000 + seed).standard_normal((N, 6)), axis=0)
    f = np.fft.rfftfreq(N, 1 / RATE)
    noise[(f < 0.5) | (f > 2)] = 0
    moved = np.fft.irfft(noise, N, axis=0)
    return moved / moved.std(axis=0)


def faults(gyro, accel, kind="", **given):
    """Return the faults of a record, all or those of one kind."""
    return [f for f in check(log_of(gyro, accel, **given)).faults if kind in ("", f.kind)]


def changed(**columns):
    """Return a still record of which a gyro_x, or another axis, was changed by a function."""
    gyro, accel = still()
    for name, change in columns.items():
        change((gyro if name.startswith("gyro") else accel)[:, "xyz".index(name[-1])])
    return gyro, accel


def setting(*spans):
    """Return a change that sets spans of rows to values; None: to the first one of the span."""

    def change(values):
        for begin, end, value in spans:
            values[begin:end] = values[begin] if value is None else value

    return change


def coarse(step, seed=0):
    """Return a still record whose gyros have steps of that size."""
    gyro, accel = still(seed)
    return np.round(gyro / step) * step, accel
