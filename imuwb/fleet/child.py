"""A process that runs calls for the process that started it: ``python -m imuwb.fleet.child``.

The calls come as pickles on stdin, and the answers go to what was stdout: ``BEGAN`` when the call is prepared, then what became
of the call. A bound that is reached ends the process after its answer. multiprocessing is not used, because its processes may have no
children of their own where they are those of a cluster.
"""

import os
import pickle
import signal
import sys
from contextlib import suppress
from typing import BinaryIO

from imuwb import own_process
from imuwb.fleet import bounds
from imuwb.fleet.executor import Call, Completed, Fault
from imuwb.fleet.in_process import outcome, prepared

BEGAN = "began"


def main() -> None:
    """Run calls until stdin ends."""
    own_process.command_line()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever started this process ends it
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a plugin prints is no answer
    watch = bounds.Watch()
    with suppress(EOFError, BrokenPipeError):
        sys.path[:] = pickle.load(sys.stdin.buffer)  # noqa: S301 - from the process that started this one
        while not bounds.tripped:
            packed = pickle.load(sys.stdin.buffer)  # noqa: S301 - as above
            done, call = _unpacked(packed)
            _send(BEGAN, answers)
            if done is None and call is not None:
                watch.memory = call.bounds.memory
                done = outcome(0, call)
                watch.memory = 0.0
            _send(done, answers)


def _unpacked(packed: bytes) -> tuple[Completed | None, Call | None]:
    """Return a prepared call; or, if its function or its module cannot be imported, the fault."""
    try:
        call: Call = pickle.loads(packed)  # noqa: S301 - from the process that started this one
    except Exception as error:  # noqa: BLE001 - a module may raise anything
        return Completed(
            0, fault=Fault("fault", f"a worker cannot import the work: {type(error).__name__}: {error}")
        ), None
    return prepared(0, call), call


def _send(value: object, answers: BinaryIO) -> None:
    pickle.dump(value, answers)
    answers.flush()


if __name__ == "__main__":
    own_process.run_program(main)
