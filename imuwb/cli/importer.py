"""An importer of the Rerun viewer: ``rerun FILE`` opens a log through imuwb.

The viewer runs ``rerun-importer-imuwb FILE --application-id A --recording-id R`` for every file, and reads a recording from
stdout. Exit code 66 declines a file; this must be quick.
"""

import shutil
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

from imuwb import own_process

NOT_OURS = 66  #: exit code
HEAD = 4096  #: bytes by which the format is judged
#: first bytes of the binary formats that imuwb reads, and of the formats that the viewer itself reads
_MAGICS = (b"ULog\x01\x12\x35", b"#ROSBAG V2.0\n", b"SQLite format 3\0")
_THEIRS = (b"\x89MCAP0\r\n", b"RRF2", b"RRIO")
_TEXT = (b"% program", b"% (", b"%  GPST", b"FMT, 128")
_SUFFIXES = (".csv", ".pos", ".tlog", ".bin", ".log", ".ulg", ".bag", ".db3")


def program() -> None:
    """Import one file as the program of this process."""
    own_process.run_program(main)


def main() -> None:
    """Import one file, or decline it."""
    paths = [argument for argument in sys.argv[1:] if not argument.startswith("-")]
    if not paths:
        sys.stderr.write("rerun-importer-imuwb: only the Rerun viewer runs this program; use imuwb info LOG\n")
        raise SystemExit(2)
    path = Path(sys.argv[1])
    if not may_be_ours(path):
        raise SystemExit(NOT_OURS)
    own_process.command_line()
    raise SystemExit(_imported(path, _option("--application-id"), _option("--recording-id")))


def _option(name: str) -> str | None:
    """Return the value of an option, written as ``--name VALUE`` or ``--name=VALUE``; None for an option that is not given."""
    words = [word for argument in sys.argv for word in argument.split("=", 1)]
    return dict(pairwise(words)).get(name)


def may_be_ours(path: Path) -> bool:
    """Return whether imuwb may read a file, judged by its first bytes and its name."""
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
    except OSError:
        return False
    if not head or head.startswith(_THEIRS):
        return False
    if head.startswith((*_MAGICS, *_TEXT)) or b"\xa3\x95\x80" in head or _is_telemetry(head):
        return True
    named = path.suffix.lower() in _SUFFIXES or path.name.lower().endswith(".csv.gz")
    return named and (head.startswith(b"\x1f\x8b") or b"\0" not in head)


def _is_telemetry(head: bytes) -> bool:
    """Return whether a file begins with a time of the years 2000 to 2100 (µs) and the mark of a MAVLink frame."""
    first = int.from_bytes(head[:8], "big")
    return len(head) > 8 and head[8] in (0xFD, 0xFE) and 946_684_800_000_000 < first < 4_102_444_800_000_000  # noqa: PLR2004


def _imported(path: Path, application: str | None, recording: str | None) -> int:
    """Write the recording of a log to stdout, and return the exit code."""
    from imuwb import readers  # noqa: PLC0415 - declining must not wait for numpy
    from imuwb.errors import ImuwbError  # noqa: PLC0415
    from imuwb.review.recording.overview import overview  # noqa: PLC0415
    from imuwb.review.recording.review import RecordingReview  # noqa: PLC0415
    from imuwb.review.scene.clock import Clock  # noqa: PLC0415

    try:
        log = readers.read(path)
    except ImuwbError as error:
        sys.stderr.write(f"rerun-importer-imuwb: {error}\n")
        return NOT_OURS
    if not (log.imus or log.gnss or log.references or log.speeds):
        return NOT_OURS
    with tempfile.TemporaryDirectory() as folder:
        review = RecordingReview(
            Path(folder) / "imported.rrd", clock=Clock.of([log]), application=application or "imuwb", recording=recording
        )  # fmt: skip
        overview([log], review)
        with review.close().open("rb") as file:
            shutil.copyfileobj(file, sys.stdout.buffer)
    return 0
