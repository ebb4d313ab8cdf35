from dataclasses import replace

import numpy as np
import pytest
from rerun.chunk import RrdReader

from imuwb.analysis import Series
from imuwb.log import SECOND
from imuwb.scene import Span

TIME = np.arange(5, dtype=np.int64) * SECOND


def series(title, *, columns=1, step=1, spans=()):
    values = np.arange(5.0 * columns).reshape(5, columns)
    names = tuple(f"{title}{k}" for k in range(columns))
    return Series(title, "m", TIME * step, values, names, ((1, 2, 3),) * columns, spans=spans)


def entities(review):
    """Return {entity: number of lines} of the charts."""
    found = {}
    for chunk in RrdReader(str(review.close())).stream():
        for row in chunk.to_record_batch().to_pylist():
            if row.get("SeriesLines:names"):
                found[str(chunk.entity_path)] = len(row["SeriesLines:names"])
    return found


def test_single_quantities_at_the_same_times_are_one_entity(review):
    given = [series("a"), series("b"), series("c", step=2), series("d", columns=2), series("e"), series("f")]
    for one in given:
        review.review.series(one)
    views = review.review._tabs[-1]
    found = entities(review.review)
    assert found == {"/result/series_0": 2, "/result/series_2": 1, "/result/series_3": 2, "/result/series_4": 2}
    assert len(views.series) == len(given)
    origins = [view.origin for view in views.series]
    assert origins == [f"/result/series_{k}" for k in (0, 0, 2, 3, 4, 4)]


def test_each_chart_of_an_entity_hides_the_lines_of_the_others(review):
    for name in "abc":
        review.review.series(series(name))
    tab = review.review._tabs[-1]
    review.review.close()
    shown = [
        [flag for batch in overrides for part in batch.as_component_batches() for flag in part.as_arrow_array().to_pylist()]
        for overrides in (view.visualizer_overrides["/result/series_0"] for view in tab.series)
    ]  # fmt: skip
    assert np.array(shown).tolist() == np.eye(3, dtype=bool).tolist()


@pytest.mark.parametrize("where", ["tab", "series"])
def test_charts_with_shading_have_entities_of_their_own(where, review):
    span = Span(int(TIME[1]), int(TIME[2]), "span")
    given = [series("a"), series("b")]
    if where == "tab":
        review.review.span(span)
    else:
        given = [replace(one, spans=(span,)) for one in given]
    for one in given:
        review.review.series(one)
    found = entities(review.review)
    assert {path for path in found if not path.endswith("spans")} == {"/result/series_0", "/result/series_1"}
