import shlex
import sys
from pathlib import Path

import pytest

from imuwb.cli.typed import typed_again


@pytest.mark.parametrize(
    ("typed", "again"),
    [
        ("outage drive.mcap --error-model m.toml", "imuwb outage drive.mcap --error-model m.toml -o out/drive-2.rrd"),
        ("outage d.mcap -o x.rrd --json - --html p.html --force --at 200:30", "imuwb outage d.mcap --at 200:30 -o out/drive-2.rrd"),
        ("outage d.mcap --output=x.rrd --save-filter f.toml", "imuwb outage d.mcap -o out/drive-2.rrd"),
    ],
)  # fmt: skip
def test_a_command_that_is_typed_again_overwrites_nothing(monkeypatch, typed, again):
    monkeypatch.setattr(sys, "argv", ["imuwb", *shlex.split(typed)])
    assert typed_again(Path("out/drive.rrd")).replace("\\", "/") == again
