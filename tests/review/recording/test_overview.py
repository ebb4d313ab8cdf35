"""The overview: the streams over time, one table, and each note once."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Scalars, Triad
from imuwb.review.recording.overview import overview


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


def test_each_axis_of_the_first_imu_has_a_chart_whose_title_has_the_range(log, shown):
    overview([log(spread=0.02)], shown)
    assert [series.title for series in shown.all_series] == [
        "accel x of imu, -0.0200 to 0.0200", "accel y of imu, -0.0200 to 0.0200", "accel z of imu, 9.9800 to 10.0200"
    ]  # fmt: skip
    assert all(series.values.shape[1] == 1 for series in shown.all_series)


def test_other_imus_are_on_the_tab_of_the_streams(log, shown):
    content = log()
    overview([replace(content, imus=(*content.imus, replace(content.imus[0], name="second")))], shown)
    assert shown.tabs == ["Overview", "Streams"]
    assert [series.title for series in shown.all_series[3:]] == ["specific force of second"]
    assert shown.all_series[3].values.shape[1] == 3


def test_a_quantity_that_never_changes_is_a_note_and_no_chart(log, shown):
    content, time = log(), np.arange(10) * SECOND
    warm = [replace(content.imus[0], temperature=Scalars("t", time, np.full(10, 25.0)))]
    overview([replace(content, imus=tuple(warm))], shown)
    assert "temperature of imu: 25 °C throughout" in shown.notes
    assert len(shown.all_series) == 3


def test_logs_with_another_clock_start_where_the_first_one_starts(log, shown):
    first, second = log(), log("b.mcap")
    imu = replace(second.imus[0], origin=Origin(epoch="unix"), specific_force=None, angular_rate=Triad(np.arange(5) * SECOND + 10**18, np.eye(5, 3)))  # fmt: skip
    overview([first, replace(second, imus=(imu,), gnss=(), zero=10**18)], shown)
    assert {series.epoch for series in shown.all_series} == {"log"}
    assert shown.all_series[3].time[0] == 0


@pytest.mark.parametrize(("count", "tabs", "tables"), [(1, 2, 1), (3, 4, 1), (4, 3, 1)])
def test_of_more_than_three_logs_the_first_is_shown_over_time(count, tabs, tables, log, shown):
    overview([log(f"{i}.mcap") for i in range(count)], shown)
    assert len(shown.tabs) == tabs
    assert len(shown.tables) == tables
    assert len(shown.all_series) == 3 * (min(count, 3) if count < 4 else 1)
    assert sum(len(table.rows) for table in shown.tables) == 2 * count
    assert shown.notes.count("a note") == 1
    if count == 3:
        assert shown.tabs == ["Overview 0.mcap", "Overview 1.mcap", "Overview 2.mcap", "Streams"]


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
