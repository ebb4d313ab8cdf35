"""A sensor and a review for the tests of the outage replay."""

from types import SimpleNamespace

import numpy as np

from imuwb.analysis import Review
from imuwb.log import AXES
from imuwb.stochastic import AxisModel, Constant, FlickerNoise, GaussMarkov, ImuErrorModel, RandomWalk, Sum, WhiteNoise
from imuwb_plugins.outage import Parameters


def sensor(flicker=False):
    """Return an error model of a cheap sensor, with turn-on biases."""
    axes = {}
    for axis in AXES:
        a = axis[0] == "a"
        slow = FlickerNoise(1e-3 if a else 1e-4) if flicker else GaussMarkov(2e-3 if a else 1e-4, 60.0)
        axes[axis] = AxisModel(
            Sum((WhiteNoise(2e-3 if a else 2e-4), slow, RandomWalk(1e-5 if a else 1e-7), Constant(0.03 if a else 1e-3)))
        )
    return ImuErrorModel("cheap", axes)


#: words of the command line that state the same; estimates take seconds
KNOWN = ("--mounting", "0,0,0", "--gnss-delay", "0", "--clock-rate", "1")


def stated(**options):
    """Return options in which all fixes are used, and the mounting and the clocks are stated: estimates of them take seconds."""
    known = {"mounting": (0.0, 0.0, 0.0), "gnss_delay": 0.0, "clock_rate": 1.0, "spacing": 0.0}
    return Parameters(**(known | options))


class Shown(Review):
    """A review that remembers what it was shown."""

    recording = None

    def __init__(self) -> None:
        self.tabs, self.figures, self.tables, self.notes, self.tracks, self.logged = [], [], [], [], [], []
        self.all_series, self.map_tracks = [], []
        self.recording = SimpleNamespace(log=lambda path, *_, **__: self.logged.append(path))

    def tab(self, name):
        self.tabs.append(name)

    def figure(self, figure):
        self.figures.append(figure)

    def table(self, table):
        self.tables.append(table)

    def note(self, text):
        self.notes.append(text)

    def series(self, series):
        self.all_series.append(series)

    def map_track(self, name, *_):
        self.map_tracks.append(name)

    def track(self, name, position, _color, label=""):
        self.tracks.append((name, np.array(position), label))
