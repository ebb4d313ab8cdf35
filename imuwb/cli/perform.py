"""One analysis from the log's path to the recording."""

from __future__ import annotations

import os
import traceback
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import typer

from imuwb import __version__, readers
from imuwb.analysis import offers
from imuwb.cli.terminal import progress, shower
from imuwb.cli.through import Step, cases, conditioned, grid, step
from imuwb.errors import ImuwbError, UnreadableLogError, UsageError
from imuwb.progress import watched
from imuwb.readers.batch import ReadOptions
from imuwb.readers.bytes import source
from imuwb.review.document import document
from imuwb.review.overview import overview
from imuwb.review.recording import RecordingReview
from imuwb.review.rrd import MAGIC, is_whole
from imuwb.writers import write_text

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence

    from imuwb.analysis import Analysis
    from imuwb.cli.common import Common
    from imuwb.log import Log

VIEWER = "rerun+http://127.0.0.1:9876/proxy"


def perform(name: str, analysis: Analysis, paths: Sequence[Path], parameters: object, common: Common) -> None:
    """Read the logs, condition them, run the analysis, and write what it draws."""
    check_count(name, analysis, paths)
    for text in common.through:
        step(text)
    grid(common.study)
    places = Places.of(analysis, paths, common)
    plugin = cast("Any", analysis)
    others: tuple[Path, ...] = plugin.outputs(parameters) if offers(analysis, "outputs") else ()
    check_places(
        [*places.all(), *others], [*paths, *([common.gnss] if common.gnss is not None else [])], force=common.force
    )
    read = [conditioned(read_log(path, common), common.through) for path in paths]
    logs = [log for log, _ in read]
    with blaming(name, analysis), progress(f"{name}: computing") as report, watched(lambda part: report(part, 1.0)):
        # The study first: a setting that a log cannot have is found before the long work, not behind it.
        studied = plugin.study(cases(logs, common.study), parameters) if common.study else None
        result = plugin.run(logs, parameters)
    review = RecordingReview(
        places.recording, live=VIEWER if common.live else None, show=shower(data=not places.to_stdout)
    )
    try:
        overview(logs, review)
        draw_conditioning(logs[0], read[0][1], review)
        review.tab(name.capitalize())
        with blaming(name, analysis):
            plugin.draw(result, review)
            if common.study:
                review.tab("Study")
                plugin.draw_study(studied, review)
            model = plugin.error_model(result).to_toml() if places.model is not None else ""
        text = document(name, __version__, parameters, result, logs, review.notes, studied)
        review.close()
    except BaseException:
        review.discard()
        raise
    if places.to_stdout:
        typer.echo(text)
    if places.document is not None:
        write_text(places.document, text + "\n")
    if places.model is not None:
        write_text(places.model, model)
    if others:
        plugin.write_outputs(result, parameters)
    for file in (*places.all(), *others):
        typer.echo(f"wrote {file}", err=True)


def check_count(name: str, analysis: Analysis, paths: Sequence[Path]) -> None:
    """Raise UsageError unless the analysis takes so many logs."""
    fewest, most = cast("tuple[int, int | None]", getattr(analysis, "LOGS", (1, 1)))
    if len(paths) < fewest or (most is not None and len(paths) > most):
        wanted = str(fewest) if fewest == most else f"{fewest} to {most or 'any number'}"
        message = f"{name} takes {wanted} log{'s' if wanted != '1' else ''}; {len(paths)} are given"
        raise UsageError(message)


@dataclass(frozen=True, slots=True)
class Places:
    """Where the outputs go."""

    recording: Path
    document: Path | None
    model: Path | None
    to_stdout: bool  #: the document

    @staticmethod
    def of(analysis: Analysis, paths: Sequence[Path], common: Common) -> Places:
        """Return where they were asked for, or their places beside the (first) log.

        Raises:
            UsageError: a recording that does not end in .rrd.
        """
        output = common.output or paths[0].with_name(f"{stem(paths[0])}.rrd")
        if output.suffix != ".rrd":
            message = f"--output {output}: a recording ends in .rrd"
            raise UsageError(message)
        model = common.save_model
        if model is None and (kind := getattr(analysis, "LEAVES_MODEL", False)):
            model = output.with_name(f"{stem(output)}.{kind if isinstance(kind, str) else 'error-model'}.toml")
        to_stdout = common.json == "-"
        return Places(output, Path(common.json) if common.json and not to_stdout else None, model, to_stdout)

    def all(self) -> list[Path]:
        """Return all files that will be written."""
        return [file for file in (self.recording, self.document, self.model) if file is not None]


def draw_conditioning(log: Log, steps: list[tuple[Step, Any]], review: RecordingReview) -> None:
    """Say and show, on a tab of its own, what was done to the samples."""
    if not steps:
        return
    review.tab("Conditioning")
    said = [
        f"{c.name} ({c.parameters}): {'causal' if c.causal else 'not causal, it knows what comes'}"
        f"{f', {c.delay:.4g} s late' if c.delay else ''}{f'; {c.note}' if c.note else ''}"
        for c in log.conditioning
    ]
    review.note("the samples went through " + "; then ".join(said))
    for one, found in steps:
        one.draw(found, review)


def read_log(path: Path, common: Common) -> Log:
    """Read a log and cut it to what was asked for."""
    options = ReadOptions(
        time_source=common.time_source,
        rate=common.rate,
        columns=tuple(part.strip() for part in common.columns.split(",")) if common.columns else (),
        units=units(common.units),
        frame=common.frame,
    )
    with progress(f"reading {path.name}") as report:
        log = readers.read(path, options, report)
    if common.gnss is not None:
        with progress(f"reading {common.gnss.name}") as report:
            log = readers.joined(log, readers.read(common.gnss, ReadOptions(), report))
    return readers.select(log, common.imu, common.start, common.end)


def units(text: str | None) -> dict[str, str]:
    """Return {"gyro": "deg/s"} of ``gyro=deg/s,...``."""
    pairs = [part.partition("=") for part in text.split(",")] if text else []
    for quantity, mark, unit in pairs:
        if not mark or not unit:
            message = f"--units: {quantity!r} names no unit; write gyro=deg/s,accel=g,time=ms"
            raise UsageError(message)
    return {quantity.strip(): unit.strip() for quantity, _, unit in pairs}


def stem(path: Path) -> str:
    """Return a log's name without its suffixes: static for static.csv.gz."""
    name = path.name
    for suffix in (".rrd", ".gz", ".csv", ".txt", ".mcap", ".pos", ".bin", ".tlog", ".ulg", ".log"):
        name = name.removesuffix(suffix)
    return name or path.name


@contextmanager
def blaming(name: str, analysis: Analysis) -> Generator[None]:
    """Name the plugin, and the line in it, when something goes wrong that is no error of ours or of the log's."""
    try:
        yield
    except ImuwbError:
        raise
    except Exception as error:
        if os.environ.get("IMUWB_TRACEBACK"):
            raise
        home = str(Path(getattr(analysis, "__file__", "") or "").parent)
        inside = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.startswith(home)]
        where = f"{inside[-1].filename}, line {inside[-1].lineno}" if inside and home else "outside its own code"
        message = f"analysis {name} failed: {type(error).__name__}: {error} ({where}; IMUWB_TRACEBACK=1 shows more)"
        raise ImuwbError(message) from error


def check_places(files: Sequence[Path], logs: Sequence[Path], *, force: bool) -> None:
    """Check all outputs: none twice, none a log that is read."""
    taken = {log.resolve() for log in logs}
    for file in files:
        if file.resolve() in taken:
            message = f"{file} would be written over a log or another output; give each output a name of its own"
            raise UsageError(message)
        taken.add(file.resolve())
        check_place(file, force=force)


def check_place(file: Path, *, force: bool) -> None:
    """Say at once, before the work, when a file could not be written behind it."""
    if file.exists() and not force:
        message = f"{file} exists; --force writes over it, or choose another with --output"
        raise UsageError(message)
    parent = file.parent
    if file.exists() and not file.is_file() and not file.is_dir():
        message = f"{file}: neither a file nor a place for one; it is left alone"
        raise ImuwbError(message)
    if file.is_dir() or not parent.is_dir() or not os.access(parent, os.W_OK):
        why = "it is a directory" if file.is_dir() else f"{parent} is no folder that can be written to"
        message = f"{file}: cannot be written: {why}"
        raise ImuwbError(message)


def check_recording(path: Path) -> None:
    """Raise UnreadableLogError unless ``path`` is a Rerun recording, and whole."""
    source.check(path)
    with path.open("rb") as file:
        magic = file.read(len(MAGIC))
    if magic != MAGIC:
        message = f"{path}: no Rerun recording (it begins with {magic!r}); imuwb writes them with --output FILE.rrd"
        raise UnreadableLogError(message)
    if not is_whole(path):
        message = f"{path}: a recording that was cut or damaged: its end mark is missing; make it again"
        raise UnreadableLogError(message)
