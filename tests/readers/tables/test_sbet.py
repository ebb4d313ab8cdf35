"""SBET trajectories as references; the axes of the velocity are found by the positions."""

import numpy as np
import pytest

from imuwb.errors import ImuwbError
from imuwb.geodesy import ned_scale
from imuwb.notes import ids
from imuwb.readers import read, reader_of

N = 400
TIME = 345_600.0 + 0.1 * np.arange(N)
HEADING = np.linspace(0.3, 2.0, N)
SPEED, DOWN = 15.0, 0.4
NED = np.column_stack([SPEED * np.cos(HEADING), SPEED * np.sin(HEADING), np.full(N, DOWN)])


def positions():
    place = np.empty((N, 3))
    place[0] = np.radians(47.5), np.radians(8.5), 500.0
    for i in range(1, N):
        scale = ned_scale(place[i - 1, 0], place[i - 1, 2])
        place[i] = place[i - 1] + (NED[i] + NED[i - 1]) / 2 * 0.1 / scale
    return place


PLACE = positions()


def rows(wander=0.0, velocity=None, slip=0.0):
    wandering = np.full(N, wander)
    turned = np.column_stack([
        NED[:, 0] * np.cos(wander) - NED[:, 1] * np.sin(wander), NED[:, 0] * np.sin(wander) + NED[:, 1] * np.cos(wander), NED[:, 2],
    ])  # fmt: skip
    attitude = np.column_stack([np.full(N, 0.01), np.full(N, -0.02), HEADING + wander + slip])
    return np.column_stack(
        [TIME, PLACE, turned if velocity is None else velocity, attitude, wandering, np.zeros((N, 6))]
    ).astype("<f8")


@pytest.fixture
def log_of(tmp_path):
    def log(data):
        path = tmp_path / "sbet.out"
        path.write_bytes(data if isinstance(data, bytes) else data.tobytes())
        return read(path)

    return log


@pytest.mark.parametrize("wander", [0.0, 0.7, -1.2])
def test_a_trajectory(log_of, wander):
    log = log_of(rows(wander))
    (track,) = log.references
    assert log.provenance.format == "sbet"
    np.testing.assert_array_equal(track.position, PLACE)
    np.testing.assert_allclose(
        track.attitude, np.column_stack([np.full(N, 0.01), np.full(N, -0.02), HEADING]), atol=1e-14
    )
    np.testing.assert_allclose(track.velocity, NED, atol=1e-12)
    assert np.abs(track.time - TIME * 1e9).max() < 100
    assert {"week_unknown", "velocity_axes", "unused"} <= set(ids(log.notes))


def test_velocities_along_the_vehicle(log_of):
    left, slip = np.full(N, SPEED * np.sin(0.4)), 0.4  # the vehicle points right of its course
    forward, up = np.full(N, SPEED * np.cos(slip)), np.full(N, -DOWN)
    log = log_of(rows(velocity=np.column_stack([forward, left, up]), slip=slip))
    np.testing.assert_allclose(log.references[0].velocity, NED, atol=1e-12)


def test_velocities_that_fit_nothing_are_left_out(log_of):
    log = log_of(rows(velocity=np.column_stack([np.full(N, 3.0), np.full(N, 40.0), np.zeros(N)])))
    assert log.references[0].velocity is None
    assert "velocity_left_out" in ids(log.notes)


def test_a_cut_file(log_of):
    log = log_of(rows().tobytes()[: 136 * 100 + 50])
    assert len(log.references[0]) == 100
    assert "row_cut" in ids(log.notes)


@pytest.mark.parametrize("column", [0, 1, 3, 4, 7, 9])
def test_other_doubles_are_no_trajectory(tmp_path, column):
    path = tmp_path / "doubles"
    table = rows()
    table[2, column] = 1e9
    path.write_bytes(table.tobytes())
    with pytest.raises(ImuwbError, match="doubles"):
        reader_of(path)
