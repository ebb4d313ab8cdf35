"""The words of a log do nothing in any output of an analysis: terminal, JSON, page, figures, tables, recording, saved model."""

import json
import sys
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from imuwb.log import Triad
from imuwb.simulation import drive, hand_held, mixed_route, preset, static
from imuwb.writers import write

from .test_hostile_words import check, documents, live_markdown

NAME = (
    "/\\input{x}\x1b]52;c;aGVsbG8=\x07\x1b[2K\u202e\n# HEAD\n![p](http://127.0.0.1:9/p.png)[l](file:///etc/passwd)```\"'>"
    "<img src=http://127.0.0.1:9/><script>fetch(1)</script>" + "y" * 300
)
FILE = "a\x1b[2J\u202e\n![p](file:)\"'`$(x)" if sys.platform != "win32" else "a![p]`$(x)"
MAKES_ACTIVE = ("<img src=http", "<script>fetch", "<image", 'href="file:', "src='http")
OUTPUTS = ("-o", "r.rrd", "--json", "r.json", "--html", "r.html", "--tables", "tables", "--full")
FIGURES = (
    "--figures",
    "figures",
    "--figure-format",
    "svg",
)  #: where there are few; those of a page are drawn by the same code


DRIVE = (
    "--error-model", "mpu-6050", "--models", "15AV", "--durations", "5", "--settling", "5", "--random", "2", "--gnss-delay", "0",
    "--clock-rate", "1", "--mounting", "0,0,0", "--save-filter", "f.toml",
)  # fmt: skip


def renamed(log, number=0):
    """Return a log whose IMU, thermometer and receiver have a hostile name."""
    (imu,) = log.imus
    name = f"{NAME}{number}"
    heat = None if imu.temperature is None else replace(imu.temperature, name=f"{name}t")
    own = replace(imu, name=name, temperature=heat)
    return replace(log, imus=(own,), gnss=tuple(replace(gnss, name=f"{name}g") for gnss in log.gnss))


def still(folder, count):
    """Write still logs of a single gyro, which take little time."""
    paths = []
    for k in range(count):
        log = renamed(static(preset("mpu-6050"), 44, 25, k), k)
        rate = log.imus[0].angular_rate
        lone = Triad(rate.time, np.where([True, False, False], rate.value, np.nan))
        paths.append(folder / f"{k}{FILE}.mcap")
        write(replace(log, imus=(replace(log.imus[0], angular_rate=lone, specific_force=None),)), paths[-1])
    return paths


def held(folder):
    log = hand_held(preset("mpu-6050"), 1, positions=10, seconds=3.0, table=8.0, rate=50.0).log
    write(renamed(log), path := folder / f"{FILE}.mcap")
    return [path]


def driven(folder):
    log = drive(preset("mpu-6050"), mixed_route(90, 1), 1, rate=20)
    write(renamed(log), path := folder / f"{FILE}.mcap")
    return [path]


def tables(folder, form):
    return [path.read_text("utf-8") for path in (folder / "tables").glob(f"*.{form}")]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "logs", "options", "form"),
    [
        ("noise", lambda folder: still(folder, 1), ("--no-choose", "--denoise", "0", *FIGURES), "md"),
        ("temperature", lambda folder: still(folder, 2), ("--celsius", "10,30"), "latex"),
        ("calibration multi-position", held, FIGURES, "csv"),
        ("outage", driven, DRIVE, "md"),
    ],
)
def test_no_output_of_an_analysis_passes_on_what_a_log_writes(imuwb, tmp_path, command, logs, options, form):
    paths = logs(tmp_path)
    given = {path.name for path in paths}
    done = imuwb(*command.split(), *paths, *options, *OUTPUTS, "--table-format", form)
    assert done.code == 0, done.err
    verify(tmp_path, done, given, form)


def verify(folder, done, given, form):
    """Check all that an analysis has left in a folder."""
    check(done.out, "stdout")
    check(done.err, "stderr")
    left = [path for path in folder.rglob("*") if path.is_file() and path.name not in given]
    assert {path.suffix for path in left} >= {".rrd", ".json", ".html", ".toml"}
    for path in left:
        check(path.name, "the name of a file")
        if path.suffix == ".rrd":
            continue
        text = path.read_text("utf-8")
        check(text, path.name)
        if path.suffix in (".html", ".svg"):
            assert not [mark for mark in MAKES_ACTIVE if mark in text], path.name
    assert "input{x}" in (folder / "r.html").read_text("utf-8")  # its words are there
    assert json.loads((folder / "r.json").read_text("utf-8"))
    for path in folder.glob("*.toml"):
        assert tomllib.loads(path.read_text("utf-8"))
    for text in tables(folder, form):
        assert form != "md" or not live_markdown(text), text
        assert form != "latex" or "\\input{x}" not in text, text
    shown = documents(folder / "r.rrd")
    assert any("input" in text for text in shown.values())
    for place, text in shown.items():
        check(text, place)
        assert not live_markdown(text), place
