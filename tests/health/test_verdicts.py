"""The verdict on an IMU for each fault, by what the fault does to results: one table."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.health import check
from imuwb.health.check import TOO_SHORT, VERDICTS
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Repair, Scalars, Triad
from imuwb.notes import Note

GOOD, USABLE, BAD = VERDICTS
N, RATE, G = 12_000, 100, 9.80665
T = np.arange(N) * (SECOND // RATE)


def record(gyro=None, accel=None, keep=None, **given):
    """Return a still IMU of two minutes; functions change its samples, which are given as (n, 3)."""
    rng = np.random.default_rng(0)
    rate, force = 0.005 * rng.standard_normal((N, 3)), 0.02 * rng.standard_normal((N, 3)) - [0, 0, G]
    rate, force = (x if change is None else change(x) for x, change in ((rate, gyro), (force, accel)))
    keep = np.ones(N, bool) if keep is None else keep
    return ImuStream("imu", Triad(T[keep], rate[keep]), Triad(T[keep], force[keep]), **given)


def without(*rows):
    keep = np.ones(N, bool)
    for first, last in rows:
        keep[first:last] = False
    return keep


def put(rows, value, column=0):
    def change(samples):
        samples[rows, column] = value
        return samples

    return change


def repaired(what, count, effect):
    return record(origin=Origin(repairs=(Repair(what, count, effect),)))


def far(share):
    def change(samples):
        samples[np.random.default_rng(1).random(N) < share, 0] += 0.05
        return samples

    return change


CASES = {
    "nothing": (record(), GOOD),
    # rows and times
    "six rows": (record(keep=np.arange(N) < 6), TOO_SHORT),
    "99 rows": (record(keep=np.arange(N) < 99), TOO_SHORT),
    "one lost row": (record(keep=without((5000, 5001))), USABLE),
    "0.5 % lost in gaps": (record(keep=without((5000, 5060))), USABLE),
    "2 % lost in gaps": (record(keep=without((5000, 5240))), BAD),
    "16 s lost after the first row": (record(keep=without((1, 1600))), USABLE),
    "batches": (record(keep=np.arange(N) % 600 < 200), GOOD),
    "even times of stamps that scatter": (repaired(Note("uneven_stamps", "even"), N, "time"), GOOD),
    "times of arrival": (repaired(Note("arrival_stamps", "even"), N, "time"), USABLE),
    "a clock set back": (repaired(Note("set_back", "set back"), 1, "time"), USABLE),
    "rows sorted": (repaired(Note("out_of_order", "sorted"), 5, "order"), GOOD),
    "a last line that is cut": (repaired("cut", 1, "lost"), GOOD),
    "0.5 % of the rows dropped": (repaired("dropped", 60, "lost"), USABLE),
    "1 % of the rows dropped": (repaired("dropped", 122, "lost"), BAD),
    "repeats dropped": (repaired(Note("repeated_row", "repeats"), 6000, "lost"), GOOD),
    # samples
    "an axis not connected": (record(put(slice(None), 0.0)), BAD),
    "an axis stuck for five seconds": (record(put(slice(3000, 3500), 0.001)), BAD),
    "saturated": (record(put(slice(3000, 3010), 4.36)), BAD),
    "one lone sample": (record(put(3000, 1.0)), USABLE),
    "9 % of the samples far off": (record(far(0.09)), USABLE),
    "0.3 % of the samples far off": (record(far(0.003)), GOOD),
    "a coarse gyro": (record(lambda x: np.round(x / 0.002) * 0.002), GOOD),
    "a gyro coarser than its noise": (record(lambda x: np.round(x / 0.02) * 0.02), USABLE),
    "single precision": (record(accel=lambda x: np.float64(np.float32(x))), GOOD),
    # size
    "a bias of 6 deg/s": (record(lambda x: x + 0.1), USABLE),
    "gravity off by 5 %": (record(accel=lambda x: 1.05 * x), USABLE),
    "gravity off by half": (record(accel=lambda x: 1.5 * x), BAD),
    "forces in g": (record(accel=lambda x: x / G), BAD),
    "no gravity": (record(accel=lambda x: x + np.array([0, 0, G])), BAD),
    # a thermometer has a verdict of its own
    "a thermometer in kelvin": (record(temperature=Scalars("imu", T, 300 + T / 1e11)), GOOD),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_fault_makes_the_verdict_that_its_effect_deserves(name):
    imu, verdict = CASES[name]
    found = check(Log(Provenance("made", "csv", "", 0), (imu,), zero=0), lines=False)
    assert {s.verdict for s in found.streams if s.name == "imu"} == {verdict}, found


GNSS = GnssStream(
    "fix", np.arange(120) * SECOND, np.tile([0.8, 0.2, 300.0], (120, 1)) + np.arange(120)[:, None] * [1e-6, 0, 0],
    np.tile([6.37, 0.0, 0.0], (120, 1)), np.ones((120, 3)), np.full((120, 3), 0.1),
)  # fmt: skip


def only(rows):
    names = ("time", "position", "velocity", "position_sigma", "velocity_sigma")
    return replace(GNSS, **{name: getattr(GNSS, name)[rows] for name in names})


RECEIVERS = {
    "nothing": (GNSS, GOOD),
    "no sigmas": (replace(GNSS, position_sigma=None, velocity_sigma=None), GOOD),
    "a tunnel of 20 s": (only(np.r_[:40, 60:120]), USABLE),
    "positions held": (replace(GNSS, position=np.repeat(GNSS.position[::2], 2, axis=0)), USABLE),
    "no fix for ten seconds": (replace(GNSS, fix_type=np.where(np.arange(120) // 10 == 5, 1, 3)), USABLE),
    "a spike of the velocity": (
        replace(GNSS, velocity=GNSS.velocity + 400 * (np.arange(120) == 60)[:, None]), USABLE),
    "a jump of the position": (
        replace(GNSS, position=GNSS.position + 1e-4 * (np.arange(120) > 60)[:, None]), BAD),
    "another clock": (replace(GNSS, time=GNSS.time + 10**6 * SECOND), BAD),
    "five fixes": (only(slice(5)), TOO_SHORT),
}  # fmt: skip


@pytest.mark.parametrize("name", RECEIVERS)
def test_a_fault_of_a_receiver_makes_the_verdict_that_its_effect_deserves(name):
    gnss, verdict = RECEIVERS[name]
    found = check(Log(Provenance("made", "csv", "", 0), (record(),), gnss=(gnss,), zero=0), samples=False)
    assert {s.verdict for s in found.streams if s.name == "fix"} == {verdict}, found
