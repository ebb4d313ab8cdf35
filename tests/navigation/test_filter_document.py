"""Filters as documents: what is written is read, and what is no filter is refused with the place."""

from dataclasses import replace

import pytest

from imuwb.errors import UsageError
from imuwb.navigation import Aids, FilterModel, Installation, Settings, filter_text, read_filter
from imuwb.replay import model_named
from imuwb.simulation import preset

BASE = FilterModel("base", preset("3dm-gx3-25-gm"))


def test_a_filter_is_read_as_it_is_written(tmp_path):
    model = replace(
        model_named("18AVWD", BASE, interval=0.01, turn_on=(1e-3, 0.05)), reading="printed variances", scale_factor=(0.01, 0.02),
        installation=Installation((180.0, -6.79, 185.35), (0.0, -0.05, 0.0), -0.12, 0.13, 1.000275, 0.001),
        settings=Settings(every=5, gate=30.0, settling=20.0, gnss_correlation=(1.5, 60.0)), aids=Aids(0.2, 0.05, 0.1),
    )  # fmt: skip
    file = tmp_path / "filter.toml"
    file.write_text(filter_text(model), "utf-8")
    again = read_filter(file)
    assert read_filter(str(file)).name == again.name
    assert filter_text(again) == filter_text(model)
    for part in ("name", "reading", "scale_factor", "wavelet_levels", "installation", "settings", "aids"):
        assert getattr(again, part) == getattr(model, part)
    assert again.states(0.01) == model.states(0.01)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda t: t.replace("schema = 1", "schema = 9"), "filter of schema 1"),
        (lambda t: t.replace('filter = "15AV"', 'filter_name = "15AV"'), "filter of schema 1"),
        (lambda t: t.replace("every = 10", "every = 0"), r"settings, every is 0"),
        (lambda t: t.replace("every = 10", 'every = "ten"'), "settings, every is 'ten'"),
        (lambda t: t.replace("gate = 40.0", "gate = nan"), "settings, gate"),
        (lambda t: t.replace("gate = 40.0", "gates = 40.0"), "settings: unknown gates; .* every, gate"),
        (
            lambda t: t.replace('reading = "corrected"', 'reading = "roughly"'),
            "reading is 'roughly'.* corrected, printed variances, printed densities",
        ),
        (lambda t: t.replace("wavelet_levels = []", "wavelet_levels = [3]"), "six whole numbers"),
        (lambda t: t.replace("wavelet_levels = []", "wavelet_levels = 5"), "wavelet_levels is 5; it must be a list"),
        (lambda t: t.replace("wavelet_levels = []", f"wavelet_levels = {'[' * 40}{']' * 40}"), "nests deeper"),
        (lambda t: t.replace("[aids]", "[helpers]"), "unknown helpers"),
        (lambda t: t.partition("[error_model]")[0], "table error_model"),
        (lambda t: t.replace("gauss_markov", "gauss"), "error_model"),
        (lambda t: t + "]", "not TOML"),
    ],
)
def test_what_is_no_filter_is_refused_with_its_place(tmp_path, change, says):
    file = tmp_path / "filter.toml"
    file.write_text(change(filter_text(model_named("15AV", BASE, interval=0.01))), "utf-8")
    with pytest.raises(UsageError, match=says) as error:
        read_filter(file)
    assert "filter.toml" in str(error.value)


def test_a_file_that_is_not_there_is_said_to_be_that(tmp_path):
    with pytest.raises(UsageError, match="none.toml: cannot be read as a filter"):
        read_filter(tmp_path / "none.toml")
