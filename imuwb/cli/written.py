"""The panel of a command that writes logs: what was written, what is not in it, and what can be done with it."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from imuwb.analysis import Step
from imuwb.cli.next_steps import analysis_steps
from imuwb.cli.terminal import print_panel
from imuwb.log import Log
from imuwb.review.answers.log_answer import log_answer
from imuwb.review.answers.panel import Origin
from imuwb.summary import summarize
from imuwb.texts import counted

FILES = 6  #: that are named; of more files, only their folder
INFO = Step("imuwb info {log}", "what it contains")


def print_written(command: str, log: Log, files: Sequence[Path], sentences: Iterable[str], logs: int = 1) -> None:
    """Print what was written on stderr.

    Args:
        command: its name, the first word of the panel.
        log: that was written; of several logs, the first.
        files: that were written, in the order of their weight.
        sentences: what is not in the log, and what else a user must know.
        logs: how many logs were written.
    """
    summary = summarize(replace(log, notes=()))
    answer = log_answer(summary, log, (), ())
    begin = f"{logs} logs of " if logs > 1 else ""
    kinds = {stream.kind for stream in summary.streams}
    first = Step(f"imuwb info {files[0]}", INFO.why)
    steps = (INFO, *analysis_steps(kinds)) if logs == 1 else (first,)
    answer = replace(
        answer,
        about=begin + answer.about.removeprefix(f"{summary.format}, "),
        sentences=tuple(text if text.endswith(".") else f"{text}." for text in sentences),
        next=steps,
    )
    shown = files[0] if logs == 1 else files[0].parent
    print_panel(answer, Origin(command, (str(shown),), wrote=_named(files)), data=False)


def _named(files: Sequence[Path]) -> tuple[str, ...]:
    """Return the files that were written, in few words: a sidecar is beside its table, many files are in their folder."""
    described = {file for file in files if file.with_name(f"{file.name}.toml") in files}
    tables = [file for file in files if not (file.suffix == ".toml" and file.with_name(file.stem) in described)]
    if len(tables) > FILES:
        return (f"{files[0].parent} ({counted(len(files), 'file')})",)
    beside = "each with its .toml" if len(tables) > 1 else f"{tables[0].name}.toml beside it"
    return (*map(str, tables), *((beside,) if described else ()))
