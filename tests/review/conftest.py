from types import SimpleNamespace

import numpy as np
import pytest
from rerun.chunk import RrdReader

from imuwb.analysis import Curve, Figure
from imuwb.review.figures import chart
from imuwb.review.recording.review import RecordingReview


class Drawing(dict):
    """Stand for a recording: keep what is logged, {entity path: what is logged}."""

    def log(self, path, archetype, *, static):
        assert static
        self[path] = archetype

    def strips(self, path):
        return self[path].strips.as_arrow_array().to_pylist()

    def places(self, path):
        return self[path].positions.as_arrow_array().to_pylist()

    def labels(self, path):
        return self[path].labels.as_arrow_array().to_pylist()

    def colors(self, path):
        return [(c >> 24, c >> 16 & 255, c >> 8 & 255, c & 255) for c in self[path].colors.as_arrow_array().to_pylist()]

    def radii(self, path):
        return [-r for r in self[path].radii.as_arrow_array().to_pylist()]  # negative: in points of the screen


@pytest.fixture
def drawing():
    return Drawing()


@pytest.fixture
def drawn():
    """Return what a figure logs."""

    def draw(figure, size=(720, 385), group=()):
        drawing = Drawing()
        view = chart.draw(figure, drawing, "f", size, group)
        bounds = view.properties["VisualBounds2D"].range.as_arrow_array().to_pylist()[0]
        drawing.view = (bounds["x_range"], bounds["y_range"])
        return drawing

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
