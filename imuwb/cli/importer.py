"""``rerun FILE`` through imuwb: the viewer runs this for every file, and it says quickly which are not ours.

The viewer calls ``rerun-importer-imuwb FILE --application-id A --recording-id R`` and reads a recording from stdout; exit
code 66 says that somebody else should try.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

NOT_OURS = 66
HEAD = 4096
#: what our binary formats begin with; MCAP and .rrd the viewer reads itself
_MAGICS = (b"ULog\x01\x12\x35", b"#ROSBAG V2.0\n", b"SQLite format 3\0")
_THEIRS = (b"\x89MCAP0\r\n", b"RRF2", b"RRIO")
_TEXT = (b"% program", b"% (", b"%  GPST", b"FMT, 128")
_SUFFIXES = (".csv", ".pos", ".tlog", ".bin", ".log", ".ulg", ".bag", ".db3")


def main() -> None:
    """Import one file, or decline it."""
    paths = [argument for argument in sys.argv[1:] if not argument.startswith("-")]
    if len(sys.argv) < 2 or not paths:  # noqa: PLR2004 - the program and a file
        sys.stderr.write("rerun-importer-imuwb: the Rerun viewer runs this with a file; by hand: imuwb info FILE\n")
        raise SystemExit(2)
    path = Path(sys.argv[1])
    if not _may_be_ours(path):
        raise SystemExit(NOT_OURS)
    raise SystemExit(_imported(path, _option("--application-id"), _option("--recording-id")))


def _option(name: str) -> str | None:
    """Return the value of an option, ``--name VALUE`` or ``--name=VALUE``; others are of no interest."""
    for i, argument in enumerate(sys.argv):
        if argument == name and i + 1 < len(sys.argv):
            return sys.argv[i + 1]
        if argument.startswith(f"{name}="):
            return argument.partition("=")[2]
    return None


def _may_be_ours(path: Path) -> bool:
    """Decide from the first bytes, before anything heavy is imported."""
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
    """Return whether a recorder's time, of the years 2000 to 2100 in µs, stands before a frame's mark."""
    first = int.from_bytes(head[:8], "big")
    return len(head) > 8 and head[8] in (0xFD, 0xFE) and 946_684_800_000_000 < first < 4_102_444_800_000_000  # noqa: PLR2004


def _imported(path: Path, application: str | None, recording: str | None) -> int:
    from imuwb import readers  # noqa: PLC0415 - a declined file must not wait for numpy
    from imuwb.errors import ImuwbError  # noqa: PLC0415
    from imuwb.review.overview import overview  # noqa: PLC0415
    from imuwb.review.recording import RecordingReview  # noqa: PLC0415

    try:
        log = readers.read(path)
    except ImuwbError as error:
        sys.stderr.write(f"rerun-importer-imuwb: {error}\n")
        return NOT_OURS
    if not (log.imus or log.gnss or log.references or log.speeds):
        return NOT_OURS
    with tempfile.TemporaryDirectory() as folder:
        review = RecordingReview(Path(folder) / "imported.rrd", application=application or "imuwb", recording=recording)
        overview([log], review)
        with review.close().open("rb") as file:
            shutil.copyfileobj(file, sys.stdout.buffer)
    return 0
