"""The truth of the messages in tests of known shapes, and what their streams must be."""

import numpy as np

T = 1_714_564_800 * 10**9
BOOT = 5_000_000_000  #: ns
RATE, FORCE = (0.1, -0.2, 0.3), (0.5, 0.25, -9.75)
LATITUDE, LONGITUDE, HEIGHT = 47.5, 8.5, 450.0
VELOCITY = (3.0, -4.0, 0.5)
COUNT = 40


def xyz(name, values):
    return {f"{name}.{axis}": value for axis, value in zip("xyz", values, strict=True)}


def assert_imu(imu, rate=RATE, force=FORCE):
    np.testing.assert_allclose(imu.angular_rate.value, [rate] * COUNT, rtol=1e-6)
    np.testing.assert_allclose(imu.specific_force.value, [force] * COUNT, rtol=1e-6)


NO_FIX = 1


def states_no_fix(log):
    """Return whether a receiver without a fix is left out, and a note says so."""
    return not log.gnss and [note.id for note in log.notes if "no fix" in note] == ["no_fix"]


def assert_gnss(gnss, *, velocity=VELOCITY, sigma=None, velocity_sigma=None, fix=None, rtol=1e-6):
    place = [np.radians(LATITUDE), np.radians(LONGITUDE), HEIGHT]
    np.testing.assert_allclose(gnss.position, [place] * len(gnss), rtol=1e-9)
    for found, wanted in (
        (gnss.velocity, velocity), (gnss.position_sigma, sigma), (gnss.velocity_sigma, velocity_sigma),
    ):  # fmt: skip
        if wanted is None:
            assert found is None
        else:
            np.testing.assert_allclose(found, [wanted] * len(gnss), rtol=rtol)
    if fix is not None:
        assert gnss.fix_type.tolist() == [fix] * len(gnss)
