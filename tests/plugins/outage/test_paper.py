"""What the paper shows: outages by table, figure 26, each outage from near, where AR processes come from, table 6."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.log import AXES
from imuwb.notes import ids
from imuwb.simulation import preset, static
from imuwb.stochastic import Autoregressive, AxisModel, ImuErrorModel, Sum
from imuwb.writers import write
from imuwb_plugins import outage
from imuwb_plugins.outage import paper
from imuwb_plugins.outage.static import origin_of, with_static

from .made import Shown, sensor, stated


def test_tables_by_the_users_text_and_the_gain_over_all(few):
    own = [replace(o, table="9" if k < 3 else "10") for k, o in enumerate(few.outages)]
    first, second, gain = paper.tables(own, few.published)
    assert (first.title[:8], second.title[:9]) == ("Table 9:", "Table 10:")
    assert (len(first.rows), len(second.rows), len(gain.rows)) == (3, 4, 1)
    assert first.rows[0][3:] == tuple(f"{m.own_mean:.2f} / {m.own_max:.2f} m" for m in own[0].models.values())
    assert gain.rows[0][1].endswith(f"/ {100 * few.published['none'].own_max:.1f} %")


def test_figure_26_has_a_bar_for_each_filter_and_outage(few):
    largest, mean = paper.each_outage(few.outages)
    for figure, part in ((largest, "own_max"), (mean, "own_mean")):
        assert [curve.style for curve in figure.curves] == ["bar"] * 5
        places = np.stack([curve.x for curve in figure.curves])
        assert np.array_equal(np.round(places.mean(axis=0), 9), np.arange(1.0, 8))
        assert (np.diff(places.ravel(order="F")) > 0).all()  # no bar hides another
        for curve in figure.curves:
            assert curve.y.tolist() == [getattr(o.models[curve.label], part) for o in few.outages]


def test_each_given_outage_is_shown_from_near(few):
    assert [own.name for own in few.pictures] == [str(k) for k in range(1, 8)]
    one = few.pictures[2]
    for name, errors in one.errors.items():
        assert errors.max() == pytest.approx(few.outages[2].models[name].own_max)
        assert one.tracks[name].shape == (errors.size + 1, 3)
        assert np.abs(one.tracks[name][0, :2] - one.reference[:, :2]).max(axis=1).min() < 1e-6  # rad
    shown = Shown()
    outage.draw(few, shown)
    assert [tab for tab in shown.tabs if tab.startswith("outage ")] == [f"outage {k}" for k in range(1, 8)]


def test_a_sweep_has_no_pictures(swept):
    assert swept.pictures == ()


def test_table_6_has_nine_states_at_three_levels(log, toml):
    options = {"error_model": toml, "models": "table6", "at": "130:10"}
    result = outage.run([log], stated(**options))
    assert [(f.name, len(f.states), f.causal) for f in result.filters] == [
        ("0 levels", 9, True), ("3 levels", 9, False), ("7 levels", 9, False),
    ]  # fmt: skip
    assert result.autoregressive_origin is None


def test_ar_processes_of_a_static_record(tmp_path, log):
    """Of the same model the processes of a record are those that are expected, but for its length; and the origin is named."""
    path, model = tmp_path / "still.mcap", sensor()
    write(static(model, 30 * 60.0, seed=1, rate=50.0), path)
    options = stated(static=path, models="15AR,27AR", at="130:10")
    found = with_static(model, options)
    for axis in AXES:
        assert [len(p.alpha) for p in found.axes[axis].autoregressive] == [1, 3]
        assert found.axes[axis].processes == model.axes[axis].processes
    model_file = tmp_path / "m.toml"
    model_file.write_text(model.to_toml(), "utf-8")
    result = outage.run([log], stated(error_model=model_file, static=path, models="15AR,27AR", at="130:10"))
    assert "still.mcap" in result.autoregressive_origin
    assert "autoregressive-origin" in ids(result.notes)
    assert not result.failed


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (sensor(), "computed from the processes"), (preset("3dm-gx3-25-paper"), "which has them"),
        (ImuErrorModel("deep", {a: AxisModel(Sum((*s.processes.terms, Autoregressive((0.1,) * 5, 1e-4, 0.01)))) for a, s in sensor().axes.items()}),
         "its own are of order 5"),
    ],
)  # fmt: skip
def test_the_origin_of_ar_processes(model, words):
    from imuwb.navigation import FilterModel

    base = FilterModel("b", model)
    assert words in origin_of(base, ("none", "15AR", "27AR"), 0.01, stated())
    assert origin_of(base, ("full",), 0.01, stated()) is None


def test_an_ar_model_without_white_noise_is_named(log, tmp_path):
    path = tmp_path / "ar.toml"
    axes = {a: AxisModel(Sum((Autoregressive((-0.99,), 1e-4, 0.02),))) for a in AXES}
    path.write_text(ImuErrorModel("ar", axes).to_toml(), "utf-8")
    result = outage.run([log], stated(error_model=path, models="15AR", at="130:10"))
    (note,) = [note for note in result.notes if getattr(note, "id", "") == "no-white-noise"]
    assert "15AR" in note
    assert any("no white noise" in text for text in outage.answer(result).sentences)
