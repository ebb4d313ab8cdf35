"""The result of an analysis in a notebook or a program."""

import html
import json
import shutil
import weakref
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from imuwb.analysis import Analysis, Answer, Table, offers
from imuwb.cli.page_files import PageFiles
from imuwb.cli.perform import Done, Drawn
from imuwb.cli.places import reserved
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Log
from imuwb.notebook.shown import Picture, TableFrame
from imuwb.review.answers.panel import panel
from imuwb.review.page.pictures import drawings, title_of
from imuwb.stochastic import ImuErrorModel
from imuwb.writers import whole_file, write_text

OF_LOGS = ("Overview", "Streams", "Logs")  #: begin of the names of the tabs that show the logs
RECORDING = "run.rrd"  #: name in the folder of a result


class Outcome:
    """The result of an analysis, with all that its recording and its page show."""

    def __init__(self, analysis: Analysis, done: Done, drawn: Drawn, folder: Path) -> None:
        """Take what was computed, and the folder of its recording, which is removed with this object."""
        self._analysis, self._done, self._drawn, self._folder = analysis, done, drawn, folder
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)

    @property
    def result(self) -> Any:  # noqa: ANN401 - each analysis has its own
        """What the analysis has computed, in SI units."""
        return self._done.result

    @property
    def study(self) -> Any:  # noqa: ANN401 - each analysis has its own
        """The result of the study; None without one."""
        return self._done.study

    @property
    def answer(self) -> Answer:
        """What the terminal shows."""
        return self._drawn.answer

    @property
    def logs(self) -> tuple[Log, ...]:
        """The logs that were analysed, after the conditioners."""
        return tuple(self._done.logs)

    @property
    def figures(self) -> tuple[Picture, ...]:
        """All figures, series and tracks, those of the log first."""
        return tuple(Picture(tab, drawing) for tab, drawing in drawings(self._drawn.drawn))

    @property
    def tables(self) -> tuple[TableFrame, ...]:
        """All tables with rows."""
        items = (one.item for one in self._drawn.drawn)
        return tuple(TableFrame(item) for item in items if isinstance(item, Table) and item.rows)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the result must know."""
        return tuple(dict.fromkeys(str(one.item) for one in self._drawn.drawn if isinstance(one.item, str)))

    @property
    def document(self) -> dict[str, Any]:
        """The result as the JSON has it."""
        return json.loads(self._drawn.document)

    @property
    def error_model(self) -> ImuErrorModel:
        """The error model that the analysis has identified.

        Raises:
            UsageError: the analysis identifies none, or not from these logs.
        """
        if not offers(self._analysis, "error_model"):
            raise UsageError(f"{self._drawn.origin.analysis} identifies no error model; imuwb.run('noise', ...) does")
        return cast("Any", self._analysis).error_model(self.result)

    def save(self, path: str | Path, *, force: bool = False, force_model: bool = False) -> Path:
        """Write the result, and return the path.

        Args:
            path: its suffix decides what is written: the recording (.rrd), a page (.html, .pdf), the result (.json), or the error
                model (.toml).
            force: overwrite a file that exists.
            force_model: write the error model of a record that does not suit it too; the model states the doubts.

        Raises:
            UsageError: another suffix; the file exists; the analysis identifies no error model.
            MissingDataError: the record does not suit an error model.
            ImuwbError: the file cannot be written.
        """
        path = Path(path)
        kinds: dict[str, Callable[[Path], None]] = {
            ".rrd": self._save_recording, ".html": self._save_page, ".pdf": self._save_page, ".json": self._save_document,
        }  # fmt: skip
        if path.suffix not in (*kinds, ".toml"):
            raise UsageError(f"save {path}: the suffix must be one of {', '.join((*kinds, '.toml'))}")
        if path.exists() and not force:
            raise UsageError(f"{path} exists; overwrite it with force=True, or choose another name")
        text = self._model_text(force=force_model) if path.suffix == ".toml" else ""
        with reserved([path], [], force=force):
            if text:
                write_text(path, text)
            else:
                kinds[path.suffix](path)
        return path

    def _save_recording(self, path: Path) -> None:
        with whole_file(path) as draft:
            shutil.copyfile(self._folder / RECORDING, draft)

    def _save_page(self, path: Path) -> None:
        (PageFiles(pdf=path) if path.suffix == ".pdf" else PageFiles(html=path)).write([self._drawn.report])

    def _save_document(self, path: Path) -> None:
        write_text(path, self._drawn.document + "\n")

    def _model_text(self, *, force: bool) -> str:
        model = self.error_model
        objections = cast("Any", self._analysis).objections(self.result) if offers(self._analysis, "objections") else ()
        if objections and not force:
            raise MissingDataError(
                f"no error model: {'; '.join(objections)}; to write it all the same, give force_model=True"
            )
        return replace(model, provenance={**model.provenance, "run": self._drawn.report.run}).to_toml()

    def __repr__(self) -> str:
        """Return the panel of the terminal."""
        return "\n".join(panel(self.answer, self._drawn.origin))

    def _repr_html_(self) -> str:
        from imuwb.review.page.html import fragment, svg_of  # noqa: PLC0415 - matplotlib takes half a second

        report = self._drawn.report
        more = [(tab, drawing) for tab, drawing in drawings(report.drawn) if drawing is not report.figure]
        shown = "".join(
            f"<details><summary>{html.escape(title_of(drawing))}</summary>{svg_of(drawing, f'm{id(self):x}-{i}-')}</details>"
            for i, (tab, drawing) in enumerate(more)
            if not tab.startswith(OF_LOGS)
        )
        return f"{fragment(report)}{shown}"
