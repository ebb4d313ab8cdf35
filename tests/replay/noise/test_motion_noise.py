"""Noise in motion, found from innovations; what a bench record leaves open; velocities that contradict positions."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.log import SECOND, GnssStream
from imuwb.navigation.filter_model import Vibration
from imuwb.navigation.vibration import usual_vibration, vibration_levels, with_classes
from imuwb.replay import NAMES, estimate_motion_noise, in_motion, prepare, run, with_unidentified
from imuwb.replay.fixes.fix_kinds import consistent
from imuwb.replay.noise.added_noise import with_added
from imuwb.simulation import MotionNoise
from imuwb.stochastic import AxisModel, FlickerNoise, ImuErrorModel, RandomWalk, Sum, WhiteNoise

from .. import made  # noqa: TID252 - tests are no package that has a name

TRUE = MotionNoise((2e-3, 1.5e-2), (2e-5, 5e-4), when="always")


def noise_of(model, axis, kind, name):
    return [getattr(t, name) for t in model.axes[axis].processes.terms if isinstance(t, kind)]


@pytest.fixture(scope="module")
def shaken():
    drive = made.town(300, 3, seed=4, motion_noise=TRUE)
    drive.prepared = prepare(drive.log, drive.model)
    drive.found_model, drive.found = estimate_motion_noise(drive.prepared, drive.model, 0.99)
    return drive


@pytest.mark.slow
def test_the_added_noise_is_found(shaken):
    found = shaken.found
    for estimate, true in zip((*found.white, *found.walk), (*TRUE.white, *TRUE.walk), strict=True):
        assert estimate.lower <= true <= estimate.upper
    assert found.white[0].value == pytest.approx(TRUE.white[0], rel=0.25)
    factor = found.factors["gyro_x"]
    bench = noise_of(shaken.model.error_model, "gyro_x", WhiteNoise, "N")[0]
    assert factor.value == pytest.approx(np.hypot(found.white[0].value, bench) / bench, rel=1e-9)
    assert found.fixes > 200
    assert found.blocks in (4, 5)


@pytest.mark.slow
def test_the_filter_has_the_noise_and_its_innovations_fit(shaken):
    whole = in_motion(shaken.found_model, shaken.found)
    (n,) = noise_of(whole, "gyro_x", WhiteNoise, "N")
    low, high = whole.axes["gyro_x"].intervals["0.N"]
    assert low <= TRUE.white[0] <= high
    assert low <= n <= high
    (bench,) = noise_of(shaken.model.error_model, "gyro_x", WhiteNoise, "N")
    assert n >= np.hypot(shaken.found.white[0].value, bench) * 0.999
    before, after = (run(m, shaken.prepared).fix_nis for m in (shaken.model, shaken.found_model))
    assert np.nanmean(after[20:]) / 3 == pytest.approx(1.0, abs=0.15)
    assert np.nanmean(before[20:]) > 2 * np.nanmean(after[20:])


@pytest.mark.slow
def test_a_drive_without_more_noise_keeps_the_bench():
    drive = made.town(240, 1, seed=7)
    _, found = estimate_motion_noise(prepare(drive.log, drive.model), drive.model, 0.95)
    assert found.factors["gyro_x"].lower < 1.2


def test_a_short_drive_is_refused():
    drive = made.town(130, 1, seed=2)
    cut = replace(drive.log, gnss=(made.gnss_of(drive.log, slice(0, 120)),))
    with pytest.raises(MissingDataError, match="60 s of fixes"):
        estimate_motion_noise(prepare(cut, drive.model), drive.model, 0.95)


# Added noise


def test_densities_of_independent_noise_add():
    model = made.error_model(white=(3e-4, 3e-3))
    added = with_added(model, (4e-4, 0.0), (1e-5, 0.0))
    assert noise_of(added, "gyro_y", WhiteNoise, "N") == [pytest.approx(5e-4)]
    assert noise_of(added, "gyro_y", RandomWalk, "K") == [pytest.approx(1e-5)]
    assert noise_of(added, "accel_y", WhiteNoise, "N") == [pytest.approx(3e-3)]
    assert noise_of(added, "accel_y", RandomWalk, "K") == []


def test_the_bench_limits_are_carried_where_nothing_slow_is_identified():
    def axis(*more, **limits):
        return AxisModel(Sum((WhiteNoise(1e-4), *more)), limits=limits)

    source = ImuErrorModel(
        "bench",
        {
            "gyro_x": axis(K=2e-6, B=1e-6),
            "gyro_y": axis(FlickerNoise(1e-5), K=2e-6),
            "gyro_z": axis(),
            "accel_x": axis(B=1e-3),
        },
    )
    model, carried = with_unidentified(source, source)
    assert carried == ("gyro_x", "accel_x")
    assert noise_of(model, "gyro_x", RandomWalk, "K") == [2e-6]
    assert noise_of(model, "gyro_y", RandomWalk, "K") == []
    # The walk's Allan deviation K √(τ/3) at a minute is the flat one of flicker noise, 0.664 B.
    (k,) = noise_of(model, "accel_x", RandomWalk, "K")
    assert k * np.sqrt(60 / 3) == pytest.approx(0.6643e-3, rel=1e-3)
    assert "motion" not in NAMES


# Noise that grows with vibration


def test_vibration_is_that_of_the_last_two_seconds():
    drive = made.town(120, 1, seed=3)
    measurement = prepare(drive.log, drive.model).measurement
    force = np.zeros_like(measurement.samples.velocity)
    rng = np.random.default_rng(1)
    force[3000:4000] = rng.normal(0, 2.0, (1000, 3))
    samples = measurement.samples._replace(velocity=force * measurement.samples.interval[:, None])
    level = vibration_levels(replace(measurement, samples=samples))
    assert level[:3000].max() == 0
    # Steps between white samples over √2 have the rms of the samples, all three axes together.
    assert level[3200:4000].mean() == pytest.approx(2.0 * np.sqrt(3), rel=0.05)
    assert level[4110:].max() == pytest.approx(0, abs=1e-6)


def test_classes_of_vibration_scale_the_white_noise():
    drive = made.town(120, 1, seed=3)
    prepared = prepare(drive.log, drive.model)
    usual = usual_vibration(prepared.measurement)
    divided = with_classes(prepared.measurement, Vibration((1e-3, 1e-2), usual))
    level = np.array(divided.vibration)[divided.samples.regime]
    assert (level**4).mean() ** 0.25 == pytest.approx(1.0, rel=0.2)
    model = replace(drive.model, vibration=Vibration((1e-3, 1e-2), usual))
    tables = run(model, prepared).tables
    bench = run(drive.model, prepared).tables.white[0]
    expected = bench + (np.array(divided.vibration)[:, None] ** 2 * np.repeat([1e-3, 1e-2], 3)) ** 2
    np.testing.assert_allclose(tables.white, expected, rtol=1e-9)


# Velocities that contradict their own positions


def receiver(fix_type=None, error=0.0):
    time = np.arange(100) * SECOND
    speed, radius = 10.0, made.radii(0.8)[0]
    position = np.stack([0.8 + np.arange(100) * speed / radius, np.full(100, 0.2), np.zeros(100)], axis=1)
    velocity = np.tile([speed, 0.0, 0.0], (100, 1))
    velocity[:, 1] += error if fix_type is None else np.where(fix_type == 6, error, 0.0)
    return GnssStream("gnss", time, position, velocity=velocity, fix_type=fix_type)


def test_contradicting_velocities_of_a_kind_of_fix_are_left_out():
    kinds = np.where(np.arange(100) < 60, 3, 6)
    kept, notes = consistent(receiver(kinds, 8.0))
    assert [note.id for note in notes] == ["contradicting-velocities"]
    assert np.isfinite(kept.velocity[:60]).all()
    assert np.isnan(kept.velocity[60:]).all()
    assert "8.0 m/s" in notes[0]


def test_all_velocities_contradict():
    kept, notes = consistent(receiver(None, 8.0))
    assert kept.velocity is None
    assert len(notes) == 1


def test_positions_that_scatter_as_they_claim_contradict_no_velocity():
    gnss = receiver()
    noise = 2.0 * np.random.default_rng(1).standard_normal((100, 2)) / made.radii(0.8)
    scattered = replace(gnss, position=gnss.position + np.pad(noise, ((0, 0), (0, 1))))
    for sigma, count in ((2.0, 0), (0.02, 1)):
        kept, notes = consistent(replace(scattered, position_sigma=np.full((100, 3), sigma)))
        assert len(notes) == count
        assert (kept.velocity is None) == bool(count)


@pytest.mark.parametrize("error", [0.0, 0.9, 1.9])
def test_small_contradictions_are_noise(error):
    kept, notes = consistent(receiver(None, error))
    assert notes == ()
    assert kept.velocity is not None
