"""Executors: a call that hangs, takes too much memory, crashes or is killed gives its own fault, and the others give their values."""

import builtins
import errno
import math
import os
import signal
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest

from imuwb.errors import ImuwbError
from imuwb.fleet import own_child
from imuwb.fleet.executor import Bounds, Call, Completed, Fault
from imuwb.fleet.in_process import InProcess
from imuwb.fleet.local_pool import LocalPool
from imuwb.fleet.running import ATTEMPTS, completed

BOUNDS = Bounds(600.0, 2e9)  #: wide: no slow machine reaches it
SHORT = Bounds(0.2, 2e9)  #: for a call that hangs
HANGS = (time.sleep, 600.0)
CALLS = [(math.sqrt, 4.0), HANGS, (bytearray, 10**11), (math.sqrt, -1.0), (math.sqrt, 9.0)]
DEADLY = [(signal.raise_signal, signal.SIGKILL), (signal.raise_signal, signal.SIGSEGV), (math.sqrt, 16.0)]
LOADED = "__import__('imuwb.cli.fleet.work') and [m in __import__('sys').modules for m in ('rerun', 'matplotlib')]"
#: its value raises where it is unpacked
UNREADABLE = "type('Odd', (), {'__reduce__': lambda self: (__import__('math').sqrt, (-1.0,))})()"

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the bound of memory is that of Linux")


def became(executor, calls, short=(HANGS,)):
    for number, call in enumerate(calls):
        executor.submit(number, Call(*call, SHORT if call in short else BOUNDS))
    done = {one.number: one for one in executor.as_completed()}
    executor.close()
    return [done[i].value if done[i].fault is None else done[i].fault.kind for i in range(len(calls))]


def test_a_loop_in_this_process_keeps_the_bounds():
    assert became(InProcess(), CALLS) == [2.0, "time", "memory", "fault", 3.0]


def test_an_import_is_not_torn(tmp_path, monkeypatch):
    (tmp_path / "slow_to_import.py").write_text("import time; time.sleep(0.5)")
    monkeypatch.syspath_prepend(tmp_path)
    imports = (builtins.eval, "__import__('slow_to_import').__name__")
    found = became(InProcess(), [imports, HANGS], (imports, HANGS))
    assert found == ["slow_to_import", "time"]


def test_a_pool_loses_only_the_call_whose_process_ends():
    assert became(LocalPool(2), [*CALLS, *DEADLY]) == [2.0, "time", "memory", "fault", 3.0, "lost", "crash", 4.0]


def test_workers_do_not_import_what_shows_results():
    assert became(LocalPool(1), [(builtins.eval, LOADED)]) == [[False, False]]


@pytest.fixture
def processes(monkeypatch):
    """Return a function that states how many processes may be started."""
    start = subprocess.Popen

    def limit(number):
        left = iter(range(number))

        def popen(*arguments, **options):
            if next(left, None) is None:
                raise OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))
            return start(*arguments, **options)

        monkeypatch.setattr(own_child.subprocess, "Popen", popen)

    return limit


@pytest.mark.parametrize(("number", "becomes"), [(0, ["lost"] * 4), (1, [2.0] * 4)])
def test_a_process_that_cannot_be_started_loses_no_call_of_the_others(processes, number, becomes):
    processes(number)
    assert became(LocalPool(2), [(math.sqrt, 4.0)] * 4) == becomes


def test_a_thread_that_cannot_be_started_loses_the_call(monkeypatch):
    def start(_):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading, "Timer", lambda *_: SimpleNamespace(start=lambda: start(0), cancel=lambda: None))
    assert became(LocalPool(1), [(math.sqrt, 4.0)]) == ["lost"]
    monkeypatch.setattr(threading.Thread, "start", start)
    with pytest.raises(ImuwbError, match="--workers 0"):
        became(LocalPool(1), [(math.sqrt, 4.0)])


def test_an_answer_that_cannot_be_read_loses_the_call():
    assert became(LocalPool(1), [(builtins.eval, UNREADABLE), (math.sqrt, 4.0)]) == ["lost", 2.0]


@pytest.mark.parametrize("starts", [(time.sleep, 600.0), (signal.raise_signal, signal.SIGSEGV)])
def test_a_worker_that_does_not_start_is_no_fault_of_the_log(monkeypatch, starts):
    monkeypatch.setattr(own_child, "STARTING", 3.0)
    prepare, argument = starts
    pool = LocalPool(1)
    pool.submit(0, Call(abs, argument, BOUNDS, prepare))
    (done,) = pool.as_completed()
    pool.close()
    assert (done.fault.kind, "start" in done.fault.message, "--task" in done.fault.message) == ("lost", True, False)


class Failing:
    """Gives faults of a kind before the values."""

    name, link, slots = "failing", "", 1

    def __init__(self, kind, times) -> None:
        self.left, self.fault, self.calls, self.most = times, Fault(kind, "as told"), [], 0

    def warm(self):
        pass

    def submit(self, number, call):
        self.calls.append((number, call))
        self.most = max(self.most, len(self.calls))

    def as_completed(self):
        while self.calls:
            number, call = self.calls.pop(0)
            self.left -= 1
            yield Completed(number, call.argument, self.fault if self.left >= 0 else None)

    def close(self):
        self.calls.clear()


@pytest.mark.parametrize(
    ("kind", "times", "fails"),
    [
        ("transport", 1, False),
        ("transport", 2, True),
        ("lost", 5, False),
        ("lost", 6, True),
        ("time", 1, True),
        ("fault", 1, True),
    ],
)
def test_only_faults_of_workers_and_transport_are_tried_again(kind, times, fails):
    (done,) = completed([Call(abs, 1, BOUNDS)], Failing(kind, times))
    assert (done.fault is not None) is fails
    assert times <= ATTEMPTS.get(kind, 1)


def test_calls_are_made_when_their_turn_comes():
    executor = Failing("fault", 0)
    done = list(completed((Call(abs, i, BOUNDS) for i in range(1000)), executor))
    assert [one.value for one in done] == list(range(1000))
    assert executor.most < 20


def test_a_run_ends_where_no_call_succeeds():
    with pytest.raises(ImuwbError, match="as told"):
        list(completed((Call(abs, i, BOUNDS) for i in range(1000)), Failing("lost", 10**6)))
