from types import SimpleNamespace

import numpy as np
import pytest
from rerun.chunk import RrdReader

from imuwb.analysis import Curve, Figure
from imuwb.review.figures import chart
from imuwb.review.recording.review import RecordingReview


class Logged(dict):
    """Stand for a recording: keep what is logged, {entity path: what is logged}."""

    def log(self, path, *archetypes, static):
        assert static
        assert path not in self
        self[path] = archetypes


@pytest.fixture
def logged():
    return Logged()


class Drawn:
    """What a figure draws: its parts by their names."""

    def __init__(self, drawing, view) -> None:
        self.view = view
        self.lines, self.points, self.texts = (
            {part.name: part for part in parts} for parts in (drawing.lines, drawing.points, drawing.texts)
        )
        self.order = [part.name for part in sorted(drawing.lines, key=lambda part: part.order)]

    def strips(self, name):
        return [list(strip) for strip in self.lines[name].places]

    def labels(self):
        return list(self.texts["texts"].texts)

    def places(self):
        return [place for (place,) in self.texts["texts"].places]

    def colors(self, name):
        return list(self.lines[name].colors)

    def radii(self, name):
        return [-radius for radius in self.lines[name].radii]  # negative: in points of the screen


@pytest.fixture
def drawn():
    """Return what a figure draws."""

    def draw(figure, size=(720, 385), group=()):
        return Drawn(*chart.drawn(figure, size, group))

    return draw


@pytest.fixture
def line():
    """Return a figure of one curve."""

    def make(x, y, *, marks=(), verticals=(), kind="log", limits=None, **more):
        curve = Curve("c", np.asarray(x, float), np.asarray(y, float), (1, 2, 3), **more)
        return Figure("f", "x", "y", (curve,), tuple(marks), kind, kind, tuple(verticals), None, limits)

    return make


@pytest.fixture
def entities():
    """Return the entity paths of a recording."""

    def read(path):
        return {str(chunk.entity_path) for chunk in RrdReader(str(path)).stream()}

    return read


@pytest.fixture
def review(tmp_path):
    """Return a review, and the items that it shows in the terminal."""
    shown = []
    return SimpleNamespace(review=RecordingReview(tmp_path / "r.rrd", show=shown.append), shown=shown)
