"""A process that runs calls for the process that started it: ``python -m imuwb.fleet.child``.

The calls come as pickles on stdin, and the answers go to what was stdout: ``BEGAN`` when the function is imported, then what became
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
from imuwb.fleet.in_process import outcome

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
            call = pickle.load(sys.stdin.buffer)  # noqa: S301 - as above
            _send(BEGAN, answers)
            watch.memory = call.bounds.memory
            done = outcome(0, call)
            watch.memory = 0.0
            _send(done, answers)


def _send(value: object, answers: BinaryIO) -> None:
    pickle.dump(value, answers)
    answers.flush()


if __name__ == "__main__":
    main()
