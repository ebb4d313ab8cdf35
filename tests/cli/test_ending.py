"""A command whose output nobody reads, or is closed, does its work all the same."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
CLOSING = {
    "closed": "import os; os.close(1); os.close(2)",
    "not read": "import os; r, w = os.pipe(); os.close(r); os.dup2(w, 1); os.dup2(w, 2)",
}


@pytest.mark.slow
@pytest.mark.parametrize("how", CLOSING)
def test_files_are_written_and_the_exit_code_is_that_of_the_work(tmp_path, static_mcap, how):
    start = f"{CLOSING[how]}; import sys; os.execv(sys.executable, [sys.executable, '-m', 'imuwb', *sys.argv[1:]])"
    environment = {
        **os.environ,
        "PYTHONUNBUFFERED": "",
        "PYTHONPATH": os.pathsep.join((str(REPOSITORY), str(REPOSITORY / "plugins"))),
    }

    def code(*words):
        command = [sys.executable, "-c", start, *map(str, words)]
        return subprocess.run(command, cwd=tmp_path, check=False, env=environment).returncode

    assert code("convert", static_mcap, "-o", "o.csv") == 0
    assert (tmp_path / "o.csv").read_text("utf-8").startswith("time_ns,")
    assert code("info", static_mcap, "--json") == 0
    assert code("info", "nothing.mcap") == 4


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="names that are not UTF-8")
def test_a_log_whose_name_is_not_utf_8_has_all_outputs(imuwb, tmp_path, static_mcap):
    log = Path(os.fsdecode(os.fsencode(tmp_path) + b"/b\xff.mcap"))
    static_mcap.rename(log)
    assert imuwb("psd", log, "--json", "o.json", "--html", "o.html", "--force").code == 0
    assert json.loads((tmp_path / "o.json").read_text("utf-8"))["logs"][0]["path"].endswith(
        "b\N{REPLACEMENT CHARACTER}.mcap"
    )
    assert log.with_suffix(".rrd").stat().st_size > 10_000


def test_a_log_that_does_not_fit_in_memory_is_a_plain_sentence(imuwb, static_mcap, monkeypatch):
    def grow(*_):
        raise MemoryError

    monkeypatch.setattr("imuwb_plugins.psd.run", grow)
    done = imuwb("psd", static_mcap)
    assert (done.code, "does not fit in memory; analyse a part of the log" in done.err) == (1, True)
    assert sorted(os.listdir(static_mcap.parent)) == ["static.mcap"]
