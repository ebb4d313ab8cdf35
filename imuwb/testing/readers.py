"""The rules of a reader."""

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, cast

import numpy as np

from imuwb.errors import ImuwbError
from imuwb.log import Log, Provenance
from imuwb.readers.assembly.assemble import assemble
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.reading import ORDER, TEXT
from imuwb.readers.unread import unread_text
from imuwb.testing.heads import heads, texts
from imuwb.testing.options_rules import help_outcome
from imuwb.testing.outcomes import Attempt, Outcome, attempt, error_text, outcome, skipped
from imuwb.testing.parts import parts_outcome

PARTS = ("format", "probe", "stream")
#: kind of a stream -> columns of three, of four, and of one
COLUMNS: dict[str, tuple[set[str], set[str], set[str]]] = {
    "imu": ({"angular_rate", "specific_force"}, set(), {"temperature"}),
    "gnss": ({"position", "velocity", "position_sigma", "velocity_sigma"}, set(), {"fix_type"}),
    "reference": (
        {"position", "velocity", "attitude", "position_sigma", "velocity_sigma", "attitude_sigma"},
        set(),
        set(),
    ),
    "pose": ({"position", "position_sigma"}, {"quaternion"}, set()),
    "orientation": ({"sigma"}, {"quaternion"}, set()),
    "speed": (set(), set(), {"speed"}),
    "temperature": (set(), set(), {"temperature"}),
    "velocity": ({"velocity", "velocity_sigma"}, set(), set()),
    "fix": (set(), set(), {"fix_type"}),
}
HEAD = 65536  #: bytes that ``probe`` gets
CUTS, FLIPS = 12, 24  #: damaged files of each kind
LARGEST = 1 << 20  #: bytes; a larger file is damaged in its first part only


def reader_outcomes(plugin: object, name: str, files: Sequence[Path]) -> Iterator[Outcome]:
    """Yield the outcome of each rule.

    Args:
        plugin: the reader.
        name: its name.
        files: logs of its format; empty: only what needs no log is tested.
    """
    parts = parts_outcome(plugin, "reader", PARTS, "imuwb.readers.batch")
    yield parts
    if parts.state == "failed":
        return
    yield help_outcome(plugin)
    yield outcome("probe of other formats", _claims(plugin, name), "it claims no file of another format")
    if not files:
        yield skipped("reads", "no log of its format is given; write one after the name of the reader")
        return
    for rule, faults, passed in (
        ("reads", _reads, "its log is claimed and read; columns, shapes and times are right"),
        ("pure", _impure, "the same file gives the same rows"),
        ("becomes a log", _assembles, "its rows become a log"),
        ("damaged files", _damaged, "a cut or changed file is read in part or refused with a reason"),
    ):
        yield outcome(rule, [fault for file in files for fault in faults(plugin, file)], passed)


def _claims(plugin: object, name: str) -> Iterator[str]:
    """Yield the files of other formats that a reader claims. A reader that is asked later may: the format's own reader was asked before."""
    own, place = str(cast("Any", plugin).format), ORDER.get(name, 0)
    others = [(what, reader, head) for what, (reader, head) in heads().items()]
    others += [(what, "csv", head) for what, head in texts().items()]
    for what, reader, head in others:
        if reader in (own, name):
            continue
        claim = attempt(lambda head=head: cast("Any", plugin).probe(head))
        if claim.fault:
            yield f"probe raises {claim.fault} for {what}; return False"
        elif not isinstance(claim.value, bool | np.bool_):
            yield f"probe returns {claim.value!r} for {what}; return True or False"
        elif claim.value and (not reader or place <= ORDER.get(reader, 0)) and not (own == TEXT and unread_text(head)):
            yield f"probe claims {what}; look for what only a {own} file has, such as its first bytes or a checksum"
        for end in (1, 3, 7, 20):
            cut = attempt(lambda head=head, end=end: cast("Any", plugin).probe(head[:end]))
            if cut.fault:
                yield f"probe raises {cut.fault} for a file of {end} bytes; return False"


def _rows(plugin: object, file: Path) -> Attempt[tuple[Batch | Remark, ...]]:
    return attempt(lambda: tuple(cast("Any", plugin).stream(file, ReadOptions())))


def _reads(plugin: object, file: Path) -> Iterator[str]:
    with file.open("rb") as opened:
        head = opened.read(HEAD)
    claim = attempt(lambda: cast("Any", plugin).probe(head))
    if claim.fault:
        yield f"probe raises {claim.fault} for {file.name}; return True or False"
    elif not claim.value:
        yield f"probe does not claim {file.name}"
    parts = _rows(plugin, file)
    if parts.value is None:
        yield f"stream raises {parts.fault} for {file.name}"
        return
    yielded = cast("tuple[object, ...]", parts.value)
    odd = next((part for part in yielded if not isinstance(part, Batch | Remark)), None)
    if odd is not None:
        yield f"stream yields a {type(odd).__name__}; yield Batch and Remark of imuwb.readers.batch"
        return
    batches = [part for part in parts.value if isinstance(part, Batch)]
    if not batches:
        yield f"stream yields no row of {file.name}; raise UnreadableLogError with the reason"
    for batch in batches:
        yield from _batch_faults(batch)
    at = [batch.bytes_read for batch in batches]
    if any(b < a for a, b in itertools.pairwise(at)):
        yield "bytes_read goes back; give the position in the file after each piece"


def _batch_faults(batch: Batch) -> Iterator[str]:
    if batch.kind not in COLUMNS:
        yield f"{batch.stream} has the kind {batch.kind!r}; it must be one of {', '.join(COLUMNS)}"
        return
    time = np.asarray(batch.time)
    if time.dtype != np.int64 or time.ndim != 1:
        yield f"the time of {batch.stream} is {time.dtype} with the shape {time.shape}; give int64 nanoseconds, (n,)"
    three, four, one = COLUMNS[batch.kind]
    for name, values in batch.columns.items():
        shape = (time.size, 3) if name in three else (time.size, 4) if name in four else (time.size,)
        if name not in three | four | one:
            yield f"{batch.stream} has the column {name!r}; a stream of the kind {batch.kind} may have {', '.join(sorted(three | four | one))}"
        elif np.shape(values) != shape:
            yield f"{name} of {batch.stream} has the shape {np.shape(values)}; give {shape}"


def _key(parts: Sequence[Batch | Remark]) -> list[object]:
    return [
        (p.stream, p.kind, np.asarray(p.time).tobytes(), *((n, np.asarray(v).tobytes()) for n, v in p.columns.items()))
        if isinstance(p, Batch) else repr(p)
        for p in parts
    ]  # fmt: skip


def _impure(plugin: object, file: Path) -> Iterator[str]:
    one, two = _rows(plugin, file), _rows(plugin, file)
    if one.value is not None and two.value is not None and _key(one.value) != _key(two.value):
        yield f"{file.name} read twice gives different rows; keep no state between two files"


def _assembles(plugin: object, file: Path) -> Iterator[str]:
    parts = _rows(plugin, file)
    if parts.value is None:
        return  # another rule says so
    made = attempt(
        lambda: assemble(iter(parts.value or ()), provenance=Provenance(str(file), cast("Any", plugin).format, "", 0))
    )
    if made.fault:
        yield f"the rows of {file.name} do not become a log: {made.fault}"
    elif isinstance(made.value, Log) and not (
        made.value.imus or made.value.gnss or made.value.references or made.value.poses or made.value.speeds
    ):
        yield f"{file.name} becomes a log without streams"


def _damaged(plugin: object, file: Path) -> Iterator[str]:
    with file.open("rb") as opened:
        content = opened.read(LARGEST)
    rng = np.random.default_rng(3)
    with TemporaryDirectory() as folder:
        place = Path(folder) / file.name
        for what, damaged in _damages(content, rng):
            if not attempt(lambda damaged=damaged: cast("Any", plugin).probe(damaged[:HEAD])).value:
                continue  # imuwb does not give it such a file
            place.write_bytes(damaged)
            error = _rows(plugin, place).error
            if error is not None and not isinstance(error, ImuwbError):
                yield f"for {file.name} {what}, stream raises {error_text(error)}; raise UnreadableLogError, or yield a Remark and go on"


def _damages(content: bytes, rng: np.random.Generator) -> Iterator[tuple[str, bytes]]:
    for end in sorted(rng.integers(1, max(len(content), 2), CUTS).tolist()):
        yield f"cut after {end} bytes", content[:end]
    for at in sorted(rng.integers(0, max(len(content), 1), FLIPS).tolist()):
        value = int(rng.integers(0, 256))
        yield f"with byte {at} changed to {value}", content[:at] + bytes((value,)) + content[at + 1 :]
