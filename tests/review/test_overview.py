"""The overview: the streams over time, one table, and each note once."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Triad
from imuwb.review.overview import overview


class Shown:
    """Keep what an overview shows."""

    def __init__(self) -> None:
        self.tabs, self.all_series, self.tables, self.notes, self.tracks = [], [], [], [], []
        self.tab, self.series, self.table, self.note = (
            self.tabs.append, self.all_series.append, self.tables.append, self.notes.append,
        )  # fmt: skip

    def track(self, name, position, color):
        self.tracks.append(SimpleNamespace(name=name, position=position, color=color))


@pytest.fixture
def log():
    """Return a function that gives a log of an accelerometer with a mean of 10 m/s² on one axis, and some spread."""

    def make(path="a.mcap", spread=0.01, receivers=1):
        time = np.arange(1001) * SECOND
        values = np.linspace(-spread, spread, 1001)[:, None] + [0.0, 0.0, 10.0]
        imu = ImuStream("imu", None, Triad(time, values), None, Origin())
        position = np.full((10, 3), 0.5)
        gnss = tuple(
            GnssStream(f"gnss{i}", time[:10], position, None, None, None, None, Origin()) for i in range(receivers)
        )
        return Log(Provenance(path, "", "", 0), (imu,), gnss, notes=("a note",))

    return make


@pytest.fixture
def shown():
    return Shown()


@pytest.mark.parametrize(("spread", "about"), [(0.9, True), (1.1, False)])
def test_a_still_sensor_is_drawn_about_its_medians(spread, about, log, shown):
    overview([log(spread=spread / 0.99)], shown)  # 99 % of the distances from the median are below the spread
    (series,) = shown.all_series
    assert ("about its median" in series.title) == about
    assert series.values[500, 2] == pytest.approx(0.0 if about else 10.0)
    assert (series.names[2] == "accel z, about 10.000") == about


@pytest.mark.parametrize(("count", "tabs", "tables"), [(1, 1, 1), (3, 3, 3), (4, 2, 1)])
def test_of_more_than_three_logs_the_first_is_shown_over_time(count, tabs, tables, log, shown):
    overview([log(f"{i}.mcap") for i in range(count)], shown)
    assert len(shown.tabs) == tabs
    assert len(shown.tables) == tables
    assert len(shown.all_series) == min(count, 3) if count < 4 else 1
    assert sum(len(table.rows) for table in shown.tables) == 2 * count
    assert shown.notes.count("a note") == 1


def test_receivers_have_tracks_of_different_colours(log, shown):
    overview([log(receivers=3)], shown)
    assert [track.name for track in shown.tracks] == ["gnss0", "gnss1", "gnss2"]
    assert len({track.color for track in shown.tracks}) == 3


def test_times_since_1970_are_shown_as_dates(log, shown):
    content = log()
    imu = replace(content.imus[0], origin=Origin(epoch="unix"))
    overview([replace(content, imus=(imu,))], shown)
    assert shown.all_series[0].epoch == "unix"
    assert shown.tables[0].rows[0][5] == "1970-01-01 00:00:00 UTC"
