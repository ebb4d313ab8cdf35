"""A command whose output nobody reads, or is closed, does its work all the same."""

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
