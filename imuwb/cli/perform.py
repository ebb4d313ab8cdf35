"""Runs one analysis, from the paths of the logs to the recording."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import typer

from imuwb import __version__
from imuwb.analysis import Analysis, Answer, Figure, Table, offers
from imuwb.axes import check_scaled
from imuwb.cli.analyses import errors_named
from imuwb.cli.explain import where_explained
from imuwb.cli.imus import compares, comparison, split, with_choice
from imuwb.cli.options import Request
from imuwb.cli.page_files import PageFiles
from imuwb.cli.places import Places, reserved
from imuwb.cli.reading import read_log
from imuwb.cli.studies import cases, grid
from imuwb.cli.terminal import print_panel, progress, shower
from imuwb.cli.through import Step, conditioned, step
from imuwb.cli.typed import options_given, typed_again
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Log
from imuwb.progress import watched
from imuwb.readers.bytes.address import Place, place_of
from imuwb.review.answers.default_answer import ALL, default_answer
from imuwb.review.answers.document import answer_document, document
from imuwb.review.answers.log_state import log_state
from imuwb.review.answers.panel import WHOLE_HEIGHT, Origin, panel
from imuwb.review.drawn.calls import Drawn as Shown
from imuwb.review.page.report import Report, report_of
from imuwb.review.page.report_document import KEPT, report_from, text_of
from imuwb.review.recording.overview import overview
from imuwb.review.recording.properties import properties, recording_name
from imuwb.review.scene.clock import Clock
from imuwb.stochastic import ImuErrorModel
from imuwb.writers import write_text

if TYPE_CHECKING:
    from imuwb.review.recording.review import RecordingReview

VIEWER = "rerun+http://127.0.0.1:9876/proxy"


def perform(name: str, analysis: Analysis, paths: Sequence[Place], parameters: object, request: Request) -> None:
    """Read the logs, condition them, run the analysis, and write its results."""
    paths = with_folders(analysis, paths)
    check_count(name, analysis, paths)
    compared = compares(analysis, request)
    analysis = comparison(name, analysis, paths, request) if compared else analysis
    plugin = cast("Any", analysis)
    for text in request.conditions.through:
        step(text)
    grid(request.conditions.study)
    places = Places.of(name, analysis, paths, request.outputs, parameters)
    gnss = [place_of(request.part.gnss)] if request.part.gnss is not None else []
    with reserved(places.all(), [*paths, *gnss], force=request.outputs.force):
        done, drawn = analysed(name, analysis, paths, parameters, request, places, compared=compared)
        pages = _write(drawn, places, plugin, done.result, parameters)
    # All files are written before the first line is printed: the program that reads the output may end at any time.
    _print(drawn, places, pages, full=request.outputs.full)
    if drawn.objections and places.model is not None:
        state = "left as it was" if places.model.exists() else "not written"
        raise MissingDataError(
            f"{places.model} is {state}: {'; '.join(drawn.objections)}; to write the error model all the same, give --force-model"
        )


def _computed(
    name: str, analysis: Analysis, logs: Sequence[Log], parameters: object, request: Request
) -> tuple[object, object]:
    """Return the result of the study, None if none is wanted, and that of the analysis."""
    plugin = cast("Any", analysis)
    with errors_named(name, analysis), progress(f"{name}: computing") as report, watched(lambda part: report(part, 1)):
        # The study comes first, because it finds a setting that does not suit a log before the long work begins.
        for log in () if getattr(plugin, "TAKES_COUNTS", False) else logs:
            for imu in log.imus:
                check_scaled(log.provenance.path, imu, name)
        study = plugin.study(cases(logs, request.conditions.study), parameters) if request.conditions.study else None
        return study, plugin.run(logs, parameters)


@dataclass(frozen=True, slots=True)
class Done:
    """An analysis that was run."""

    logs: list[Log]  #: after the conditioners; whole ones, where the IMUs of a log are compared
    parameters: object
    result: object
    study: object  #: None: no study was run
    conditioned: (
        tuple[Log, list[tuple[Step, Any]]] | None
    )  #: the first log after the conditioners, and what each did to it


@dataclass(frozen=True, slots=True)
class Drawn:
    """What is written and printed of an analysis, besides the recording."""

    answer: Answer
    origin: Origin
    shown: tuple[Table | str, ...]  #: all tables and notes
    document: str  #: JSON
    report: Report  #: what a page shows
    model: str  #: TOML; empty: none is saved
    objections: tuple[str, ...]  #: why the error model is not written
    drawn: tuple[Shown, ...]  #: all that was drawn, with all its points


def analysed(
    name: str, analysis: Analysis, paths: Sequence[Place], parameters: object, request: Request, places: Places, *,
    compared: bool,
) -> tuple[Done, Drawn]:  # fmt: skip
    """Read the logs, condition them, run the analysis, and write the recording; return all else that can be shown.

    Args:
        name: of the analysis.
        analysis: its module; of a comparison of IMUs, what ``comparison`` returns.
        paths: the logs.
        parameters: of the analysis.
        request: the options that all analyses share.
        places: of the outputs.
        compared: whether the IMUs of one log are compared.
    """
    whole = [
        with_choice(read_log(path, request.reading, request.part), analysis, parameters, request) for path in paths
    ]
    through = [conditioned(log, request.conditions.through) for log in split(whole, compared=compared)]
    logs = [log for log, _ in through]
    study, result = _computed(name, analysis, logs, parameters, request)
    done = Done(whole if compared else logs, parameters, result, study, through[0] if through else None)
    return done, _drawn(name, analysis, done, places, request, paths)


def _drawn(
    name: str, analysis: Analysis, done: Done, places: Places, request: Request, paths: Sequence[Place]
) -> Drawn:
    """Write the recording, and return what else there is to write and to print."""
    from imuwb.review.recording.review import RecordingReview  # noqa: PLC0415 - rerun takes a quarter of a second to import

    plugin, shown, logs = cast("Any", analysis), list[Table | str](), done.logs
    live = VIEWER if request.outputs.live else None
    review = RecordingReview(places.recording, live=live, show=shown.append, clock=Clock.of(logs))
    try:
        overview(logs, review)
        beginning = len(shown)  # what the overview shows is no answer
        if done.conditioned is not None:
            draw_conditioning(*done.conditioned, review)
        review.tab(name.capitalize())
        before = len(review.drawn)  # a figure of a conditioner shows no answer
        with errors_named(name, analysis):
            plugin.draw(done.result, review)
            studied = len(shown)
            if done.study is not None:
                before = len(review.drawn)
                review.tab("Study")
                plugin.draw_study(done.study, review)
            model = plugin.error_model(done.result) if places.model is not None else None
            objections = _objections(analysis, done.result, places, request)
            answer = (
                plugin.answer(done.result) if offers(analysis, "answer") else default_answer(logs, shown[beginning:])
            )
            findings = plugin.findings(done.result) if offers(analysis, "findings") else ()
            known = log_state(logs, faults=not getattr(analysis, "SHOWS_FAULTS", False))
            stated = properties(name, __version__, getattr(done.parameters, "level", None), logs, answer, findings)
            shown_first = answer if done.study is None else _study_answer(plugin, done, shown[studied:])
            figure = shown_first.figure or _first_figure(review.drawn[before:])
            answer = replace(shown_first, sentences=(*known, *shown_first.sentences), figure=figure)
        origin = Origin(
            name, tuple(map(str, paths)), "" if objections else str(places.model or ""),
            command=request.command or typed_again(places.recording), options=options_given(request.reading, request.part),
        )  # fmt: skip
        review.summary(panel(answer, origin, height=WHOLE_HEIGHT), answer.figure)
        with errors_named(name, analysis):
            text, run = document(
                name, __version__, done.parameters, done.result, logs, review.notes, done.study,
                answer_document(answer, origin),
            )  # fmt: skip
        review.state(recording_name(name, logs, answer), {"run": run, **stated}, text)
        kept = text_of(report_of(answer, origin, review.drawn, logs, run, __version__))
        review.keep(KEPT, kept)
        # The page is made of what is kept, so that imuwb report makes the same page from the recording.
        report = report_from(kept, places.recording)
        saved = "" if model is None or objections else _of_run(model, run).to_toml()
        review.close()
    except BaseException:
        review.discard()
        raise
    return Drawn(answer, origin, tuple(shown), text, report, saved, objections, tuple(review.drawn))


def _first_figure(drawn: Sequence[Shown]) -> Figure | None:
    return next((one.item for one in drawn if isinstance(one.item, Figure)), None)


def _study_answer(plugin: Any, done: Done, shown: Sequence[Table | str]) -> Answer:  # noqa: ANN401 - an analysis
    """Return the answer of a study, which is what its user asks for; without one of the plugin, its first table."""
    answer = plugin.answer_study(done.study) if offers(plugin, "answer_study") else default_answer(done.logs, shown)
    return replace(answer, next=(*answer.next, *(() if ALL in answer.next else (ALL,))))


def _of_run(model: ImuErrorModel, run: str) -> ImuErrorModel:
    return replace(model, provenance={**model.provenance, "run": run})


def _write(
    drawn: Drawn, places: Places, plugin: Any, result: object, parameters: object  # noqa: ANN401 - an analysis
) -> tuple[str, ...]:  # fmt: skip
    """Write all files but the recording, and return what was written for people without the viewer."""
    if places.document is not None:
        write_text(places.document, drawn.document + "\n")
    if places.model is not None and drawn.model:
        write_text(places.model, drawn.model)
    if places.own:
        plugin.write_outputs(result, parameters)
    return places.pages.write([drawn.report]) if places.pages.wanted else ()


def _print(drawn: Drawn, places: Places, pages: Sequence[str], *, full: bool) -> None:
    """Print the answer; before it, all tables and notes if they are wanted, or the JSON."""
    data = not places.to_stdout
    if places.to_stdout:
        typer.echo(drawn.document)
    if full:
        show = shower(data=data)
        for item in drawn.shown:
            show(item)
        for line in where_explained(drawn.answer, drawn.shown):
            show(line)
    written = replace(places, model=places.model if drawn.model else None, pages=PageFiles())
    recording, *others = map(str, written.all())
    print_panel(drawn.answer, replace(drawn.origin, wrote=(f"{recording} (imuwb view)", *pages, *others)), data=data)


def _objections(analysis: Analysis, result: object, places: Places, request: Request) -> tuple[str, ...]:
    """Return why the error model is not written."""
    if places.model is None or request.outputs.force_model or not offers(analysis, "objections"):
        return ()
    return cast("Any", analysis).objections(result)


def with_folders(analysis: Analysis, paths: Sequence[Place]) -> list[Place]:
    """Return the logs; of an analysis that takes any number of them, a folder stands for the logs in it.

    Raises:
        UnreadableLogError: a folder without a log.
    """
    if cast("tuple[int, int | None]", getattr(analysis, "LOGS", (1, 1)))[1] is not None:
        return list(paths)
    from imuwb.fleet.listing import logs_in  # noqa: PLC0415 - most analyses take one log

    return [log for path in paths for log in (logs_in(path) if isinstance(path, Path) and path.is_dir() else (path,))]


def check_count(name: str, analysis: Analysis, paths: Sequence[Place]) -> None:
    """Raise UsageError unless the analysis takes that many logs."""
    fewest, most = cast("tuple[int, int | None]", getattr(analysis, "LOGS", (1, 1)))
    if len(paths) < fewest or (most is not None and len(paths) > most):
        count = str(fewest) if fewest == most else f"{fewest} to {most}" if most else f"{fewest} or more"
        raise UsageError(f"{name} takes {count} log{'s' if count != '1' else ''}; {len(paths)} are given")


def draw_conditioning(log: Log, steps: list[tuple[Step, Any]], review: "RecordingReview") -> None:
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
