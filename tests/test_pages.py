"""The pages are executed: their Python blocks, and their plugin on the command line."""

import re
import sys
from pathlib import Path

import pytest

from imuwb.cli import main

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "docs" / page for page in ("reference/notebook.md", "how-to/plugin.md")]
BLOCKS = [b for page in PAGES for b in re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)]


@pytest.mark.slow
@pytest.mark.parametrize("block", [b for b in BLOCKS if "jerk" not in b])
def test_python_blocks_run(block, monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    exec(compile(block, "page", "exec"), {"__name__": "readme"})  # noqa: S102 - our own pages
    assert capsys.readouterr().out


def test_the_plugin_runs_and_is_as_short_as_its_page_states(monkeypatch, tmp_path, capsys):
    plugin = next(b for b in BLOCKS if b.startswith("# jerk.py"))
    assert len([line for line in plugin.splitlines() if line.strip()]) <= 27
    monkeypatch.chdir(tmp_path)
    Path("jerk.py").write_text(plugin, "utf-8")
    arguments = ["imuwb", "./jerk.py", str(ROOT / "samples" / "static.mcap"), "--axis", "x", "-o", "jerk.rrd"]
    monkeypatch.setattr(sys, "argv", arguments)
    with pytest.raises(SystemExit, match="0"):
        main()
    assert "m/s³" in capsys.readouterr().out
    assert Path("jerk.rrd").stat().st_size > 50_000


def test_the_plugin_of_the_page_keeps_its_contract(tmp_path):
    from imuwb import registry
    from imuwb.testing import check

    file = tmp_path / "jerk.py"
    file.write_text(next(b for b in BLOCKS if b.startswith("# jerk.py")), "utf-8")
    check(registry.load_file(file), "jerk", parameters={"axis": "x"}).require()


def test_the_plugin_runs_on_a_real_log(shared, monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    Path("jerk.py").write_text(next(b for b in BLOCKS if b.startswith("# jerk.py")), "utf-8")
    log = shared / "mcap" / "husky_test1_ros2cdr_zstd.mcap"
    monkeypatch.setattr(sys, "argv", ["imuwb", "./jerk.py", str(log), "-o", "husky.rrd"])
    with pytest.raises(SystemExit, match="0"):
        main()
    assert "m/s³" in capsys.readouterr().out
    assert Path("husky.rrd").exists()
