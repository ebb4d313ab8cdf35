"""Runs one analysis, from the paths of the logs to the recording."""

import os
import traceback
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import typer

from imuwb import __version__
from imuwb.analysis import Analysis, offers
from imuwb.cli.imus import compares, comparison, split, with_choice
from imuwb.cli.options import Request
from imuwb.cli.places import Places, check_places
from imuwb.cli.reading import read_log
from imuwb.cli.studies import cases, grid
from imuwb.cli.terminal import progress, shower
from imuwb.cli.through import Step, conditioned, step
from imuwb.errors import ImuwbError, MissingDataError, UsageError
from imuwb.log import Log
from imuwb.progress import watched
from imuwb.readers.bytes.address import Place, place_of
from imuwb.review.document import document
from imuwb.review.overview import overview
from imuwb.review.recording import RecordingReview
from imuwb.writers import write_text

VIEWER = "rerun+http://127.0.0.1:9876/proxy"


def perform(name: str, analysis: Analysis, paths: Sequence[Place], parameters: object, request: Request) -> None:
    """Read the logs, condition them, run the analysis, and write its results."""
    check_count(name, analysis, paths)
    compared = compares(analysis, request)
    analysis = comparison(name, analysis, paths, request) if compared else analysis
    plugin = cast("Any", analysis)
    for text in request.conditions.through:
        step(text)
    grid(request.conditions.study)
    places = Places.of(analysis, paths, request.outputs, parameters)
    gnss = [place_of(request.part.gnss)] if request.part.gnss is not None else []
    check_places(places.all(), [*paths, *gnss], force=request.outputs.force)

    whole = [
        with_choice(read_log(path, request.reading, request.part), analysis, parameters, request) for path in paths
    ]
    through = [conditioned(log, request.conditions.through) for log in split(whole, compared=compared)]
    logs = [log for log, _ in through]
    with errors_named(name, analysis), progress(f"{name}: computing") as report, watched(lambda part: report(part, 1)):
        # The study comes first, because it finds a setting that does not suit a log before the long work begins.
        study = plugin.study(cases(logs, request.conditions.study), parameters) if request.conditions.study else None
        result = plugin.run(logs, parameters)

    show = shower(data=not places.to_stdout)
    review = RecordingReview(places.recording, live=VIEWER if request.outputs.live else None, show=show)
    try:
        overview(whole if compared else logs, review)
        draw_conditioning(logs[0], through[0][1], review)
        review.tab(name.capitalize())
        with errors_named(name, analysis):
            plugin.draw(result, review)
            if study is not None:
                review.tab("Study")
                plugin.draw_study(study, review)
            model = plugin.error_model(result).to_toml() if places.model is not None else ""
            objections = _objections(analysis, result, places, request)
        text = document(name, __version__, parameters, result, whole if compared else logs, review.notes, study)
        review.close()
    except BaseException:
        review.discard()
        raise
    if places.to_stdout:
        typer.echo(text)
    if places.document is not None:
        write_text(places.document, text + "\n")
    written = replace(places, model=None) if objections else places
    if written.model is not None:
        write_text(written.model, model)
    if written.own:
        plugin.write_outputs(result, parameters)
    for file in written.all():
        typer.echo(f"wrote {file}", err=True)
    if objections and places.model is not None:
        state = "left as it was" if places.model.exists() else "not written"
        raise MissingDataError(
            f"{places.model} is {state}: {'; '.join(objections)}; to write the error model all the same, give --force-model"
        )


def _objections(analysis: Analysis, result: object, places: Places, request: Request) -> tuple[str, ...]:
    """Return why the error model is not written."""
    if places.model is None or request.outputs.force_model or not offers(analysis, "objections"):
        return ()
    return cast("Any", analysis).objections(result)


def check_count(name: str, analysis: Analysis, paths: Sequence[Place]) -> None:
    """Raise UsageError unless the analysis takes that many logs."""
    fewest, most = cast("tuple[int, int | None]", getattr(analysis, "LOGS", (1, 1)))
    if len(paths) < fewest or (most is not None and len(paths) > most):
        count = str(fewest) if fewest == most else f"{fewest} to {most}" if most else f"{fewest} or more"
        raise UsageError(f"{name} takes {count} log{'s' if count != '1' else ''}; {len(paths)} are given")


def draw_conditioning(log: Log, steps: list[tuple[Step, Any]], review: RecordingReview) -> None:
    """State what the conditioners did to the samples, and show it on a separate tab."""
    if not steps:
        return
    review.tab("Conditioning")
    stated = [
        f"{c.name} ({c.parameters}): {'causal' if c.causal else 'not causal: it uses later samples'}"
        f"{f', delay {c.delay:.4g} s' if c.delay else ''}{f'; {c.note}' if c.note else ''}"
        for c in log.conditioning
    ]
    review.note("the samples were conditioned: " + "; then ".join(stated))
    for conditioner, applied in steps:
        conditioner.draw(applied, review)


@contextmanager
def errors_named(name: str, analysis: Analysis) -> Generator[None]:
    """Raise ImuwbError with the plugin's name and its line in place of an error that imuwb did not raise on purpose."""
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
        raise ImuwbError(
            f"analysis {name} failed: {type(error).__name__}: {error} ({where}); "
            "set IMUWB_TRACEBACK=1 to see the whole traceback"
        ) from error
