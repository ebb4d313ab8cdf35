"""What the command line sets in its own process."""

import importlib
import os
import subprocess
import sys

import pytest

from imuwb import own_process
from imuwb.own_process import THREADS, environment, without

PACKAGE = "imuwb_package_of_a_test"


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Return the name of a package that is installed and not imported."""
    (tmp_path / f"{PACKAGE}.py").write_text("", "utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.invalidate_caches()
    yield PACKAGE
    sys.modules.pop(PACKAGE, None)


def test_a_package_is_absent_within_the_context_alone(package, monkeypatch):
    monkeypatch.setattr(own_process, "_own", True)
    with without(package), pytest.raises(ModuleNotFoundError, match=package):
        importlib.import_module(package)
    assert importlib.import_module(package).__name__ == package


def test_a_package_that_is_imported_stays(package, monkeypatch):
    importlib.import_module(package)
    monkeypatch.setattr(own_process, "_own", True)
    with without(package):
        assert importlib.import_module(package).__name__ == package


def test_a_program_that_uses_imuwb_keeps_its_packages(package, monkeypatch):
    monkeypatch.setattr(own_process, "_own", False)
    with without(package):
        assert importlib.import_module(package).__name__ == package


@pytest.mark.parametrize("given", [None, "3"])
def test_other_programs_get_the_threads_that_were_given(given, monkeypatch):
    monkeypatch.setenv(THREADS, "1")
    monkeypatch.setattr(own_process, "_given", given)
    expected = {name: value for name, value in os.environ.items() if name != THREADS}
    assert environment() == (expected if given is None else expected | {THREADS: given})


#: A program that ends while a thread of pyarrow reads ahead from a Python object, as after a log that is damaged in its middle.
READS_AHEAD = """
import io, time
from imuwb import own_process

def program():
    own_process.command_line()
    import pyarrow as pa
    from pyarrow import csv

    class Slow(io.RawIOBase):
        begun = False
        def readable(self):
            return True
        def read(self, size=-1):
            time.sleep(0.05 * self.begun)
            self.begun = True
            return b"1.0,2.0\\n" * (1 << 14)

    reader = csv.open_csv(pa.PythonFile(Slow(), "r"), csv.ReadOptions(column_names=["a", "b"], block_size=1 << 16))
    reader.read_next_batch()
    print("done")
    raise SystemExit(3)

own_process.run_program(program)
"""


def ended(program):
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)


def test_a_thread_that_reads_ahead_does_not_abort_a_process_that_is_done():
    done = ended(READS_AHEAD)
    assert (done.returncode, done.stdout.strip(), done.stderr) == (3, "done", "")


@pytest.mark.parametrize(
    ("program", "code", "said"),
    [("print('whole')", 0, ""), ("exit(2)", 2, ""), ("exit('why')", 1, "why"), ("1 / 0", 1, "ZeroDivisionError: division by zero")],
)  # fmt: skip
def test_the_exit_code_is_that_of_the_program(program, code, said):
    done = ended(f"from imuwb.own_process import run_program\ndef program():\n    {program}\nrun_program(program)")
    assert done.returncode == code
    assert said in done.stderr
    assert done.stdout.strip() == ("whole" if code == 0 else "")


def test_the_command_line_in_another_program_does_not_end_it():
    text = "import sys\nfrom imuwb.cli import main\nsys.argv = ['imuwb', 'info', 'gone']\ntry:\n    main()\nexcept SystemExit as e:\n    print(e.code)\nexit(7)"
    done = ended(text)
    assert (done.returncode, done.stdout.strip()) == (7, "4")
