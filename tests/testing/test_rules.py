# ruff: noqa: ARG005 - parts of plugins have the arguments of their contract
"""Each rule of the contract fails for a plugin that breaks it, and says what to do."""

import itertools
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Annotated

import numpy as np
import pytest

from imuwb.analysis import Answer, Figure, Table
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Conditioning, Log, Triad
from imuwb.options import Between, Options
from imuwb.readers.batch import Batch
from imuwb.testing import check, kind_of
from imuwb.testing.heads import heads, texts


@dataclass(frozen=True)
class Parameters(Options):
    """Options."""

    length: Annotated[float, "length (s)", Between(0.1, 10.0)] = 1.0


def run(logs, parameters):
    log = logs[0]
    return {"imu": log.imu().name, "samples": len(log.imu().axes())}


def draw(result, review):
    review.table(Table("Samples", ("imu", "axes"), ((result["imu"], str(result["samples"])),)))


def analysis(doc="Counts the axes.", **parts):
    return SimpleNamespace(**{"Parameters": Parameters, "run": run, "draw": draw, "__doc__": doc, **parts})


def states(plugin, **options):
    return {one.rule: one.state for one in check(plugin, "made", **options).outcomes}


def failed(plugin, **options):
    return {one.rule: one.text for one in check(plugin, "made", **options).failed}


def test_a_plain_analysis_passes():
    report = check(analysis(), "made")
    report.require()
    assert sum(one.state == "passed" for one in report.outcomes) >= 9


def test_a_broken_rule_is_an_assertion_error_with_its_text():
    with pytest.raises(AssertionError, match="help: failed: there is no docstring"):
        check(analysis(""), "made").require()


@dataclass
class NotFrozen:
    length: Annotated[float, "length (s)"] = 1.0


@dataclass(frozen=True)
class Unchecked:
    length: Annotated[float, "length (s)", Between(0.1)] = 1.0


@dataclass(frozen=True)
class Unexplained(Options):
    length: float = 1.0


@dataclass(frozen=True)
class NoText(Options):
    what: Annotated[complex, "a number that no text stands for"] = 1j


@pytest.mark.parametrize(
    ("kind", "rule", "named"),
    [
        (NotFrozen, "parameters", "not frozen"),
        (Unchecked, "parameters", "not refused"),
        (NoText, "parameters", "complex"),
        (Unexplained, "help", "length"),
    ],
)
def test_options_are_frozen_explained_and_checked(kind, rule, named):
    assert named in failed(analysis(Parameters=kind))[rule]


def _count():
    counter = itertools.count()
    return lambda logs, parameters: {"n": next(counter), "imu": logs[0].imu().name}


def _writes(logs, parameters):
    values = logs[0].imu().angular_rate.value
    values.flags.writeable = True
    values += 1.0
    return run(logs, parameters)


def _no_data_is_another_error(logs, parameters):
    if not logs[0].imus:
        raise IndexError("no imu")
    return run(logs, parameters)


@pytest.mark.parametrize(
    ("part", "rule", "named"),
    [
        ({"run": _count()}, "pure", "different results"),
        ({"run": lambda logs, p: {"x": float(np.random.rand())} if logs[0].imu() else {}}, "pure", "random"),  # noqa: NPY002
        ({"run": lambda logs, p: {"x": object()} if logs[0].imu() else {}}, "document", "type object"),
        ({"run": lambda logs, p: 3}, "runs", "returns a int"),
        ({"run": lambda logs, p: logs[7]}, "runs", "IndexError"),
        ({"run": _no_data_is_another_error}, "logs that lack data", "no imu"),
        ({"draw": lambda result, review: None}, "draws", "shows nothing"),
        ({"draw": lambda result, review: result.clear() or review.note("done")}, "draws", "changes the result"),
        ({"draw": lambda result, review: review.figure(Figure("f", "time", "y [1]", ()))}, "units", "'time'"),
        ({"draw": lambda result, review: review.table(Table("t", ("rate",), (("1.5",),)))}, "units", "1.5"),
        ({"answer": lambda result: "fine"}, "answer", "returns a str"),
        ({"answer": lambda result: Answer("x", rows=(("a",),) * 9)}, "answer", "9 rows"),
        ({"error_model": lambda result: "model"}, "parts that it offers", "error_model"),
        ({"LOGS": 2}, "parts that it offers", "LOGS"),
    ],
)  # fmt: skip
def test_what_an_analysis_breaks_is_named(part, rule, named):
    assert named in failed(analysis(**part))[rule]


def test_samples_that_a_run_changes_are_seen(monkeypatch):
    from imuwb.testing import logs as made

    made.still.cache_clear()
    try:
        assert "changes the samples" in failed(analysis(run=_writes))["runs"]
    finally:
        made.still.cache_clear()


def _markdown(result, review):
    import rerun as rr

    text = rr.TextDocument(f"# {result['imu']}", media_type=rr.MediaType.MARKDOWN)
    review.recording.log("/own", text, static=True)
    review.note("drawn")


def test_words_of_a_log_that_become_markdown_are_seen():
    from imuwb.testing import logs as made
    from imuwb.testing.analyses import analysis_outcomes

    log = replace(made.still(), imus=made.still().imus * 2)

    def names(logs, parameters):
        logs[0].imu()
        return {"imu": " ".join(imu.name for imu in logs[0].imus)}

    plugin = analysis(run=names, draw=_markdown)
    found = {one.rule: one.text for one in analysis_outcomes(plugin, "made", [log], {}) if one.state == "failed"}
    assert "become Markdown" in found["hostile words"]


def test_an_analysis_that_no_log_suits_is_not_judged():
    def lacks(logs, parameters):
        raise MissingDataError("no barometer")

    assert states(analysis(run=lacks))["runs"] == "not applicable"


def test_options_can_be_given():
    @dataclass(frozen=True)
    class Needs(Options):
        length: Annotated[float, "length (s)", Between(0.1)]

    assert "length must be given" in failed(analysis(Parameters=Needs))["runs"]
    check(analysis(Parameters=Needs), "made", parameters={"length": "2"}).require()
    assert "no option 'width'" in failed(analysis(Parameters=Needs), parameters={"width": "2"})["runs"]


@dataclass(frozen=True)
class Window(Options):
    """Options."""

    causal: Annotated[bool, "past samples only"] = False


def _shifted(log, by, values):
    """Return a log whose samples are means of each sample and one before or after it."""
    imu = log.imu()
    triads = []
    for t in (imu.angular_rate, imu.specific_force):
        rows = np.clip(np.arange(len(t)) - by, 0, len(t) - 1)
        triads.append(Triad(t.time, (t.value + t.value[rows]) / 2))
    return replace(log, imus=(replace(imu, angular_rate=triads[0], specific_force=triads[1]),), **values)


def conditioner(claim=None, by=None, doc="Means.", **changes):
    def condition(log: Log, parameters: Window):
        causal = parameters.causal if claim is None else claim
        shift = by if by is not None else 1 if parameters.causal else -1
        step = Conditioning("made", f"causal={str(parameters.causal).lower()}", causal, 0.0)
        changed = _shifted(log, shift, {"conditioning": (*log.conditioning, step), **changes}) if log.imus else log
        if changed is log:
            raise MissingDataError("no IMU")
        return changed, None

    return SimpleNamespace(Parameters=Window, condition=condition, __doc__=doc)


def without_gyro_only(plugin):
    """Refuse a log without an accelerometer, as the means of ``_shifted`` need both."""
    inner = plugin.condition

    def condition(log, parameters):
        if log.imus and log.imus[0].specific_force is None:
            raise MissingDataError("no accelerometer")
        return inner(log, parameters)

    return SimpleNamespace(**{**vars(plugin), "condition": condition})


def test_a_plain_conditioner_passes_and_both_claims_are_tried():
    report = check(without_gyro_only(conditioner()), "made")
    report.require()
    assert "not causal, causal" in next(one.text for one in report.outcomes if one.rule == "causality")


@pytest.mark.parametrize(
    ("plugin", "rule", "named"),
    [
        (conditioner(claim=True, by=-1), "causality", "claims to be causal"),
        (conditioner(claim=False, by=1), "causality", "claims not to be causal"),
        (conditioner(gnss=("lost",)), "keeps", "Log.gnss"),
        (conditioner(conditioning=()), "states itself", "one step more"),
        (conditioner(), "logs that lack data", "TypeError"),
    ],
)
def test_what_a_conditioner_breaks_is_named(plugin, rule, named):
    if rule != "logs that lack data":
        plugin = without_gyro_only(plugin)
    assert named in failed(plugin)[rule]


def test_a_conditioner_under_another_name_is_named():
    found = {one.rule: one.text for one in check(without_gyro_only(conditioner()), "other").failed}
    assert "'other'" in found["states itself"]


def reader(probe=lambda head: head.startswith(b"MADE"), stream=None, doc="Made files."):
    def rows(path, options):
        if path.read_bytes()[:4] != b"MADE":
            from imuwb.errors import UnreadableLogError

            raise UnreadableLogError(f"{path}: no log")
        time = np.arange(100, dtype=np.int64) * 10**7
        columns = {"angular_rate": np.full((100, 3), 0.1), "specific_force": np.full((100, 3), 9.8)}
        yield Batch("/imu", "imu", time, columns)

    return SimpleNamespace(format="made", probe=probe, stream=stream or rows, __doc__=doc)


@pytest.fixture
def made_file(tmp_path):
    path = tmp_path / "log.made"
    path.write_bytes(b"MADE" + bytes(100))
    return path


def test_a_plain_reader_passes(made_file):
    report = check(reader(), "made", logs=[made_file])
    report.require()
    assert {one.state for one in report.outcomes} == {"passed"}


def test_a_reader_that_claims_other_files_is_named():
    assert "CSV" in failed(reader(probe=lambda head: len(head) > 40))["probe of other formats"]
    assert "raises" in failed(reader(probe=lambda head: head[5] == 1))["probe of other formats"]
    assert "return True or False" in failed(reader(probe=lambda head: None))["probe of other formats"]


def _streams(**changes):
    def stream(path, options):
        path.read_bytes()[60]
        time = np.arange(4, dtype=np.int64)
        yield Batch(
            **{"stream": "/imu", "kind": "imu", "time": time, "columns": {"angular_rate": np.ones((4, 3))}, **changes}
        )

    return stream


@pytest.mark.parametrize(
    ("changes", "rule", "named"),
    [
        ({"columns": {"angular_rate": np.ones((3, 3))}}, "reads", "(3, 3)"),
        ({"columns": {"rate": np.ones((4, 3))}}, "reads", "'rate'"),
        ({"kind": "gyro"}, "reads", "'gyro'"),
        ({"time": np.arange(4.0)}, "reads", "float64"),
        ({}, "damaged files", "IndexError"),
    ],
)  # fmt: skip
def test_what_a_reader_breaks_is_named(made_file, changes, rule, named):
    assert named in failed(reader(stream=_streams(**changes)), logs=[made_file])[rule]


def test_a_probe_that_fails_on_its_own_log_is_named(made_file):
    plugin = reader(probe=lambda head: head.startswith(b"MADE") and head[500] == 0)
    assert "IndexError" in failed(plugin, logs=[made_file])["reads"]


def test_a_stream_of_what_is_no_row_is_named(made_file):
    assert "a int" in failed(reader(stream=lambda path, options: iter((1,))), logs=[made_file])["reads"]


def test_a_reader_has_no_options():
    with pytest.raises(UsageError, match="length"):
        check(reader(), "made", parameters={"length": "2"})


def test_a_reader_with_a_state_is_named(made_file):
    counter = itertools.count()

    def stream(path, options):
        columns = {"angular_rate": np.full((4, 3), float(next(counter)))}
        yield Batch("/imu", "imu", np.arange(4, dtype=np.int64), columns)

    assert "different rows" in failed(reader(stream=stream), logs=[made_file])["pure"]


def test_each_beginning_is_claimed_by_the_reader_of_its_format():
    """Otherwise the beginnings of files would show nothing."""
    from imuwb import registry

    readers = {name: point.load() for name, point in registry.installed(registry.READERS).items()}
    claimed = {what: [n for n, r in readers.items() if r.probe(head)] for what, (_, head) in heads().items()}
    for what, (own, _) in heads().items():
        assert not own or own in claimed[what], what
    assert all(readers["csv"].probe(head) for head in texts().values())
    assert sum(bool(own) for own, _ in heads().values()) >= 12


def test_what_is_no_plugin_is_refused():
    with pytest.raises(UsageError, match="no plugin"):
        kind_of(SimpleNamespace(Parameters=Parameters))
