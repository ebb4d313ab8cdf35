"""Reading a small file imports no more than its format needs."""

import subprocess
import sys

import pytest

T = 1_714_564_800 * 10**9
HEAVY = {"numba", "scipy", "pandas", "rerun", "imuwb.identification", "imuwb.health"}
CODE = "import sys, imuwb\nlog = imuwb.read(sys.argv[1])\nprint(len(log.imu().angular_rate), *sys.modules)"


def modules_after_reading(path):
    """Return the number of samples, and the modules that a new process imports to read a file."""
    done = subprocess.run([sys.executable, "-c", CODE, path], capture_output=True, text=True, check=True)
    samples, *modules = done.stdout.split()
    return int(samples), set(modules)


@pytest.mark.slow
def test_a_small_text_log_needs_its_parser_alone(text_log):
    rows = "".join(f"{i / 100},1,2,3,0,0,-1\n" for i in range(500))
    samples, modules = modules_after_reading(text_log(f"time_s,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g\n{rows}"))
    assert (samples, modules & HEAVY) == (500, set())
    assert "pyarrow" in modules


def test_a_small_mcap_needs_neither_the_compiler_nor_the_parser_of_text(mcap, ros):
    messages = [(T + i * 10**7, ros.imu(T + i * 10**7, (1, 2, 3), (0, 0, 9.8))) for i in range(100)]
    samples, modules = modules_after_reading(mcap.write(mcap.Topic(messages)))
    assert (samples, modules & (HEAVY | {"pyarrow", "sqlite3"})) == (100, set())
