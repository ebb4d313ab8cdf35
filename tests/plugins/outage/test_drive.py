"""The drive in time: which outages are shown, and what is said of them."""

from itertools import pairwise

import numpy as np
import pytest

from imuwb.geodesy import euler_of_quaternion
from imuwb.geodesy.tangent_plane import ned_of
from imuwb.log import SECOND
from imuwb_plugins import outage
from imuwb_plugins.outage.drive_outages import APART, TYPICAL, WORST

from .made import Shown


def ends(result, name):
    """Return {start: error of a filter at the end} of the longest outages."""
    longest = max(o.duration for o in result.outages)
    return {round(o.start, 3): o.models[name].end for o in result.outages if o.duration == longest}


def start_of(result, episode):
    return round((episode.begin - (result.replay.prepared.log.zero or 0)) / SECOND, 3)


@pytest.mark.slow
def test_the_worst_and_the_typical_outage_are_shown_first(swept):
    best = swept.summary[-1].ranked[0]
    errors = ends(swept, best)
    named = {e.name: errors[start_of(swept, e)] for e in swept.drive.scene.episodes if e.name}
    assert next(iter(named)) == TYPICAL
    assert named[WORST] == max(errors.values())
    assert named[TYPICAL] == pytest.approx(np.median(list(errors.values())), rel=0.1)
    spans = sorted((start_of(swept, e), (e.end - e.begin) / SECOND) for e in swept.drive.scene.episodes)
    assert all(b >= a + length + APART - 1e-3 for (a, length), (b, _) in pairwise(spans))


@pytest.mark.slow
def test_captions_state_the_scores(swept):
    best = swept.summary[-1].ranked[0]
    for episode in swept.drive.scene.episodes:
        error = ends(swept, best)[start_of(swept, episode)]
        assert episode.captions[-1].rows[0][:2] == (best, f"{error:.3g} m")
        assert "No fault of the log at this time." in episode.captions[-1].remarks
        last = episode.beliefs[0]
        row = np.searchsorted(swept.drive.scene.body.time, last.time[-1])
        off = ned_of(last.position[-1:], swept.drive.scene.body.position[row])[0]
        assert np.hypot(*off[:2]) == pytest.approx(error, rel=0.02)
        assert (last.time[-1] - episode.begin, last.name) == (10 * SECOND, best)


@pytest.mark.slow
def test_the_vehicle_heads_where_it_drives(swept):
    body = swept.drive.scene.body
    moved = np.diff(ned_of(body.position, body.position[0])[:, :2], axis=0)
    fast = np.hypot(*moved.T) > 5
    course = np.arctan2(moved[:, 1], moved[:, 0])
    heading = euler_of_quaternion(body.quaternion)[:-1, 2]
    assert np.median(np.abs(np.angle(np.exp(1j * (course - heading))))[fast]) < np.radians(5)


@pytest.mark.slow
def test_charts_have_the_clock_of_the_scene_and_errors_at_its_seconds(swept):
    scene, charts = swept.drive.scene, {c.title: c for c in swept.drive.charts}
    error = charts["Horizontal error"]
    last = scene.episodes[0].beliefs[0]
    row = int(np.flatnonzero(error.time == last.time[-1])[0])
    best = error.names.index(last.name)
    assert error.values[row, best] == pytest.approx(ends(swept, last.name)[start_of(swept, scene.episodes[0])])
    assert np.isnan(error.values[row + 1]).all()  # the line ends with its outage


def test_a_given_outage_alone_is_shown_with_its_faults_and_on_a_map_if_wanted(few):
    shown = Shown()
    outage.draw(few, shown)
    assert "Map" not in shown.tabs
    assert not shown.map_tracks
    own = few.drive
    assert {p.name.partition(":")[0] for p in own.scene.points if p.name} <= {"fix", "3D fix", "refused", "RTK fixed"}
    assert [s.text for s in own.spans] == ["outage"] * len(own.scene.episodes)
