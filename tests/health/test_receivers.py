"""Faults of a receiver: held rows, kinds of fix, spikes, jumps, sigmas that are missing."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.geodesy import radii_of_curvature
from imuwb.health import check
from imuwb.log import SECOND, GnssStream, Log, Provenance

N, RATE = 600, 5


def gnss(speed=5.0, course=0.6, latitude=0.82, longitude=0.2):
    """Return a drive straight on; all that a receiver can tell is told."""
    t = np.arange(N) / RATE
    meridian, transverse = radii_of_curvature(np.array([latitude]))
    north, east = speed * np.cos(course), speed * np.sin(course)
    position = np.stack(
        [latitude + north * t / meridian, longitude + east * t / transverse / np.cos(latitude), 300 + 0 * t], axis=1
    )
    position[:, 1] = (position[:, 1] + np.pi) % (2 * np.pi) - np.pi
    ones = np.ones((N, 3))
    velocity = ones * [north, east, 0]
    return GnssStream(
        "/fix", np.arange(N) * (SECOND // RATE), position, velocity, ones, 0.1 * ones, np.full(N, 6, np.int64)
    )


def faults(stream):
    return list(check(Log(Provenance("made.csv", "csv", "", 0), gnss=(stream,))).faults)


def changed(array, rows, value):
    array = np.array(array)
    array[rows] = value
    return array


@pytest.mark.parametrize("speed", [0.5, 5.0, 40.0, 250.0])
def test_a_sound_receiver_has_no_fault(speed):
    assert faults(gnss(speed)) == []


@pytest.mark.parametrize("seed", range(20))
def test_noise_and_turns_are_no_fault(seed):
    rng = np.random.default_rng(seed)
    sound = gnss()
    position = sound.position + rng.standard_normal((N, 3)) * [1e-7, 1e-7, 1]
    assert faults(replace(sound, position=position, velocity=sound.velocity + rng.standard_normal((N, 3)))) == []


def test_held_rows_are_counted():
    sound = gnss(15)
    (held,) = faults(replace(sound, position=np.repeat(sound.position[::2], 2, axis=0)))
    assert (held.kind, held.severity, held.count, held.start) == ("held rows", "warning", N // 2, 0.2)


def test_a_few_held_rows_are_usual():
    sound = gnss()
    position = np.array(sound.position)
    position[100:105] = position[99]
    assert faults(replace(sound, position=position)) == []


def test_changes_of_the_fix_are_counted_and_noted():
    (note,) = faults(replace(gnss(), fix_type=changed(gnss().fix_type, slice(100, 110), 5)))
    assert (note.kind, note.severity, note.count, note.start) == ("fix changes", "note", 2, 20.0)


def test_fixes_below_three_dimensions_are_counted_and_the_longest_span_told():
    kinds = changed(changed(gnss().fix_type, slice(100, 105), 2), slice(300, 320), 1)
    poor, changes = faults(replace(gnss(), fix_type=kinds))
    assert (poor.kind, poor.severity, poor.count, poor.start) == ("no 3D fix", "warning", 25, 60.0)
    assert poor.length == pytest.approx(4)
    assert changes.count == 4


@pytest.mark.parametrize("top", [84.0, 427.0])
def test_spikes_of_the_velocity_are_found(top):
    sound = gnss()
    velocity = changed(sound.velocity, [100, 400], [0, top, 0])
    velocity[400] = [0, 50, 0]
    (spike,) = faults(replace(sound, velocity=velocity))
    assert f"{top:.3g} m/s" in spike.what
    assert (spike.kind, spike.severity, spike.count, spike.start) == ("velocity spikes", "warning", 2, 20.0)


@pytest.mark.parametrize(("every", "severity"), [(200, "warning"), (50, "fault")])
def test_many_spikes_are_a_fault(every, severity):
    sound = gnss()
    (spike,) = faults(replace(sound, velocity=changed(sound.velocity, slice(10, None, every), [0, 300, 0])))
    assert spike.severity == severity


def test_a_change_of_speed_is_no_spike():
    sound = gnss()
    assert faults(replace(sound, velocity=changed(sound.velocity, slice(300, None), [40, 0, 0]))) == []


def test_unknown_velocities_are_no_spikes_where_the_speed_is_low():
    sound = gnss(20)
    assert faults(replace(sound, velocity=changed(sound.velocity, slice(None, None, 2), np.nan))) == []


def test_unknown_velocities_are_no_spikes():
    sound = gnss(40)
    assert faults(replace(sound, velocity=changed(sound.velocity, slice(None, None, 2), np.nan))) == []


def test_where_the_velocity_is_unknown_for_long_the_position_does_not_jump():
    sound = gnss(40)
    assert faults(replace(sound, velocity=changed(sound.velocity, slice(100, 200), np.nan))) == []


@pytest.mark.parametrize("told", [True, False], ids=["with velocity", "without"])
def test_jumps_of_the_position_are_found(told):
    sound = gnss()
    position = np.array(sound.position)
    position[300:, 0] += 638 / radii_of_curvature(np.array([0.82]))[0]
    made = replace(sound, position=position)
    found = faults(made if told else replace(made, velocity=None, velocity_sigma=None))
    (jump,) = (f for f in found if f.severity != "note")
    assert float(jump.what.split()[-2]) == pytest.approx(638.8, abs=1.5)
    assert (jump.kind, jump.severity, jump.count, jump.start) == ("position jumps", "fault", 1, 60.0)


def test_a_step_over_a_gap_is_no_jump():
    sound = gnss(20)
    keep = np.ones(N, bool)
    keep[100:400] = False
    names = ("time", "position", "velocity", "position_sigma", "velocity_sigma", "fix_type")
    cut = replace(sound, **{name: getattr(sound, name)[keep] for name in names})
    assert not [f for f in faults(cut) if f.kind == "position jumps"]


def test_the_date_line_is_no_jump():
    assert faults(gnss(longitude=np.pi - 1e-6, latitude=-0.3)) == []


@pytest.mark.parametrize("what", ["position", "velocity"])
def test_a_missing_sigma_is_noted(what):
    (note,) = faults(replace(gnss(), **{f"{what}_sigma": None}))
    assert (note.kind, note.severity) == (f"no {what} sigma", "note")


def test_without_a_velocity_no_sigma_of_it_is_missed():
    assert [f.kind for f in faults(replace(gnss(), velocity=None, velocity_sigma=None))] == ["no velocity"]
