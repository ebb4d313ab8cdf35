"""Room for a library that ends the process where memory lacks."""

import subprocess
import sys

import pytest

from imuwb.readers.bytes.memory_limit import check_room


def test_there_is_room_for_a_megabyte_and_none_for_more_than_there_is():
    check_room(1 << 20)
    with pytest.raises(MemoryError):
        check_room(1 << 62)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not enforce the limit")
@pytest.mark.parametrize("megabytes", [4, 28, 48])  # an import fails, a thread does, and pyarrow never ends
def test_a_table_in_little_memory_is_a_plain_sentence(tmp_path, megabytes):
    rows = "\n".join(f"{i / 100},0.1,0.1,9.8" for i in range(300_000))
    (tmp_path / "log.csv").write_text("time_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n" + rows, "utf-8")
    program = """
import resource, sys
from pathlib import Path
import imuwb.cli.app, imuwb.readers.assembly.assemble, imuwb.readers.text.cells, imuwb.writers.mcap_log
from imuwb.cli import main
pages = int(Path("/proc/self/statm").read_text().split()[0])
limit = pages * resource.getpagesize() + (int(sys.argv.pop(1)) << 20)
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
main()
"""
    done = subprocess.run(
        [sys.executable, "-c", program, str(megabytes), "convert", "log.csv", "-o", "o.mcap"],
        cwd=tmp_path, capture_output=True, text=True, check=False, timeout=100,
    )  # fmt: skip
    assert (done.returncode, "does not fit in memory" in done.stderr, "Traceback" in done.stderr) == (1, True, False), (
        done.stderr
    )
    assert not (tmp_path / "o.mcap").exists()
