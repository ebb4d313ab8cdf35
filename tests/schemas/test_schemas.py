"""The published schemas describe what imuwb writes, and nothing else."""

import json
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.review.answers.document import plain
from imuwb.schemas import schema, schema_names
from imuwb.schemas.of_types import Schemas
from imuwb.stochastic import GaussMarkov, Process
from imuwb.testing import logs as made
from imuwb.writers import write

PRESETS = Path(__file__).resolve().parents[2] / "imuwb" / "simulation" / "preset_data"


def faults(name, document):
    validator = Draft202012Validator(schema(name))
    return [f"{'/'.join(map(str, e.absolute_path))}: {e.message:.200}" for e in validator.iter_errors(document)]


@pytest.fixture(scope="module")
def turned(tmp_path_factory):
    path = tmp_path_factory.mktemp("logs") / "turned.mcap"
    write(made.turned(), path)
    return path


def test_every_document_has_a_schema_that_is_one():
    names = schema_names()
    assert {
        "error-model",
        "settings",
        "fleet-run",
        "log-summary",
        "analysis-outage",
        "analysis-calibration-six-position",
    } <= set(names)
    for name in names:
        content = schema(name)
        Draft202012Validator.check_schema(content)
        assert content["title"]
    with pytest.raises(UsageError, match="analysis-psd"):
        schema("nothing")


@pytest.mark.parametrize(
    ("name", "command"),
    [
        ("psd", ("psd",)),
        ("health", ("health",)),
        ("autoregressive", ("autoregressive", "--orders", "3", "--through", "decimate:factor=2")),
        ("calibration-multi-position", ("calibration", "multi-position")),
    ],
)
def test_results_of_analyses(imuwb, tmp_path, turned, name, command):
    done = imuwb(*command, turned, "--json", "result.json", "-o", "r.rrd", "--save-config", "settings.toml", "--force")
    assert done.code == 0, done.err
    document = json.loads((tmp_path / "result.json").read_text("utf-8"))
    assert faults(f"analysis-{name}", document) == []
    assert faults("settings", tomllib.loads((tmp_path / "settings.toml").read_text("utf-8"))) == []
    for path in tmp_path.glob("*.calibration.toml"):
        assert faults("error-model", tomllib.loads(path.read_text("utf-8"))) == []
    document["result"] = {**document["result"], "odd": 1}
    assert faults(f"analysis-{name}", document)


def test_other_documents_as_json(imuwb, turned):
    for name, command in (
        ("log-summary", ("info", turned, "--json")),
        ("plan", ("plan", "--want", "N:1%", "--preset", "adis16465", "--json")),
        ("plugin-check", ("plugins", "check", "decimate", "--with", "factor=2", "--json")),
    ):
        document = json.loads(imuwb(*command).out)
        assert faults(name, document) == []
        assert faults(name, {**document, "odd": 1})


def test_a_run_of_a_fleet(imuwb, tmp_path, turned):
    done = imuwb("fleet", "psd", turned, "-o", tmp_path / "results")
    assert done.code == 0, done.err
    document = json.loads((tmp_path / "results" / "run.json").read_text("utf-8"))
    assert faults("fleet-run", document) == []
    assert faults("fleet-run", {**document, "state": "lost"})


def test_error_models():
    validator = Draft202012Validator(schema("error-model"))
    models = [tomllib.loads(path.read_text("utf-8")) for path in PRESETS.glob("*.toml")]
    models = [model for model in models if "schema" in model]
    assert len(models) >= 5
    for model in models:
        assert [e.message for e in validator.iter_errors(model)] == []
    kinds = {
        row["process"]
        for model in models
        for a in model.values()
        if isinstance(a, dict)
        for row in a.get("processes", ())
    }
    assert kinds
    one = {"schema": 1, "name": "a", "gyro_x": {"processes": [{"process": min(kinds)}]}}
    assert not validator.is_valid(one)  # its parameters are missing
    assert not validator.is_valid({"schema": 1, "name": "a"})  # no axis
    assert not validator.is_valid({"schema": 2, "name": "a", "gyro_x": {"processes": []}})
    assert not validator.is_valid({"schema": 1, "name": "a", "gyro_x": {"processes": [], "bias": "about 3"}})
    assert not validator.is_valid({"schema": 1, "name": "a", "gyro_x": {"processes": [], "bias": {"unit": "deg/s"}}})
    assert validator.is_valid({"schema": 1, "name": "a", "gyro_x": {"processes": [], "bias": "3e-2 deg/s"}})
    assert not validator.is_valid({"schema": 1, "name": "a", "gyro_w": {"processes": []}})


def test_settings_of_another_command_are_refused():
    assert faults("settings", {"command": "psd", "segment": 4096}) == []
    assert faults("settings", {"command": "psd", "durations": 30})
    assert faults("settings", {"command": "model show", "model": "a.toml"}) == []


@dataclass(frozen=True)
class Inner:
    kind: Literal["a", "b"]
    pair: tuple[int, float]
    left_out: object = field(default=None, metadata={"document": False})


@dataclass(frozen=True)
class Outer:
    values: Floats
    inner: dict[str, Inner]
    many: tuple[Inner, ...]
    place: Path | None
    process: Process
    limit: float


def test_a_type_is_described_as_it_is_written():
    schemas = Schemas()
    whole = {**schemas.of(Outer), "$defs": schemas.definitions}
    inner = Inner("a", (1, 2.0), object())
    value = Outer(np.ones((2, 3)), {"x": inner}, (inner,), Path("a"), GaussMarkov(1.0, 2.0), float("inf"))
    validator = Draft202012Validator(whole)
    document = plain(value)
    assert [e.message for e in validator.iter_errors(document)] == []
    for change in (
        {"values": {"a": 1}}, {"inner": {"x": {"kind": "c", "pair": [1, 2.0]}}}, {"many": [{"kind": "a", "pair": [1]}]},
        {"place": 3}, {"process": {"process": "none"}}, {"limit": "x"}, {"odd": 1},
    ):  # fmt: skip
        assert not validator.is_valid({**document, **change}), change
    assert not validator.is_valid({name: item for name, item in document.items() if name != "limit"})
