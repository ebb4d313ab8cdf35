from importlib.metadata import EntryPoint

import pytest

from imuwb import registry
from imuwb.errors import UsageError


@pytest.fixture(autouse=True)
def _empty_cache():
    registry.installed.cache_clear()
    yield
    registry.installed.cache_clear()


def points(monkeypatch, *found):
    monkeypatch.setattr(registry, "entry_points", lambda group: [EntryPoint(n, v, group) for n, v in found])


def test_two_plugins_of_one_name_are_an_error_that_names_both(monkeypatch):
    points(monkeypatch, ("allan", "one.module"), ("allan", "another.module"))
    with pytest.raises(UsageError, match=r"one\.module.*another\.module"):
        registry.installed("imuwb.analyses")


def test_a_broken_plugin_is_a_warning_that_names_it(monkeypatch):
    points(monkeypatch, ("broken", "no_such_module_here"))
    (point,) = registry.installed("imuwb.analyses").values()
    with pytest.warns(registry.PluginWarning, match="broken.*no_such_module_here"):
        assert registry.load(point) is None


def test_a_broken_plugin_leaves_the_others_working(monkeypatch, capsys):
    from imuwb.cli.app import build

    everything = registry.entry_points(group=registry.ANALYSES)
    points(monkeypatch, *((p.name, p.value) for p in everything), ("broken", "no_such_module_here"))
    with pytest.warns(registry.PluginWarning), pytest.raises(SystemExit):
        build(["--help"])(["--help"], prog_name="imuwb")
    assert "allan" in capsys.readouterr().out


def test_a_file_may_hold_dataclasses(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(
        "from __future__ import annotations\nfrom dataclasses import dataclass\n@dataclass\nclass A:\n    x: int = 3\n"
    )
    assert registry.load_file(file).A().x == 3


@pytest.mark.parametrize(("text", "named"), [("x = (", "line 1"), ("raise RuntimeError('no')", "RuntimeError: no")])
def test_a_file_that_cannot_be_imported_is_an_error_with_the_reason(tmp_path, text, named):
    file = tmp_path / "mine.py"
    file.write_text(text)
    with pytest.raises(UsageError, match=named):
        registry.load_file(file)
