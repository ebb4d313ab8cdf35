"""The first letters that a command writes to a terminal do not wait for slow libraries."""

import ast
import subprocess
import sys

import pytest

HEAVY = {"scipy.signal", "scipy.optimize", "numba", "rerun", "matplotlib", "pandas", "pyarrow"}
#: ends the process at the first letters, and then states the modules that were imported
CODE = """
import io, os, sys
class Terminal(io.StringIO):
    def isatty(self):
        return True
    def write(self, text):
        if not isinstance(text, str):
            raise TypeError
        if text.strip() and not text.startswith("\\x1b[?25"):
            os.write(1, repr((text, sorted(sys.modules))).encode())
            os._exit(0)
        return len(text)
sys.argv = ["imuwb", *sys.argv[1:]]
sys.stdout = sys.stderr = Terminal()
from imuwb.cli import main
main()
"""


@pytest.mark.parametrize(
    ("command", "first"),
    [
        ("simulate chamber --preset mpu-6050 --hours 0.01 -o chamber", "note: mpu-6050"),
        ("model show mpu-6050", "MODEL"),
        ("plan --preset mpu-6050", "planning"),
        ("catalog .", "reading the recordings"),
        ("report some.rrd", "reading some.rrd"),
    ],
)
def test_the_first_letters_wait_for_no_slow_library(command, first, tmp_path):
    (tmp_path / "some.rrd").write_bytes(b"RRF2" + bytes(64) + b"RRF2FOOT" + bytes(4))
    done = subprocess.run(
        [sys.executable, "-c", CODE, *command.split()], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    text, modules = ast.literal_eval(done.stdout)
    assert first in text
    assert not HEAVY & set(modules)
