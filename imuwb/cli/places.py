"""The paths of the outputs. They are checked before the work begins."""

from __future__ import annotations

import os
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

from imuwb.analysis import Analysis, offers
from imuwb.cli.options import Outputs
from imuwb.cli.page_files import PageFiles
from imuwb.errors import ImuwbError, UsageError
from imuwb.fleet.own_files import results_of
from imuwb.readers.bytes.address import Place
from imuwb.readers.text.sidecar import sidecar_of
from imuwb.writers import together

SUFFIXES = (".rrd", ".gz", ".csv", ".txt", ".mcap", ".pos", ".bin", ".tlog", ".ulg", ".log")

KINDS = {".rrd", ".html", ".pdf", ".json", ".toml"}  #: suffixes that programs open as what they name


@dataclass(frozen=True, slots=True)
class Places:
    """Where the outputs of an analysis go."""

    recording: Path
    document: Path | None  #: the JSON
    model: Path | None  #: the error model
    to_stdout: bool  #: whether the JSON goes to stdout
    own: tuple[Path, ...] = ()  #: files that the analysis itself writes
    pages: PageFiles = field(default_factory=PageFiles)  #: page, PDF, figures and tables

    @staticmethod
    def of(name: str, analysis: Analysis, logs: Sequence[Place], outputs: Outputs, parameters: object) -> Places:
        """Return the places that the user gives, or the default places beside the first log.

        The default places of a remote log, or of an analysis that makes its own logs, are in the working folder.

        Raises:
            UsageError: the name of a file has the suffix of another output, or an option of the page's files is wrong.
        """
        recording = outputs.output or (_beside(logs[0]) if logs else Path(f"{name.rsplit(maxsplit=1)[-1]}.rrd"))
        if recording.suffix != ".rrd":
            raise UsageError(f"--output {recording}: the name of a recording must end in .rrd")
        model = outputs.save_model
        if model is None and (kind := getattr(analysis, "LEAVES_MODEL", False)):
            model = recording.with_name(f"{stem(recording)}.{kind if isinstance(kind, str) else 'error-model'}.toml")
        to_stdout = outputs.json == "-"
        document = Path(outputs.json) if outputs.json and not to_stdout else None
        for file, suffix, option in ((document, ".json", "json"), (model, ".toml", "save-model")):
            if file is not None and file.suffix in KINDS - {suffix}:
                raise UsageError(f"--{option} {file}: {file.suffix} is the suffix of another output; write {suffix}")
        own = cast("Any", analysis).outputs(parameters) if offers(analysis, "outputs") else ()
        pages = PageFiles(
            outputs.html, outputs.pdf, outputs.figures, outputs.figure_format, outputs.tables, outputs.table_format
        )
        pages.check(force=outputs.force)
        return Places(recording, document, model, to_stdout, own, pages)

    def all(self) -> list[Path]:
        """Return all files that are written."""
        files = (self.recording, *self.pages.files, self.document, self.model, *self.own)
        return [file for file in files if file is not None]


def stem(place: Place) -> str:
    """Return a log's name without its suffixes: static for static.csv.gz."""
    whole = name = place.name if isinstance(place, Path) else place.file_name
    for suffix in SUFFIXES:
        name = name.removesuffix(suffix)
    return name or whole


def _beside(log: Place) -> Path:
    """Return the default recording of a log: beside it, or in the working folder if the log is remote."""
    if not isinstance(log, Path):
        return Path(f"{stem(log)}.rrd")
    named = log if log.name.strip(".") else log.resolve()  # "." and ".." are folders of another name
    return named.with_name(f"{stem(named)}.rrd")


@contextmanager
def reserved(files: Sequence[Path], logs: Sequence[Place], *, force: bool) -> Generator[None]:
    """Check the places of all outputs, keep other processes from them, and give the files their names together after the block.

    Raises:
        UsageError, ImuwbError: as in ``check_places``; another process writes one of the files.
    """
    check_places(files, logs, force=force)
    with together(files):
        check_places(files, logs, force=force)  # before, another process may have been at its end
        yield


def check_places(files: Sequence[Path], logs: Sequence[Place], *, force: bool) -> None:
    """Check that all outputs can be written, that no two outputs have the same path, and that no output is a log that is read.

    Raises:
        UsageError: two outputs have the same name, or a file exists and ``force`` is not set.
        ImuwbError: a file cannot be written.
    """
    local = [log for log in logs if isinstance(log, Path)]
    taken = {log.resolve() for log in local}
    sidecars = {sidecar.resolve(): log for log in local if (sidecar := sidecar_of(log)) is not None}
    for file in files:
        if (log := sidecars.get(file.resolve())) is not None:
            raise UsageError(
                f"{file} is the sidecar of {log}, which states how the log is read; give the output another name"
            )
        if file.resolve() in taken:
            raise UsageError(f"{file} is a file that is read, or another output; give each output a different name")
        taken.add(file.resolve())
        check_place(file, force=force)


def check_place(file: Path, *, force: bool) -> None:
    """Check that a file can be written; errors as in ``check_places``."""
    if (results := results_of(file)) is not None:
        raise UsageError(
            f"{file} is a file of the results of imuwb fleet in {results}, which no output replaces; give the output another name"
        )
    if file.exists() and not force:
        raise UsageError(f"{file} exists; overwrite it with --force, or choose another name")
    parent = file.parent
    if file.exists() and not file.is_file() and not file.is_dir():
        raise ImuwbError(f"{file}: cannot be written: it is a device or a pipe, not a file")
    if file.is_dir() or not parent.is_dir() or not os.access(parent, os.W_OK):
        why = "it is a folder" if file.is_dir() else f"the folder {parent} does not exist or cannot be written to"
        raise ImuwbError(f"{file}: cannot be written: {why}")
