"""The JSON of an outage replay against the contract, and its figures against the scores."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.navigation import FilterModel
from imuwb.notes import ids
from imuwb.replay import Outage, budget, events_of, model_named, prepare, replay
from imuwb.review.answers.document import document, plain
from imuwb_plugins import outage
from imuwb_plugins.outage import Parameters

from .made import sensor, stated


def test_json_is_the_contract(few, log):
    text, _ = document("outage", "0", Parameters(), few, [log], [])
    result = json.loads(text, parse_constant=pytest.fail)["result"]
    assert len(result["outages"]) == 7
    for one in result["outages"]:
        assert {"start", "duration", "mean_speed", "models"} <= set(one)
        assert set(one["models"]) == {"none", "15AV", "18AV", "18AVWD", "full"}
        for name, found in one["models"].items():
            assert {"mean", "max", "end", "nees", "causal"} <= set(found)
            assert found["causal"] == (name != "18AVWD")
            assert 0 <= found["mean"] <= found["max"]
            assert found["end"] <= found["max"]
    (of,) = result["summary"]
    assert of["duration"] == 10.0
    for found in of["models"].values():
        assert {
            "count", "effective_count", "median_end", "median_end_interval", "p95_end", "nees_per_dof", "coverage95", "nis_per_dof",
        } <= set(found)  # fmt: skip
        assert (found["count"], found["effective_count"]) == (7, 7)
        low, high = found["median_end_interval"]
        assert low <= found["median_end"] <= high <= found["p95_end"] * 1.001
        assert 0 <= found["coverage95"] <= 1
    assert result["reference"] == "truth"
    assert set(result) == {
        "outages", "listed", "summary", "samples", "published", "filters", "budget", "reference", "verdicts", "notes", "clocks",
        "mounting", "motion", "gnss_correlation", "tuned", "failed", "engines", "whole_run", "autoregressive_origin",
    }  # fmt: skip
    assert "document" not in result["filters"][0]
    assert (result["clocks"], result["gnss_correlation"], result["tuned"]) == (None, None, None)


@pytest.fixture(scope="module")
def replayed(log):
    """Return the replay of ``few`` with the filters of the library."""
    base = FilterModel("base", sensor())
    names = ("none", "15AV", "18AV", "18AVWD", "full")
    prepared = prepare(log, base)
    models = [model_named(name, base, interval=prepared.measurement.interval) for name in names]
    return replay(prepared, models, [Outage(float(t), 10.0) for t in range(130, 200, 10)])


def test_figures_in_json_are_the_scores(few, log, replayed):
    """Mean, largest and end, speed and NEES of each outage, from the replay's arrays and from truth's own track."""
    truth = log.references[0]
    t = (truth.time - log.zero) / 1e9
    speed = np.hypot(truth.velocity[:, 0], truth.velocity[:, 1])
    for i, one in enumerate(few.outages):
        inside = (t >= one.start) & (t <= one.start + one.duration)
        assert one.mean_speed == pytest.approx(np.mean(speed[inside]), rel=0.05, abs=0.1)
        for name, found in one.models.items():
            s = replayed.runs[name].outages[10.0].scores
            error = np.linalg.norm(s.north_east[i], axis=1)
            assert (found.mean, found.max, found.end) == pytest.approx((error.mean(), error.max(), error[-1]))
            assert found.nees == pytest.approx(
                s.north_east[i, -1] @ np.linalg.solve(s.covariance[i, -1], s.north_east[i, -1])
            )
            assert (
                found.percent == pytest.approx(100 * error[-1] / (one.mean_speed * 10), rel=1e-6)
                or found.percent is None
            )


def test_curves_and_samples_are_the_scores(few, replayed):
    (of,) = few.summary
    for name, found in of.models.items():
        s = replayed.runs[name].outages[10.0].scores
        error = np.linalg.norm(s.north_east, axis=2)
        assert found.curve.median == pytest.approx(np.median(error, axis=0))
        assert found.curve.p95 == pytest.approx(np.percentile(error, 95, axis=0))
        assert found.curve.nees_per_dof == pytest.approx(s.nees.mean(axis=0) / 2)
        assert few.samples.errors[name] == pytest.approx(error)  # seven outages are fewer than sixty
        limit = max(3 * np.median(s.sigma[:, -1]), np.percentile(error[:, -1], 90))
        assert few.samples.limit[name] == pytest.approx(limit)
        assert found.consistency[-1].elapsed == 10.0
        assert found.nees_per_dof == found.consistency[-1].nees_per_dof


def test_the_budget_is_the_last_filters(few, replayed):
    b, last = few.budget, replayed.runs["full"]
    parts = budget(last.solution, events_of(last.solution, [Outage(float(t), 10.0) for t in range(130, 200, 10)]), 10.0)
    assert b.filter == "full"
    assert b.sources[-1] == "in common"
    assert set(b.sources) == set(parts.sources)
    assert b.total == pytest.approx(np.sqrt(parts.total))
    assert b.horizons.tolist() == [5.0, 10.0]
    assert b.percent.sum(axis=0) == pytest.approx(100.0)
    ends = b.percent[:-1, -1]
    assert (np.diff(ends) <= 0).all()
    for source, sigma, shares in zip(b.sources, b.sigma, b.percent, strict=True):
        variance = parts.variance[parts.sources.index(source)]
        assert shares == pytest.approx(100 * (variance / parts.total)[[4, 9]])
        assert np.isnan(sigma).tolist() == (variance < 0).tolist()
        assert np.nan_to_num(sigma) ** 2 == pytest.approx(np.maximum(variance, 0), abs=1e-12)


def test_estimated_biases_have_three_sigma(few, replayed):
    from imuwb.navigation.filter import axis_errors

    best = few.summary[-1].ranked[0]
    errors, sigma = axis_errors(replayed.runs[best].solution)
    gyro = few.drive.charts[-2]
    assert (gyro.title.split(" of ")[0], gyro.unit) == ("Gyro bias", "deg/h")
    columns = np.radians(gyro.values / 3600).reshape(len(errors), 3, -1)  # estimate, less and more by 3 sigma, truth
    assert columns[..., 0] == pytest.approx(errors[:, :3])
    assert columns[..., 2] - columns[..., 1] == pytest.approx(6 * sigma[:, :3], abs=1e-12)
    assert np.isfinite(columns[..., 3]).all()


def test_summary_is_of_the_outages(swept):
    for of in swept.summary:
        for name, found in of.models.items():
            end = [o.models[name].end for o in swept.outages if o.duration == of.duration]
            assert found.count == len(end)
            assert found.median_end == pytest.approx(np.median(end))
            assert found.p95_end == pytest.approx(np.percentile(end, 95))
            nees = [o.models[name].nees for o in swept.outages if o.duration == of.duration]
            assert found.nees_per_dof == pytest.approx(np.mean(nees) / 2)
            assert found.coverage95 == pytest.approx(np.mean(np.array(nees) <= 5.991))


def test_kinds_of_motion_count_all(swept):
    for of in swept.summary:
        kinds = {o.motion for o in swept.outages if o.duration == of.duration}
        assert set(of.by_motion) == kinds <= {"stop", "turn", "fast", "straight"}
        for kind, medians in of.by_motion.items():
            for name, median in medians.items():
                end = [o.models[name].end for o in swept.outages if o.duration == of.duration and o.motion == kind]
                assert median == pytest.approx(np.median(end))


def test_pairs_are_with_denoising_or_with_the_first(few, swept):
    assert [(p.model, p.against) for p in few.summary[0].paired] == [
        ("18AVWD", n) for n in ("none", "15AV", "18AV", "full")
    ]
    assert [(p.model, p.against) for p in swept.summary[0].paired] == [("full", "none")]


def test_no_nan_where_a_filter_has_no_figure(few, log):
    (one, *_) = few.outages
    odd = replace(one, models={n: replace(m, nees=math.nan, end=math.inf, heading=None) for n, m in one.models.items()})
    found = plain(replace(few, outages=(odd,)))["outages"][0]["models"]["none"]
    assert (found["nees"], found["end"], found["heading"]) == (None, None, None)


def test_random_starts(log, toml):
    found = [
        outage.run([log], stated(error_model=toml, models="none", durations="5", random=6, seed=seed))
        for seed in (1, 1, 2)
    ]
    starts = [[o.start for o in one.outages] for one in found]
    assert len(starts[0]) == 6
    assert starts[0] == sorted(starts[0]) == starts[1] != starts[2]


def test_a_log_without_an_outage_of_its_own_says_so(log, toml):
    with pytest.raises(MissingDataError, match="no outage of its own") as raised:
        outage.run([log], stated(error_model=toml, models="none", at="own"))
    assert "shorter" not in str(raised.value)


@pytest.mark.parametrize(("options", "said"), [({}, False), ({"durations": "10"}, True), ({"random": 3}, True)])
def test_options_of_a_sweep_are_named_where_the_outages_are_given(log, toml, options, said):
    found = outage.run([log], stated(error_model=toml, models="none", at="150:10", **options))
    assert ("sweep-options" in ids(found.notes)) == said
