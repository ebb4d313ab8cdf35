"""The files that show results without the viewer: a page, the page as PDF, and figures and tables for papers."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from imuwb.errors import ImuwbError, UsageError
from imuwb.writers import together, whole_file, write_text

if TYPE_CHECKING:
    from imuwb.review.page.report import Report


@dataclass(frozen=True, slots=True)
class PageFiles:
    """Where the files go that show results without the viewer."""

    html: Path | None = None
    pdf: Path | None = None
    figures: Path | None = None  #: a folder
    figure_format: str | None = None
    tables: Path | None = None  #: a folder
    table_format: str | None = None

    @property
    def files(self) -> tuple[Path, ...]:
        """Return the files that are no part of a folder."""
        return tuple(file for file in (self.html, self.pdf) if file is not None)

    @property
    def wanted(self) -> bool:
        """Return whether any file is wanted."""
        return bool(self.files or self.figures or self.tables)

    def check(self, *, force: bool) -> None:
        """Check before the work begins that the folders can be written to, and that PDF can be made.

        Raises:
            UsageError: a file has another suffix, a format has no folder, a folder has files and ``force`` is not set, or WeasyPrint is not installed.
            ImuwbError: a folder cannot be written to.
        """
        for file, suffix, what in ((self.html, ".html", "a page"), (self.pdf, ".pdf", "a PDF")):
            if file is not None and Path(file).suffix.lower() != suffix:
                raise UsageError(f"{file}: the name of {what} must end in {suffix}")
        for form, option in ((self.figure_format, "figure"), (self.table_format, "table")):
            if form is not None and (self.figures if option == "figure" else self.tables) is None:
                raise UsageError(f"--{option}-format {form} needs --{option}s FOLDER, where the {option}s go")
        for folder, option in ((self.figures, "--figures"), (self.tables, "--tables")):
            if folder is not None:
                _check_folder(folder, option, force=force)
        if self.pdf is not None:
            from imuwb.review.page.pdf import check_pdf  # noqa: PLC0415 - an extra

            check_pdf()

    def write(self, reports: Sequence[Report], title: str = "", remarks: Sequence[str] = ()) -> tuple[str, ...]:
        """Write all files, and return what was written, in words.

        Args:
            reports: what the files show.
            title: of the page; empty: that of the run.
            remarks: what a reader must know of several runs together.
        """
        from imuwb.review.page.report_files import figure_files, table_files  # noqa: PLC0415 - for these files alone

        wrote: list[str] = []
        if self.html is not None:
            from imuwb.review.page.html import page  # noqa: PLC0415 - matplotlib takes half a second

            write_text(self.html, page(reports, title, remarks))
            wrote.append(str(self.html))
        if self.pdf is not None:
            from imuwb.review.page.html import printed  # noqa: PLC0415
            from imuwb.review.page.pdf import pdf  # noqa: PLC0415

            _write({self.pdf: pdf(printed(reports, title, remarks))})
            wrote.append(str(self.pdf))
        kinds: tuple[tuple[Path | None, str, Callable[..., Mapping[str, bytes]]], ...] = (
            (self.figures, self.figure_format or "png", figure_files),
            (self.tables, self.table_format or "csv", table_files),
        )
        for folder, form, made in kinds:
            if folder is not None:
                files = made(reports, form)
                folder.mkdir(exist_ok=True)
                with together(folder / name for name in files):
                    _write({folder / name: content for name, content in files.items()})
                wrote.append(f"{folder}{os.sep} ({len(files)} {form})")
        return tuple(wrote)


def _write(files: Mapping[Path, bytes]) -> None:
    for path, content in files.items():
        with whole_file(path) as draft:
            draft.write_bytes(content)


def _check_folder(folder: Path, option: str, *, force: bool) -> None:
    """Check that files can be written to a folder, which may not exist yet."""
    if folder.is_dir():
        if any(folder.iterdir()) and not force:
            raise UsageError(
                f"{option} {folder}: the folder has files; overwrite them with --force, or choose another folder"
            )
        place = folder
    elif folder.exists():
        raise UsageError(f"{option} {folder}: this is a file; the option takes a folder")
    else:
        place = folder.parent
    if not place.is_dir() or not os.access(place, os.W_OK):
        raise ImuwbError(
            f"{option} {folder}: cannot be written: the folder {place} does not exist or cannot be written to"
        )
