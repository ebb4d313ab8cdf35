"""``imuwb info``: the streams of a log, its faults, and when a log is read as a whole."""

import json
from types import SimpleNamespace

import pytest

from imuwb import health
from imuwb.cli import info


def test_faults_are_counted_and_the_analysis_of_faults_is_named(imuwb, csv_log, rows):
    lines = rows()
    jumped = [f"{float(line.split(',')[0]) + 1.7e9:.2f},{line.partition(',')[2]}" for line in lines[50:]]
    shown = imuwb("info", csv_log([*lines[:50], *jumped])).err
    assert "faults and warnings" in shown
    assert "53.9 years" in shown
    assert "imuwb health" in shown


def test_notes_are_not_counted_as_faults(imuwb, static_mcap, monkeypatch):
    def faults(*severities):
        found = [SimpleNamespace(severity=s, count=1, stream="imu", what="gap") for s in severities]
        monkeypatch.setattr(health, "check", lambda *_, **__: SimpleNamespace(faults=found))
        return imuwb("info", static_mcap).err

    assert "imuwb health" not in faults("note")
    assert "2 faults" in faults("fault", "warning", "note")


@pytest.mark.parametrize(("arguments", "read"), [((), False), (("--scan",), True)])
def test_a_large_log_is_summarized_from_its_index(imuwb, static_mcap, monkeypatch, arguments, read):
    seen = []
    monkeypatch.setattr(info, "show_faults", lambda log, _: seen.append(log))
    monkeypatch.setattr(info, "LARGE", static_mcap.stat().st_size - 1)
    assert imuwb("info", static_mcap, *arguments).code == 0
    assert bool(seen) == read
    count = json.loads(imuwb("info", static_mcap, *arguments, "--json").out)["streams"][0]["count"]
    assert count == 3000


def test_logs_up_to_256_mib_are_read():
    assert info.LARGE == 268_435_456
